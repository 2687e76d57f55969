#include <algorithm>
#include <cmath>

#include "assembly/march_solvers.hpp"
#include "solve/implicit.hpp"
#include "solve/statics.hpp"

namespace valsalva::assembly {
namespace {

using structure::Snapshot;

class Static : public March {
 public:
  Static(const Settings& s, Scene& scene)
      : March(scene),
        s_(s),
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
  structure::Configuration start_;
  solve::Supports motion_;
  double stored_ = 0, iterations_ = 0, failures_ = 0;
};

class Implicit : public March {
 public:
  Implicit(const Settings& s, Scene& scene) : March(scene) {
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
  double stored_nJ() const override { return steps_ == 0 ? stored_at_start_ : integrator_->stored_energy(); }
  std::map<std::string, double> metrics() const override {
    return {{"newton_iterations", static_cast<double>(integrator_->iterations())}};
  }

 private:
  Snapshot save_solver() const override { return integrator_->save(); }
  void restore_solver(const Snapshot& s) override { integrator_->restore(s); }

  std::unique_ptr<solve::ImplicitIntegrator> integrator_;
  long total_ = 0, interval_ = 1;
};

}  // namespace

std::unique_ptr<March> static_march(const Settings& settings, Scene& scene) {
  return std::make_unique<Static>(settings, scene);
}

std::unique_ptr<March> implicit_march(const Settings& settings, Scene& scene) {
  return std::make_unique<Implicit>(settings, scene);
}

}  // namespace valsalva::assembly
