// Quasi-static equilibrium under a load factor: the system's time_s is the factor, and loads, pressures and
// prescribed motions are functions of it.
//
// Steps of the factor are halved when Newton fails and grow again (by `growth`, up to max_step) after steps
// that needed at most quick_iterations. A failed step leaves the last equilibrium in the system.
#pragma once

#include "solve/equations.hpp"

namespace valsalva::solve {

struct StaticsSettings {
  double first_step = 0.1;
  double max_step = 1;
  double min_step = 1e-6;
  double growth = 1.5;
  int quick_iterations = 7;
  NewtonSettings newton;
  LinearSettings linear;
};

class Statics {
 public:
  Statics(structure::System& system, std::vector<std::shared_ptr<structure::ForceTerm>> terms,
          const Supports& supports, const StaticsSettings& settings = {});

  /// To equilibrium at this factor, from the state's own. NumericalFailure names the factor reached, what
  /// failed and where; the system stands at the last equilibrium.
  void advance_to(double factor);
  /// One equilibrium at the present factor.
  NewtonReport settle();

  int steps() const { return steps_; }
  int iterations() const { return iterations_; }  ///< all, those of failed steps too
  int failures() const { return failures_; }
  double stored_energy() const { return stored_; }
  /// Forces of the supports on the body at the present state, per node; zero where free (to the tolerance).
  Points reactions() const;
  const Equations& equations() const { return equations_; }

 private:
  StaticsSettings settings_;
  Equations equations_;
  structure::BlockMatrix matrix_;
  LinearSolver solver_;
  double step_;
  double stored_ = 0;
  int steps_ = 0, iterations_ = 0, failures_ = 0;
};

}  // namespace valsalva::solve
