// Explicit central differences (leapfrog) for a System and its force terms.
//
//   v+ = [(1 - alpha dt/2) v- + dt f/m] / (1 + alpha dt/2),   x+ = x + dt v+,
// rotations alike with R+ = exp(dt omega+) R; alpha the mass-proportional damping. Velocities stand half a
// step behind positions. Stable for dt <= 2/sqrt(max k_i/m_i), k_i from the terms' stiffness bounds; with a
// target step, nodal masses and inertias are raised where needed (mass scaling), every `scaling_interval`
// steps anew, in every step for terms whose stiffness is abrupt (contact). With a `growth_limit` the interval
// starts at 1, is doubled, up to scaling_interval, while bounds hardly outgrow the masses chosen for them,
// and halved when one has by more than the limit: what stiffens within an interval by more than 1/safety^2 is
// unstable. Sources: Belytschko, Liu and Moran 2000, section 6.2; Simo and Vu-Quoc 1991 for the rotation
// update.
//
// Adaptive: the step follows the stable one, safety x 2/sqrt(max k_i/m_i), anew in every step (terms that are
// not abrupt: every `scaling_interval` steps), grows by at most a tenth a step and ends where the caller
// asks; the kick takes the mean of the steps before and after it, half a step at the start. A step in which a
// term allows only a share of the motion (ForceTerm::allowed_motion) is repeated with that share of the time.
//
// Rigid bodies (structure/rigid_body.hpp) take part; their nodes follow them.
//
// Energy: kinetic (with scaled masses), stored (sum of the terms' energies), work of damping, of loads,
// contact friction and supports; `Energies::imbalance` is zero up to the truncation error when all forces
// have a potential. Alarm: a node that is not finite or faster than speed_limit is a NumericalFailure that
// names body and node.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "structure/force_term.hpp"
#include "structure/rigid_body.hpp"

namespace valsalva::structure {

struct IntegratorSettings {
  double step_s = 1e-5;       ///< the target step; adaptive: the largest
  bool mass_scaling = true;   ///< false: a too large step is refused
  bool adaptive = false;      ///< instead of mass scaling or refusal
  double safety = 0.8;        ///< of the stability limit
  int scaling_interval = 50;  ///< steps between new stiffness bounds, at most
  double growth_limit = std::numeric_limits<double>::infinity();  ///< below 1/safety^2, or none
  double damping_per_s = 0;                                       ///< alpha
  double speed_limit_mm_per_s = 1e5;                              ///< alarm
};

struct Energies {
  double kinetic = 0;  ///< nJ, at the half step
  double stored = 0;   ///< nJ, at the last force evaluation
  double stored_at_start = 0;
  double kinetic_at_start = 0;
  double damping_work = 0;    ///< taken out by alpha
  double support_work = 0;    ///< put in by held nodes that move
  double scaling_energy = 0;  ///< put in by changing masses at constant velocity
  /// Energy that was put in by terms without a potential (loads), less what friction took out.
  double load_work() const {
    return kinetic - kinetic_at_start + stored - stored_at_start + damping_work - support_work -
           scaling_energy;
  }
  double ratio() const { return stored > 0 ? kinetic / stored : 0; }
};

class Integrator {
 public:
  /// The terms are advanced and asked in this order.
  Integrator(System& system, std::vector<std::shared_ptr<ForceTerm>> terms,
             const IntegratorSettings& settings);

  void add_rigid(std::shared_ptr<RigidBody> body);

  /// One step, with the velocities of held nodes as they stand in the system's state.
  void step() {
    prepare();
    advance();
  }
  /// Its two parts, for velocities of held nodes that depend on the step: prepare returns it (adaptive: at
  /// most largest_s).
  double prepare(double largest_s = std::numeric_limits<double>::infinity());
  void advance();
  void set_damping(double per_s) { settings_.damping_per_s = per_s; }
  long steps() const { return steps_; }
  const Energies& energies() const { return energies_; }
  /// Stored energy of one term at the last step.
  double stored_of(std::size_t term) const { return stored_of_[term]; }
  /// Forces of the last step, before division by the masses.
  const Forces& forces() const { return forces_; }
  /// Total mass now over the total physical mass.
  double mass_ratio() const;
  double mass(int node) const { return mass_[node]; }
  /// Total linear momentum, g mm/s, and angular momentum about the origin, g mm2/s.
  Vec3 momentum() const;
  Vec3 angular_momentum() const;

  /// Everything a bitwise continuation needs, terms included.
  Snapshot save() const;
  /// InputError when the snapshot belongs to another system.
  void restore(const Snapshot& snapshot);

 private:
  void evaluate_forces();
  void bound_stiffness();
  double outgrown() const;
  void scale_masses();
  void choose_step(double largest_s);
  void move();
  void move_nodes();
  void turn_nodes();
  double kick_s() const;
  double kinetic_energy() const;

  System& system_;
  std::vector<std::shared_ptr<ForceTerm>> terms_;
  IntegratorSettings settings_;
  Forces forces_;
  StiffnessBound smooth_, bound_;  // without and with the abrupt terms
  std::vector<double> mass_, inertia_;
  std::vector<std::shared_ptr<RigidBody>> rigid_;
  std::vector<std::uint8_t> carried_;  // by a rigid body
  double dt_, last_dt_ = 0, first_dt_ = 0;
  std::vector<double> stored_of_;
  Energies energies_;
  long steps_ = 0;
  int interval_;         // now between new stiffness bounds
  long next_bound_ = 0;  // the step of the next ones
};

}  // namespace valsalva::structure
