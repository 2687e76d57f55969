// The solvers behind march.hpp and what they share.
#pragma once

#include <cmath>

#include "assembly/march.hpp"
#include "solve/equations.hpp"

namespace valsalva::assembly {

/// What the solvers read of [dynamics].
struct Settings {
  explicit Settings(const Case& scene)
      : solver(scene.text("dynamics.solver")),
        end_s(scene.real("dynamics.end_s")),
        step_s(scene.real("dynamics.step_s")),
        safety(scene.real("dynamics.safety")),
        damping(scene.real("dynamics.damping_per_s")),
        spectral_radius(scene.real("dynamics.spectral_radius")),
        residual(scene.real("dynamics.residual")),
        energy_ratio(scene.real("dynamics.energy_ratio")),
        speed_limit(scene.real("dynamics.speed_limit_mm_per_s")),
        mass_scaling(scene.boolean("dynamics.mass_scaling")),
        load_steps(static_cast<int>(scene.integer("dynamics.load_steps"))),
        max_iterations(scene.integer("dynamics.max_iterations")),
        newton_iterations(static_cast<int>(scene.integer("dynamics.newton_iterations"))),
        rows(scene.integer("dynamics.history_rows")) {}
  std::string solver;
  double end_s, step_s, safety, damping, spectral_radius, residual, energy_ratio, speed_limit;
  bool mass_scaling;
  int load_steps;
  long max_iterations;
  int newton_iterations;
  long rows;

  solve::NewtonSettings newton() const {
    solve::NewtonSettings n;
    if (residual > 0) n.tolerance = residual;
    n.max_iterations = newton_iterations;
    return n;
  }
};

/// The step that is at most `largest` and goes into end_s a whole number of times.
inline double dividing(double end_s, double largest) {
  return end_s / std::ceil(end_s / largest * (1 - 1e-12));
}

/// Rows of the history at even times.
class RowClock {
 public:
  RowClock(double end_s, long rows) : interval_(end_s / static_cast<double>(rows)) {}
  bool due(double before_s, double now_s) const {
    return std::floor(now_s / interval_ * (1 + 1e-12)) > std::floor(before_s / interval_ * (1 + 1e-12));
  }

 private:
  double interval_;
};

/// Positions and the like of the System and the history of its terms.
structure::Snapshot save_system(const Scene& scene);
void restore_system(Scene& scene, const structure::Snapshot& snapshot);

std::unique_ptr<March> explicit_march(const Settings& settings, Scene& scene);
std::unique_ptr<March> relaxation_march(const Settings& settings, Scene& scene);
std::unique_ptr<March> static_march(const Settings& settings, Scene& scene);
std::unique_ptr<March> implicit_march(const Settings& settings, Scene& scene);

}  // namespace valsalva::assembly
