#include "coupling/immersed_flow.hpp"

#include <algorithm>
#include <limits>

#include "core/errors.hpp"

namespace valsalva::coupling {

namespace {

constexpr double planned_share = 0.9;  // of the CFL limit: the speed grows within the step
constexpr double smallest_cut = 0.1;

}  // namespace

ImmersedFlow::ImmersedFlow(fluid::Flow& flow, std::unique_ptr<ImmersedShell> shell,
                           const ImmersedFlowSettings& settings)
    : flow_(flow),
      shell_(std::move(shell)),
      settings_(settings),
      transfer_(flow.slab(), settings.kernel),
      power_(shell_ ? shell_->x().size() : 0),
      last_velocity_(shell_ ? shell_->x().size() : 0, Vec3::Zero()),
      change_(last_velocity_),
      probed_x_(shell_ ? shell_->x() : Points{}),
      scratch_(flow.slab()) {}

void ImmersedFlow::probe() {
  probed_ = steps_;
  probed_x_ = shell_->x();
  shell_->update_tangent();
  const double per_density = 1 / flow_.parameters().density;
  const Operator stiffness = [&](const Points& y, Points& f) { shell_->tangent_product(y, f); };
  const Operator mobility = [&](const Points& f, Points& v) {
    scratch_.fill(0);
    transfer_.spread(f, scratch_);
    transfer_.interpolate(scratch_, v);
    for (Vec3& each : v) each *= per_density;
  };
  power_.run(stiffness, mobility, steps_ == 0 ? settings_.first_iterations : settings_.probe_iterations);
  if (steps_ > 0) power_.look_along(change_, stiffness, mobility, settings_.look_iterations);
}

double ImmersedFlow::plan(double at_most) {
  if (shell_) {
    transfer_.locate(shell_->coupling_points());
    const ImmersedShell::EdgeStretch stretch = shell_->edge_stretch(probed_x_);
    if (stretch.largest > settings_.largest_stretch)
      throw NumericalFailure("coupling: a leaflet edge is {:.3g} times as long as in its stress-free shape",
                             stretch.largest);
    if (steps_ == 0 || steps_ - probed_ >= settings_.probe_interval ||
        stretch.change > settings_.probe_strain)
      probe();
  }
  StepLimits limits = settings_.limits;
  limits.safety *= caution_;
  limits.cfl *= caution_;
  const double critical = shell_ ? power_.critical_step() : std::numeric_limits<double>::infinity();
  limits.cfl *= planned_share;
  return std::min(at_most, next_step(limits, critical, max_speed_, flow_.grid().h, last_dt_));
}

ImmersedStep ImmersedFlow::step(double at_most, const std::function<void(double dt)>& set_ends) {
  ImmersedStep done;
  done.dt_s = plan(at_most);
  flow_.clear_force();
  if (shell_) {
    shell_->forces(force_);
    transfer_.spread(force_, flow_.force());
  }
  const double limit = settings_.limits.cfl * caution_;
  for (;; ++done.repeats) {
    if (set_ends) set_ends(done.dt_s);
    flow_.predict(done.dt_s);
    done.fluid = flow_.project(done.dt_s);
    if (done.fluid.cfl <= limit) break;
    flow_.undo();
    done.dt_s *= std::max(smallest_cut, planned_share * limit / done.fluid.cfl);
    if (done.dt_s < settings_.limits.smallest_s)
      throw NumericalFailure(
          "coupling: the time step fell to {:.3g} s, and still the fluid would move {:.3g} cells in it",
          done.dt_s, done.fluid.cfl);
  }
  done.critical_s = shell_ ? power_.critical_step() : std::numeric_limits<double>::infinity();
  if (shell_) {
    transfer_.interpolate(flow_.velocity(), velocity_);
    for (std::size_t a = 0; a < velocity_.size(); ++a) change_[a] = velocity_[a] - last_velocity_[a];
    last_velocity_ = velocity_;
    shell_->move(velocity_, done.dt_s);
  }
  max_speed_ = done.fluid.max_speed;
  last_dt_ = done.dt_s;
  ++steps_;
  return done;
}

std::map<std::string, state::Array> ImmersedFlow::save() const {
  std::map<std::string, state::Array> arrays = flow_.save();
  if (shell_) {
    arrays["coupling/points"] = state::Array::of(shell_->x());
    arrays["coupling/direction"] = state::Array::of(power_.direction());
    arrays["coupling/velocity"] = state::Array::of(last_velocity_);
    arrays["coupling/change"] = state::Array::of(change_);
    arrays["coupling/probed_points"] = state::Array::of(probed_x_);
  }
  arrays["coupling/history"] =
      state::Array::of(std::vector<double>{static_cast<double>(steps_), last_dt_, max_speed_, caution_,
                                           power_.eigenvalue(), static_cast<double>(probed_)});
  return arrays;
}

void ImmersedFlow::load(const state::State& state) {
  flow_.load(state);
  const std::vector<double>& history = state.array("coupling/history").doubles("coupling/history");
  if (history.size() != 6)
    throw InputError("{}: coupling/history has {} entries, expected 6", state.source, history.size());
  steps_ = static_cast<long>(history[0]);
  last_dt_ = history[1];
  max_speed_ = history[2];
  caution_ = history[3];
  probed_ = static_cast<long>(history[5]);
  if (!shell_) return;
  Points x = state.array("coupling/points").points("coupling/points");
  Points direction = state.array("coupling/direction").points("coupling/direction");
  last_velocity_ = state.array("coupling/velocity").points("coupling/velocity");
  change_ = state.array("coupling/change").points("coupling/change");
  probed_x_ = state.array("coupling/probed_points").points("coupling/probed_points");
  for (const Points* each : {&x, &direction, &last_velocity_, &change_, &probed_x_})
    if (each->size() != shell_->x().size())
      throw InputError("{}: coupling/... has {} nodes, the leaflets have {}", state.source, each->size(),
                       shell_->x().size());
  shell_->set_x(std::move(x));
  power_.restore(std::move(direction), history[4]);
}

}  // namespace valsalva::coupling
