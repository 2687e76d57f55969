#include "coupling/immersed_flow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"

namespace valsalva::coupling {

namespace {

constexpr double planned_share = 0.9;  // of the CFL limit: the speed grows within the step
constexpr double smallest_cut = 0.1;
// Estimates of the limit that agree within this share are made half as often as before, down to one in
// `rarest` intervals.
constexpr double steady = 0.02;
constexpr int rarest = 4;

void clear(const fluid::Slab& slab, fluid::Planes planes, fluid::FaceField& field) {
  for (int d = 0; d < 3; ++d) {
    const int from = std::max(planes.from, 0),
              to = std::min(planes.to, d == 2 ? slab.w_planes() : slab.planes);
    if (from < to) std::fill_n(field[d].row(0, from), (to - from) * slab.stride_z, 0.0);
  }
}

}  // namespace

ImmersedFlow::ImmersedFlow(fluid::Flow& flow, std::unique_ptr<ImmersedBody> body,
                           const ImmersedFlowSettings& settings)
    : flow_(flow),
      body_(std::move(body)),
      shell_(dynamic_cast<ImmersedShell*>(body_.get())),
      settings_(settings),
      transfer_(flow.slab(), settings.kernel,
                {flow.boundaries().periodic(0), flow.boundaries().periodic(1), flow.boundaries().periodic(2)},
                settings.beyond),
      walls_(flow.grid(), settings.kernel,
             {flow.boundaries().periodic(0), flow.boundaries().periodic(1), flow.boundaries().periodic(2)},
             settings.beyond),
      power_(body_ ? body_->unknowns() : 0),
      last_velocity_(body_ ? body_->unknowns() : 0, Vec3::Zero()),
      change_(last_velocity_),
      probed_x_(body_ ? body_->x() : Points{}),
      scratch_(flow.slab()) {}

void ImmersedFlow::locate() {
  transfer_.locate(body_->coupling_points());
}

void ImmersedFlow::spread(const Points& force, fluid::FaceField& density) {
  if (const Sampling* sampling = body_->sampling()) {
    sampling->to_points(force, at_points_);
    transfer_.spread(at_points_, density);
  } else {
    transfer_.spread(force, density);
  }
}

void ImmersedFlow::interpolate(const fluid::FaceField& velocity, Points& out, bool of_flow) {
  if (const Sampling* sampling = body_->sampling()) {
    transfer_.interpolate(velocity, at_points_);
    if (of_flow) walls_.add(body_->coupling_points(), flow_.boundaries().velocity, at_points_);
    sampling->to_nodes(at_points_, out);
  } else {
    transfer_.interpolate(velocity, out);
    if (of_flow) walls_.add(body_->coupling_points(), flow_.boundaries().velocity, out);
  }
}

void ImmersedFlow::probe() {
  const double before = power_.eigenvalue();
  probed_x_ = body_->x();
  iterate(steps_ == 0 ? settings_.first_iterations : settings_.probe_iterations);
  const bool same = steps_ > probed_ && std::abs(power_.eigenvalue() - before) <= steady * before;
  interval_ = same ? std::min(2 * interval_, rarest * settings_.probe_interval) : settings_.probe_interval;
  probed_ = steps_;
}

double ImmersedFlow::find_critical() {
  if (!body_) return std::numeric_limits<double>::infinity();
  locate();
  iterate(settings_.first_iterations);
  return critical_step();
}

void ImmersedFlow::iterate(int iterations) {
  body_->update_tangent();
  const double per_density = 1 / flow_.parameters().density;
  const std::vector<double> own = body_->own_masses();
  const bool with_projection = body_->lead() > 0 && flow_.parameters().order == 2;
  const Operator stiffness = [&](const Points& y, Points& f) { body_->tangent_product(y, f); };
  const Operator mobility = [&](const Points& f, Points& v) {
    spread(f, scratch_);
    if (with_projection) flow_.constrain(scratch_, transfer_.planes());
    interpolate(scratch_, v);
    clear(flow_.slab(), transfer_.planes(), scratch_);  // it stays zero between the products
    for (Vec3& each : v) each *= per_density;
    for (std::size_t i = 0; i < own.size(); ++i) v.push_back(f[f.size() - own.size() + i] / own[i]);
  };
  power_.run(stiffness, mobility, iterations);
  if (steps_ > 0) power_.look_along(change_, stiffness, mobility, settings_.look_iterations);
}

double ImmersedFlow::critical_step() const {
  return power_.critical_step() / std::sqrt(1 + 2 * lead());
}

double ImmersedFlow::lead() const {
  return lead_at(max_speed_ * last_dt_ / flow_.grid().h, body_->least_lead(), body_->lead());
}

double ImmersedFlow::plan() {
  double stiffening = 1;
  if (body_) {
    locate();
    const EdgeStretch stretch = body_->edge_stretch(probed_x_);
    if (stretch.largest > settings_.largest_stretch)
      throw NumericalFailure(
          "coupling: an edge of the structure is {:.3g} times as long as in its stress-free shape",
          stretch.largest);
    stiffening = body_->stiffening(stretch.change);
    if (steps_ == 0 || steps_ - probed_ >= interval_ || stiffening > settings_.probe_stiffening) {
      probe();
      stiffening = 1;
    }
  }
  StepLimits limits = settings_.limits;
  limits.safety *= caution_ * calm_.factor();
  limits.cfl *= caution_;
  if (body_ && body_->lead() == 0) limits.convection = 0;  // without the projection there is room enough
  const double critical = body_ ? critical_step() / std::sqrt(std::max(1.0, stiffening))
                                : std::numeric_limits<double>::infinity();
  limits.cfl *= planned_share;
  return next_step(limits, critical, max_speed_, flow_.grid().h, last_dt_);
}

ImmersedStep ImmersedFlow::step(double at_most, const std::function<void(double dt)>& set_ends) {
  return step(at_most, StepHooks{{}, {}, set_ends});
}

ImmersedStep ImmersedFlow::step(double at_most, const StepHooks& hooks) {
  ImmersedStep done;
  const double planned = plan();
  // Rather two halves than a last step that only round-off or a little has left over.
  done.dt_s = at_most <= planned ? at_most : at_most < 1.1 * planned ? 0.5 * at_most : planned;
  if (hooks.fit) done.dt_s = hooks.fit(done.dt_s);
  if (hooks.set_force) {
    hooks.set_force(done.dt_s);
    forced_ = {};
  } else if (body_) {
    clear(flow_.slab(), forced_, flow_.force());
    forced_ = transfer_.planes();
  }
  if (body_) {
    body_->begin_step(done.dt_s, last_velocity_, lead());
    body_->forces(force_);
    spread(force_, flow_.force());
  }
  const double limit = settings_.limits.cfl * caution_;
  for (;; ++done.repeats) {
    if (hooks.set_ends) hooks.set_ends(done.dt_s);
    flow_.predict(done.dt_s, {.forced = forced_});
    done.fluid = flow_.project(done.dt_s);
    if (done.fluid.cfl <= limit) break;
    flow_.undo();
    done.dt_s *= std::max(smallest_cut, planned_share * limit / done.fluid.cfl);
    if (done.dt_s < settings_.limits.smallest_s)
      throw NumericalFailure(
          "coupling: the time step fell to {:.3g} s, and still the fluid would move {:.3g} cells in it",
          done.dt_s, done.fluid.cfl);
  }
  done.critical_s = body_ ? critical_step() : std::numeric_limits<double>::infinity();
  if (body_) {
    interpolate(flow_.velocity(), velocity_, true);
    body_->move(velocity_, done.dt_s);
    double trembling = 0;
    for (std::size_t a = 0; a < velocity_.size(); ++a) {
      const Vec3 change = velocity_[a] - last_velocity_[a];
      trembling = std::max(trembling, (change - change_[a]).squaredNorm());
      change_[a] = change;
    }
    if (body_->lead() > 0) calm_.see(std::sqrt(trembling) * done.dt_s / flow_.grid().h);
    last_velocity_ = velocity_;
  }
  max_speed_ = done.fluid.max_speed;
  last_dt_ = done.repeats > 0 ? done.dt_s : planned;  // what was asked for does not hold the next one back
  ++steps_;
  return done;
}

std::map<std::string, state::Array> ImmersedFlow::save() const {
  std::map<std::string, state::Array> arrays = flow_.save();
  if (body_) {
    arrays.merge(body_->save());
    arrays["coupling/points"] = state::Array::of(body_->x());
    arrays["coupling/direction"] = state::Array::of(power_.direction());
    arrays["coupling/velocity"] = state::Array::of(last_velocity_);
    arrays["coupling/change"] = state::Array::of(change_);
    arrays["coupling/probed_points"] = state::Array::of(probed_x_);
  }
  arrays["coupling/history"] = state::Array::of(
      std::vector<double>{static_cast<double>(steps_), last_dt_, max_speed_, caution_, power_.eigenvalue(),
                          static_cast<double>(probed_), static_cast<double>(interval_), calm_.factor()});
  return arrays;
}

void ImmersedFlow::load(const state::State& state) {
  flow_.load(state);
  const std::vector<double>& history = state.array("coupling/history").doubles("coupling/history");
  if (history.size() != 8)
    throw InputError("{}: coupling/history has {} entries, expected 8", state.source, history.size());
  steps_ = static_cast<long>(history[0]);
  last_dt_ = history[1];
  max_speed_ = history[2];
  caution_ = history[3];
  probed_ = static_cast<long>(history[5]);
  interval_ = static_cast<int>(history[6]);
  calm_.restore(history[7]);
  if (!body_) return;
  const auto points = [&](const char* name, std::size_t size) {
    Points read = state.array(name).points(name);
    if (read.size() != size)
      throw InputError("{}: {} has {} entries, the structure has {}", state.source, name, read.size(), size);
    return read;
  };
  const std::size_t nodes = body_->x().size(), unknowns = body_->unknowns();
  Points x = points("coupling/points", nodes);
  Points direction = points("coupling/direction", unknowns);
  last_velocity_ = points("coupling/velocity", unknowns);
  change_ = points("coupling/change", unknowns);
  probed_x_ = points("coupling/probed_points", nodes);
  body_->load(state);
  body_->set_x(std::move(x));
  power_.restore(std::move(direction), history[4]);
}

}  // namespace valsalva::coupling
