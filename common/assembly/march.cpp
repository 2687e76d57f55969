#include "assembly/march.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "solve/implicit.hpp"
#include "solve/statics.hpp"
#include "structure/integrator.hpp"

namespace valsalva::assembly {
namespace {

using structure::Snapshot;

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
double dividing(double end_s, double largest) {
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

class Explicit : public March {
 public:
  Explicit(const Settings& s, Scene& scene) : s_(s), scene_(scene), drive_(scene), rows_(s.end_s, s.rows) {
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
  double stored_nJ() const override { return integrator_->energies().stored; }
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
  Scene& scene_;
  Drive drive_;
  RowClock rows_;
  std::unique_ptr<structure::Integrator> integrator_;
  double shortest_ = 1e300, longest_ = 0;
  bool row_ = false;
};

class QuasiStatic : public March {
 public:
  QuasiStatic(const Settings& s, Scene& scene)
      : s_(s),
        scene_(scene),
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
  Scene& scene_;
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

/// Positions and the like of the System and the history of its terms.
Snapshot save_system(const Scene& scene) {
  structure::Integrator carrier(*scene.system, scene.terms, {});
  return carrier.save();
}

void restore_system(Scene& scene, const Snapshot& snapshot) {
  structure::Integrator carrier(*scene.system, scene.terms, {});
  carrier.restore(snapshot);
}

class Static : public March {
 public:
  Static(const Settings& s, Scene& scene)
      : s_(s),
        scene_(scene),
        start_(scene.system->state),
        motion_(prescribed_motion(scene.supports, *scene.system)) {}

  void step() override {
    solve::StaticsSettings in;
    in.first_step = in.max_step = s_.end_s / s_.load_steps;
    in.min_step = 1e-5 * in.max_step;
    in.newton = s_.newton();
    // Supports count displacements from where the nodes are when the equations are made; a solver a load step
    // leaves nothing that a restart would have to know.
    std::swap(scene_.system->state, start_);
    solve::Statics statics(*scene_.system, scene_.terms, motion_, in);
    std::swap(scene_.system->state, start_);
    statics.advance_to(s_.end_s * static_cast<double>(steps_ + 1) / s_.load_steps);
    stored_ = statics.stored_energy();
    iterations_ += statics.iterations();
    failures_ += statics.failures();
    ++steps_;
  }
  bool finished() const override { return steps_ >= s_.load_steps; }
  bool row_due() const override { return true; }
  double kinetic_nJ() const override { return 0; }
  double stored_nJ() const override { return stored_; }
  std::map<std::string, double> metrics() const override {
    return {{"newton_iterations", iterations_}, {"halved_steps", failures_}};
  }

 private:
  Snapshot save_solver() const override {
    Snapshot s = save_system(scene_);
    s["statics"] = {stored_, iterations_, failures_};
    return s;
  }
  void restore_solver(const Snapshot& s) override {
    restore_system(scene_, s);
    const auto& own = s.at("statics");
    stored_ = own.at(0);
    iterations_ = own.at(1);
    failures_ = own.at(2);
  }

  Settings s_;
  Scene& scene_;
  structure::Configuration start_;
  solve::Supports motion_;
  double stored_ = 0, iterations_ = 0, failures_ = 0;
};

class Implicit : public March {
 public:
  Implicit(const Settings& s, Scene& scene) : scene_(scene) {
    solve::ImplicitSettings in;
    in.step_s = dividing(s.end_s, s.step_s > 0 ? s.step_s : 0.01 * s.end_s);
    in.spectral_radius = s.spectral_radius;
    in.damping_per_s = s.damping;
    in.newton = s.newton();
    total_ = std::lround(s.end_s / in.step_s);
    interval_ = std::max(1L, (total_ + s.rows - 1) / s.rows);
    integrator_ = std::make_unique<solve::ImplicitIntegrator>(
        *scene.system, scene.terms, prescribed_motion(scene.supports, *scene.system), in);
  }
  void step() override {
    integrator_->step();
    ++steps_;
  }
  bool finished() const override { return steps_ >= total_; }
  bool row_due() const override { return steps_ % interval_ == 0 || finished(); }
  double kinetic_nJ() const override { return integrator_->kinetic_energy(); }
  double stored_nJ() const override { return integrator_->stored_energy(); }
  std::map<std::string, double> metrics() const override {
    return {{"newton_iterations", static_cast<double>(integrator_->iterations())}};
  }

 private:
  Snapshot save_solver() const override { return integrator_->save(); }
  void restore_solver(const Snapshot& s) override { integrator_->restore(s); }

  Scene& scene_;
  std::unique_ptr<solve::ImplicitIntegrator> integrator_;
  long total_ = 0, interval_ = 1;
};

}  // namespace

structure::Snapshot March::save() const {
  Snapshot s = save_solver();
  s["march"] = {static_cast<double>(steps_)};
  return s;
}

void March::restore(const Snapshot& snapshot) {
  const auto own = snapshot.find("march");
  if (own == snapshot.end() || own->second.size() != 1)
    throw InputError("the state holds no scene without fluid: it was written with another case");
  restore_solver(snapshot);
  steps_ = static_cast<long>(own->second[0]);
}

std::unique_ptr<March> make_march(const Case& scene, Scene& built) {
  const Settings s(scene);
  const bool newton = s.solver == "static" || s.solver == "implicit";
  if (newton && !built.rigid.empty())
    throw InputError(
        "{}: dynamics.solver = \"{}\" with the free rigid body '{}'; expected \"explicit\" or "
        "\"quasi_static\"",
        scene.file().string(), s.solver, built.rigid.front()->name());
  if (s.solver == "explicit") return std::make_unique<Explicit>(s, built);
  if (s.solver == "quasi_static") return std::make_unique<QuasiStatic>(s, built);
  if (s.solver == "static") return std::make_unique<Static>(s, built);
  return std::make_unique<Implicit>(s, built);
}

double stable_step_s(const Scene& scene) {
  structure::StiffnessBound bound;
  bound.reset(scene.system->nodes(), scene.system->rotational_nodes());
  for (const auto& term : scene.terms) term->add_stiffness_bound(scene.system->state, bound);
  double largest = 0;
  for (std::size_t a = 0; a < bound.translation.size(); ++a)
    if (!scene.system->held(static_cast<int>(a)))
      largest = std::max(largest, bound.translation[a] / scene.system->mass(static_cast<int>(a)));
  for (std::size_t r = 0; r < bound.rotation.size(); ++r)
    if (!scene.system->held(scene.system->node_of_rotation(static_cast<int>(r))))
      largest = std::max(largest, bound.rotation[r] / scene.system->inertia(static_cast<int>(r)));
  for (const auto& body : scene.rigid) largest = std::max(largest, body->largest_ratio(bound));
  return largest > 0 ? 2 / std::sqrt(largest) : std::numeric_limits<double>::infinity();
}

}  // namespace valsalva::assembly
