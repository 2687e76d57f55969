#include <algorithm>
#include <cmath>
#include <limits>

#include "assembly/march_solvers.hpp"
#include "structure/integrator.hpp"

namespace valsalva::assembly {
namespace {

using structure::Snapshot;

class Explicit : public March {
 public:
  Explicit(const Settings& s, Scene& scene) : March(scene), s_(s), drive_(scene), rows_(s.end_s, s.rows) {
    structure::IntegratorSettings in;
    in.mass_scaling = s.mass_scaling;
    in.adaptive = !s.mass_scaling;
    in.step_s = s.step_s > 0     ? s.step_s
                : s.mass_scaling ? std::min(s.safety * stable_step_s(scene), 1e-3 * s.end_s)
                                 : 1e-3 * s.end_s;
    in.step_s = s.mass_scaling ? dividing(s.end_s, in.step_s) : in.step_s;
    in.safety = s.safety;
    in.scaling_interval = 20;
    // Of what the safety leaves.
    if (s.mass_scaling) in.growth_limit = 1 + std::max(0.01, 0.2 * (1 / (s.safety * s.safety) - 1));
    in.damping_per_s = s.damping;
    in.speed_limit_mm_per_s = s.speed_limit;
    integrator_ = std::make_unique<structure::Integrator>(*scene.system, scene.terms, in);
    for (const auto& body : scene.rigid) integrator_->add_rigid(body);
  }
  void step() override {
    structure::System& system = *scene_.system;
    const double before = system.state.time_s, left = s_.end_s - before;
    const double planned = integrator_->prepare(std::min(left, reachable_s()));
    drive_.set_velocities(system, before + planned, planned);
    integrator_->advance();  // contact may have cut the step
    if (s_.mass_scaling)     // the step is fixed: it slows nodes instead
      for (const auto& contact : scene_.body_contacts) contact->limit_velocities(system, planned);
    if (s_.end_s - system.state.time_s <= 1e-9 * planned) system.state.time_s = s_.end_s;
    const double now = system.state.time_s;
    shortest_ = std::min(shortest_, now - before);
    longest_ = std::max(longest_, now - before);
    row_ = finished() || rows_.due(before, now);
    ++steps_;
  }
  bool finished() const override { return scene_.system->state.time_s >= s_.end_s; }
  bool row_due() const override { return row_; }
  double kinetic_nJ() const override {
    return steps_ == 0 ? kinetic_of(scene_) : integrator_->energies().kinetic;
  }
  double stored_nJ() const override {
    return steps_ == 0 ? stored_at_start_ : integrator_->energies().stored;
  }
  std::map<std::string, double> metrics() const override {
    const auto& e = integrator_->energies();
    return {{"step_min_s", shortest_},
            {"step_max_s", longest_},
            {"mass_ratio", integrator_->mass_ratio()},
            {"load_work_nJ", e.load_work()},
            {"damping_work_nJ", e.damping_work},
            {"support_work_nJ", e.support_work}};
  }

 private:
  /// No node goes farther in a step than a fifth of the distance at which bodies meet.
  double reachable_s() const {
    double fastest = 0;
    if (!std::isfinite(scene_.contact_reach_mm)) return scene_.contact_reach_mm;
    for (const Vec3& v : scene_.system->state.v) fastest = std::max(fastest, v.norm());
    return fastest > 0 ? 0.2 * scene_.contact_reach_mm / fastest : std::numeric_limits<double>::infinity();
  }
  Snapshot save_solver() const override {
    Snapshot s = integrator_->save();
    s["steps_taken"] = {shortest_, longest_, row_ ? 1.0 : 0.0};
    return s;
  }
  void restore_solver(const Snapshot& s) override {
    integrator_->restore(s);
    const auto& own = s.at("steps_taken");
    shortest_ = own.at(0);
    longest_ = own.at(1);
    row_ = own.at(2) != 0;
  }

  Settings s_;
  Drive drive_;
  RowClock rows_;
  std::unique_ptr<structure::Integrator> integrator_;
  double shortest_ = 1e300, longest_ = 0;
  bool row_ = false;
};

}  // namespace

std::unique_ptr<March> explicit_march(const Settings& settings, Scene& scene) {
  return std::make_unique<Explicit>(settings, scene);
}

}  // namespace valsalva::assembly
