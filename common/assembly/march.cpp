#include "assembly/march.hpp"

#include <algorithm>
#include <cmath>

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

/// A step that the integrator refuses after the start is a failure of the numerics, not of the input.
template <class Work>
void guarded(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    throw NumericalFailure("{}; give dynamics.step_s, or a smaller dynamics.safety", error.what());
  }
}

class Explicit : public March {
 public:
  Explicit(const Settings& s, Scene& scene)
      : s_(s), scene_(scene), step_(step_of(s, scene)), drive_(scene.supports, *scene.system) {
    structure::IntegratorSettings in;
    in.step_s = step_;
    in.mass_scaling = s.mass_scaling;
    in.safety = s.mass_scaling ? s.safety : 1;  // what is refused is a step beyond the limit itself
    in.scaling_interval = 20;
    in.damping_per_s = s.damping;
    in.speed_limit_mm_per_s = s.speed_limit;
    integrator_ = std::make_unique<structure::Integrator>(*scene.system, scene.terms, in);
    total_ = std::lround(s.end_s / step_);
    interval_ = std::max(1L, (total_ + s.rows - 1) / s.rows);
  }
  void step() override {
    guarded([&] {
      drive_.set_velocities(*scene_.system, (steps_ + 1) * step_, step_);
      integrator_->step();
      scene_.system->state.time_s = (steps_ + 1) * step_;
    });
    for (const auto& contact : scene_.body_contacts) contact->limit_velocities(*scene_.system, step_);
    ++steps_;
  }
  bool finished() const override { return steps_ >= total_; }
  bool row_due() const override { return steps_ % interval_ == 0 || finished(); }
  double kinetic_nJ() const override { return integrator_->energies().kinetic; }
  double stored_nJ() const override { return integrator_->energies().stored; }
  std::map<std::string, double> metrics() const override {
    const auto& e = integrator_->energies();
    return {{"step_s", step_},
            {"mass_ratio", integrator_->mass_ratio()},
            {"load_work_nJ", e.load_work()},
            {"damping_work_nJ", e.damping_work},
            {"support_work_nJ", e.support_work}};
  }

 private:
  static double step_of(const Settings& s, const Scene& scene) {
    return dividing(s.end_s, s.step_s > 0 ? s.step_s : s.safety * stable_step_s(scene));
  }
  Snapshot save_solver() const override { return integrator_->save(); }
  void restore_solver(const Snapshot& snapshot) override { integrator_->restore(snapshot); }

  Settings s_;
  Scene& scene_;
  double step_;
  Drive drive_;
  std::unique_ptr<structure::Integrator> integrator_;
  long total_ = 0, interval_ = 1;
};

class QuasiStatic : public March {
 public:
  QuasiStatic(const Settings& s, Scene& scene) : s_(s), scene_(scene), drive_(scene.supports, *scene.system) {
    structure::IntegratorSettings in;
    in.step_s = 1;  // a pseudo step: velocities are lengths an iteration
    in.scaling_interval = 20;
    in.speed_limit_mm_per_s = s.speed_limit;
    integrator_ = std::make_unique<structure::Integrator>(*scene.system, scene.terms, in);
  }

  void step() override {
    structure::System& system = *scene_.system;
    const double from = time(load_step_), to = time(load_step_ + 1);
    const auto at = [&](long i) { return from + (to - from) * std::min(1.0, double(i) / ramp); };
    system.state.time_s = at(in_step_);
    drive_.set_velocities(system, at(in_step_ + 1), 1);
    integrator_->step();
    system.state.time_s = at(in_step_ + 1);
    for (const auto& contact : scene_.body_contacts) contact->limit_velocities(system, 1);
    damp();
    ++in_step_;
    ++steps_;
    row_ = false;
    if (in_step_ > ramp && in_step_ % 20 == 0 && at_rest()) {
      row_ = true;
      in_step_ = 0;
      ++load_step_;
      largest_ = std::max(largest_, integrator_->energies().ratio());
    } else if (in_step_ >= s_.max_iterations) {
      throw NumericalFailure(
          "quasi_static: no rest at load time {:.6g} s after {} iterations: unbalanced force {:.3g} of the "
          "load "
          "(limit {:.3g}), kinetic over stored energy {:.3g} (limit {:.3g}); take more load_steps or "
          "max_iterations",
          to, in_step_, unbalanced_, tolerance(), integrator_->energies().ratio(), s_.energy_ratio);
    }
  }
  bool finished() const override { return load_step_ >= s_.load_steps; }
  bool row_due() const override { return row_; }
  double kinetic_nJ() const override { return integrator_->energies().kinetic; }
  double stored_nJ() const override { return integrator_->energies().stored; }
  std::map<std::string, double> metrics() const override {
    return {{"unbalanced_force_ratio", unbalanced_}, {"kinetic_to_stored_ratio_max", largest_}};
  }

 private:
  static constexpr long ramp = 100;  // iterations over which a load step is brought on
  double time(long load_step) const { return s_.end_s * static_cast<double>(load_step) / s_.load_steps; }
  double tolerance() const { return s_.residual > 0 ? s_.residual : 1e-4; }

  void damp() {
    const structure::System& system = *scene_.system;
    const Points& force = integrator_->forces().force;
    double work = 0, inertia = 0;
    for (std::size_t a = 0; a < force_.size(); ++a) {
      if (system.held(static_cast<int>(a))) continue;
      const Mat3 free = Mat3::Identity() - system.held_directions(static_cast<int>(a));
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
    for (std::size_t a = 0; a < f.force.size(); ++a) {
      const Vec3 part = system.held_directions(static_cast<int>(a)) * f.force[a];
      held += part.squaredNorm();
      free += (f.force[a] - part).squaredNorm();
      applied += load.force[a].squaredNorm();
      low = low.cwiseMin(system.state.x[a]);
      high = high.cwiseMax(system.state.x[a]);
    }
    const double length = std::max((high - low).norm(), 1e-9);
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
    s["relaxation"] = {double(load_step_), double(in_step_), unbalanced_, largest_, row_ ? 1.0 : 0.0};
    for (const Vec3& f : force_)
      s["relaxation_force"].insert(s["relaxation_force"].end(), {f[0], f[1], f[2]});
    for (const Vec3& v : velocity_)
      s["relaxation_velocity"].insert(s["relaxation_velocity"].end(), {v[0], v[1], v[2]});
    return s;
  }
  void restore_solver(const Snapshot& s) override {
    integrator_->restore(s);
    const auto& own = s.at("relaxation");
    load_step_ = static_cast<long>(own.at(0));
    in_step_ = static_cast<long>(own.at(1));
    unbalanced_ = own.at(2);
    largest_ = own.at(3);
    row_ = own.at(4) != 0;
    const auto points = [&](const char* name) {
      Points p;
      if (const auto found = s.find(name); found != s.end())
        for (std::size_t i = 0; i + 2 < found->second.size(); i += 3)
          p.emplace_back(found->second[i], found->second[i + 1], found->second[i + 2]);
      return p;
    };
    force_ = points("relaxation_force");
    velocity_ = points("relaxation_velocity");
  }

  Settings s_;
  Scene& scene_;
  Drive drive_;
  std::unique_ptr<structure::Integrator> integrator_;
  Points force_, velocity_;  // of the iteration before
  long load_step_ = 0, in_step_ = 0;
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
  if (!(largest > 0))
    throw InputError("dynamics.step_s is 0 and nothing in the scene has a stiffness; expected a step");
  return 2 / std::sqrt(largest);
}

}  // namespace valsalva::assembly
