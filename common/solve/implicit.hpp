// Implicit dynamics: generalised-alpha (Chung and Hulbert 1993) with forces interpolated between the ends of
// the step,
//   M [(1 - am) a1 + am a0] + damping M [(1 - af) v1 + af v0] = (1 - af) f1 + af f0,
//   x1 = x0 + dt v0 + dt^2 [(1/2 - b) a0 + b a1],   v1 = v0 + dt [(1 - g) a0 + g a1],
//   am = (2 r - 1)/(r + 1), af = r/(r + 1), g = 1/2 - am + af, b = (1 - am + af)^2/4,
// r the spectral radius at high frequency: 1 keeps all modes, 0 removes them in one step. Second order,
// unconditionally stable in linear problems; in nonlinear ones energy is kept to second order only.
// Rotations alike with the rotation vector of the step in place of x1 - x0, R1 = exp(psi) R0, which is exact
// for the isotropic nodal inertia of System. Lumped masses. Held nodes rest; prescribed ones follow their
// motion.
#pragma once

#include "solve/equations.hpp"

namespace valsalva::solve {

struct ImplicitSettings {
  double step_s = 1e-4;
  double spectral_radius = 0.8;
  double damping_per_s = 0;  ///< mass proportional
  NewtonSettings newton;
  LinearSettings linear;
};

class ImplicitIntegrator {
 public:
  ImplicitIntegrator(structure::System& system, std::vector<std::shared_ptr<structure::ForceTerm>> terms,
                     const Supports& supports, const ImplicitSettings& settings);

  /// NumericalFailure names the time and the place; the system stands at the end of the last good step.
  void step();
  long steps() const { return steps_; }
  long iterations() const { return iterations_; }
  double kinetic_energy() const;
  double stored_energy() const { return stored_; }
  Vec3 momentum() const;
  Vec3 angular_momentum() const;

  /// Everything a continuation needs.
  structure::Snapshot save() const;
  /// InputError when the snapshot belongs to another system.
  void restore(const structure::Snapshot& snapshot);

 private:
  void start();
  Eigen::VectorXd increment_since(const structure::Configuration& before) const;
  Eigen::VectorXd velocity() const;

  ImplicitSettings settings_;
  Equations equations_;
  structure::BlockMatrix matrix_;
  LinearSolver solver_;
  double am_, af_, g_, b_;
  Eigen::VectorXd mass_;
  Eigen::VectorXd acceleration_, force_;  // at the end of the last step
  double stored_ = 0;
  long steps_ = 0, iterations_ = 0;
  bool started_ = false;
};

}  // namespace valsalva::solve
