// Advances a scene: one interface over the four solvers of [dynamics].
//
//   explicit      central differences (structure/integrator.hpp), with the stable step of every moment, at
//                 most step_s, or with step_s and masses raised to fit; one step is one time step. Velocities
//                 stand half a step behind positions
//   quasi_static  load steps; each is brought to rest by dynamic relaxation: masses scaled to a unit pseudo
//                 step, damping 2 omega with omega^2 the Rayleigh quotient of the present motion (Underwood
//                 1983). At rest: unbalanced force <= residual x force of loads and supports, and kinetic <=
//                 energy_ratio x stored energy. A load step that finds no rest is halved, and doubled again
//                 after one that does. One step is one iteration
//   static        load steps by Newton (solve/statics.hpp); one step is one load step
//   implicit      generalised-alpha (solve/implicit.hpp)
// Loads and prescribed motions are functions of the system's time; static solvers go through it to end_s.
#pragma once

#include <memory>

#include "assembly/scene.hpp"

namespace valsalva::assembly {

class March {
 public:
  explicit March(Scene& scene) : scene_(scene) {}
  virtual ~March() = default;
  /// NumericalFailure names the place.
  virtual void step() = 0;
  virtual bool finished() const = 0;
  /// Is the present state worth a row of the history (always at the end)?
  virtual bool row_due() const = 0;
  virtual double kinetic_nJ() const = 0;
  virtual double stored_nJ() const = 0;
  /// Further metrics of the solver: name with unit, value.
  virtual std::map<std::string, double> metrics() const = 0;
  long steps() const { return steps_; }

  /// Dynamic solvers, before the first step: from this equilibrium, which make_search found with a scene of
  /// the same bodies, at time 0 and with the velocities that the bodies have.
  void start_from(const structure::Snapshot& equilibrium, double stored_nJ);

  /// Everything that a bitwise continuation needs.
  structure::Snapshot save() const;
  void restore(const structure::Snapshot& snapshot);

 protected:
  virtual structure::Snapshot save_solver() const = 0;
  virtual void restore_solver(const structure::Snapshot& snapshot) = 0;
  Scene& scene_;
  long steps_ = 0;
  double stored_at_start_ = 0;  // of what start_from put there
};

std::unique_ptr<March> make_march(const Case& scene, Scene& built);
/// Static, whatever [dynamics] asks for: for a scene of Course::to_start.
std::unique_ptr<March> make_search(const Case& scene, Scene& built);

/// The largest explicit step that is stable at the scene's present state, before any safety; infinite where
/// nothing has a stiffness.
double stable_step_s(const Scene& scene);

}  // namespace valsalva::assembly
