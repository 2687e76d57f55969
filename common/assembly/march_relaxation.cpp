#include <algorithm>
#include <cmath>

#include "assembly/march_solvers.hpp"
#include "core/errors.hpp"
#include "structure/integrator.hpp"

namespace valsalva::assembly {
namespace {

using structure::Snapshot;

class QuasiStatic : public March {
 public:
  QuasiStatic(const Settings& s, Scene& scene)
      : March(scene),
        s_(s),
        drive_(scene),
        carried_(scene.system->nodes(), 0),
        increment_(s.end_s / s.load_steps) {
    for (const auto& body : scene.rigid)
      std::fill(carried_.begin() + body->body().begin(), carried_.begin() + body->body().end(), 1);
    structure::IntegratorSettings in;
    in.step_s = 1;  // a pseudo step: velocities are lengths an iteration
    in.scaling_interval = 20;
    in.speed_limit_mm_per_s = s.speed_limit;
    integrator_ = std::make_unique<structure::Integrator>(*scene.system, scene.terms, in);
    for (const auto& body : scene.rigid) integrator_->add_rigid(body);
  }

  void step() override {
    if (in_step_ == 0) rest_ = integrator_->save();
    row_ = false;
    ++steps_;
    try {
      iterate();
    } catch (const NumericalFailure& failure) {
      halve(failure.what());
      return;
    }
    if (in_step_ > ramp && in_step_ % 20 == 0 && at_rest())
      settled();
    else if (in_step_ >= s_.max_iterations)
      halve(
          fmt::format("no rest after {} iterations: unbalanced force {:.3g} of the load (limit {:.3g}), "
                      "kinetic over stored energy {:.3g} (limit {:.3g})",
                      in_step_, unbalanced_, tolerance(), integrator_->energies().ratio(), s_.energy_ratio));
  }
  bool finished() const override { return equilibrium_s_ >= s_.end_s; }
  bool row_due() const override { return row_; }
  double kinetic_nJ() const override { return integrator_->energies().kinetic; }
  double stored_nJ() const override { return integrator_->energies().stored; }
  std::map<std::string, double> metrics() const override {
    return {{"unbalanced_force_ratio", unbalanced_},
            {"kinetic_to_stored_ratio_max", largest_},
            {"halved_steps", static_cast<double>(halvings_)}};
  }

 private:
  static constexpr long ramp = 100;         // iterations over which a load step is brought on
  static constexpr double smallest = 1e-3;  // of a load step
  double tolerance() const { return s_.residual > 0 ? s_.residual : 1e-4; }
  double target() const {
    const double next = equilibrium_s_ + increment_;
    return next > s_.end_s * (1 - 1e-9) ? s_.end_s : next;
  }

  void iterate() {
    structure::System& system = *scene_.system;
    const auto at = [&](long i) {
      return i >= ramp ? target() : equilibrium_s_ + (target() - equilibrium_s_) * double(i) / ramp;
    };
    system.state.time_s = at(in_step_);
    drive_.set_velocities(system, at(in_step_ + 1), 1);
    integrator_->step();
    system.state.time_s = at(in_step_ + 1);
    for (const auto& contact : scene_.body_contacts) contact->limit_velocities(system, 1);
    damp();
    ++in_step_;
  }

  void settled() {
    row_ = true;
    in_step_ = 0;
    equilibrium_s_ = target();
    largest_ = std::max(largest_, integrator_->energies().ratio());
    increment_ = std::min(2 * increment_, s_.end_s / s_.load_steps);
  }

  void halve(const std::string& why) {
    integrator_->restore(rest_);
    force_.clear();
    velocity_.clear();
    in_step_ = 0;
    increment_ /= 2;
    ++halvings_;
    if (increment_ < smallest * s_.end_s / s_.load_steps)
      throw NumericalFailure(
          "quasi_static: no equilibrium beyond the load time {:.6g} s, step {:.3g} s: {}; take more "
          "load_steps "
          "or max_iterations",
          equilibrium_s_, 2 * increment_, why);
  }

  void damp() {
    const structure::System& system = *scene_.system;
    const Points& force = integrator_->forces().force;
    double work = 0, inertia = 0;
    for (std::size_t a = 0; a < force_.size(); ++a) {
      if (system.held(static_cast<int>(a)) && !carried_[a]) continue;
      const Mat3 held = carried_[a] ? Mat3::Zero() : system.held_directions(static_cast<int>(a));
      const Mat3 free = Mat3::Identity() - held;
      const Vec3 v = free * velocity_[a];
      work -= (force[a] - force_[a]).dot(v);
      inertia += integrator_->mass(static_cast<int>(a)) * v.squaredNorm();
    }
    if (inertia > 0) integrator_->set_damping(2 * std::min(0.5, std::sqrt(std::max(work / inertia, 1e-12))));
    force_ = force;
    velocity_ = system.state.v;
  }

  /// Free forces over the larger of load and support forces; moments count by the scene's size.
  bool at_rest() {
    const structure::System& system = *scene_.system;
    const structure::Forces& f = integrator_->forces();
    structure::Forces load;
    load.reset(system.nodes(), system.rotational_nodes());
    for (const auto& term : scene_.loads) term->add_forces(system.state, load);
    double free = 0, held = 0, applied = 0;
    Vec3 low = system.state.x.front(), high = low;
    for (const Vec3& x : system.state.x) {
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    const double length = std::max((high - low).norm(), 1e-9);
    for (const auto& body : scene_.rigid) {
      const Vec3 weight = body->weight(system.state.time_s), force = body->force(f) + weight;
      const Vec3 torque = body->torque(system, f) / length;
      applied += weight.squaredNorm();
      held += (body->held() * force).squaredNorm() + (body->held_spin() * torque).squaredNorm();
      free +=
          (force - body->held() * force).squaredNorm() + (torque - body->held_spin() * torque).squaredNorm();
    }
    for (std::size_t a = 0; a < f.force.size(); ++a) {
      if (carried_[a]) continue;
      const Vec3 part = system.held_directions(static_cast<int>(a)) * f.force[a];
      held += part.squaredNorm();
      free += (f.force[a] - part).squaredNorm();
      applied += load.force[a].squaredNorm();
    }
    for (std::size_t r = 0; r < f.moment.size(); ++r) {
      const Vec3 part = system.held_axes(static_cast<int>(r)) * f.moment[r];
      held += part.squaredNorm() / (length * length);
      free += (f.moment[r] - part).squaredNorm() / (length * length);
      applied += load.moment[r].squaredNorm() / (length * length);
    }
    const double scale = std::sqrt(std::max(held, applied));
    unbalanced_ = free == 0 ? 0 : std::sqrt(free) / std::max(scale, 1e-300);
    const auto& e = integrator_->energies();
    return unbalanced_ <= tolerance() && e.kinetic <= s_.energy_ratio * e.stored;
  }

  Snapshot save_solver() const override {
    Snapshot s = integrator_->save();
    s["relaxation"] = {equilibrium_s_, increment_,        double(in_step_), unbalanced_,
                       largest_,       double(halvings_), row_ ? 1.0 : 0.0};
    for (const Vec3& f : force_)
      s["relaxation_force"].insert(s["relaxation_force"].end(), {f[0], f[1], f[2]});
    for (const Vec3& v : velocity_)
      s["relaxation_velocity"].insert(s["relaxation_velocity"].end(), {v[0], v[1], v[2]});
    for (const auto& [name, values] : rest_) s["rest/" + name] = values;
    return s;
  }
  void restore_solver(const Snapshot& s) override {
    integrator_->restore(s);
    const auto& own = s.at("relaxation");
    equilibrium_s_ = own.at(0);
    increment_ = own.at(1);
    in_step_ = static_cast<long>(own.at(2));
    unbalanced_ = own.at(3);
    largest_ = own.at(4);
    halvings_ = static_cast<int>(own.at(5));
    row_ = own.at(6) != 0;
    const auto points = [&](const char* name) {
      Points p;
      if (const auto found = s.find(name); found != s.end())
        for (std::size_t i = 0; i + 2 < found->second.size(); i += 3)
          p.emplace_back(found->second[i], found->second[i + 1], found->second[i + 2]);
      return p;
    };
    force_ = points("relaxation_force");
    velocity_ = points("relaxation_velocity");
    rest_.clear();
    for (const auto& [name, values] : s)
      if (name.starts_with("rest/")) rest_[name.substr(5)] = values;
  }

  Settings s_;
  Drive drive_;
  std::vector<std::uint8_t> carried_;  // nodes of free rigid bodies
  std::unique_ptr<structure::Integrator> integrator_;
  Points force_, velocity_;  // of the iteration before
  Snapshot rest_;            // the integrator at the last equilibrium
  double equilibrium_s_ = 0, increment_;
  long in_step_ = 0;
  int halvings_ = 0;
  double unbalanced_ = 0, largest_ = 0;
  bool row_ = false;
};

}  // namespace

std::unique_ptr<March> relaxation_march(const Settings& settings, Scene& scene) {
  return std::make_unique<QuasiStatic>(settings, scene);
}

}  // namespace valsalva::assembly
