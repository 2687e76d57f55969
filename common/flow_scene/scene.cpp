#include "flow_scene/scene.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/units.hpp"

namespace valsalva::flow_scene {

namespace {

constexpr int cells_of_no_extent = 4;
constexpr double smallest_step = 1e-9;  // of the run

fluid::Grid grid_of(const Case& scene, const Sides& sides) {
  const std::string file = scene.file().string();
  const auto& box = scene.reals("fluid.box_mm");
  if (box.size() != 6)
    throw InputError("{}: fluid.box_mm has {} entries; expected six, the low and the high corner", file,
                     box.size());
  const auto& cells = scene.reals("fluid.cells");
  double h = scene.real("fluid.grid_mm");
  if ((h > 0) == !cells.empty())
    throw InputError("{}: found both or neither of fluid.grid_mm and fluid.cells; expected one of them",
                     file);
  if (!cells.empty() && cells.size() != 3)
    throw InputError("{}: fluid.cells has {} entries; expected three", file, cells.size());
  Vec3 low, extent;
  for (int e = 0; e < 3; ++e) {
    low[e] = box[e];
    extent[e] = box[e + 3] - box[e];
    if (extent[e] < 0)
      throw InputError("{}: fluid.box_mm ends at {} before it begins at {} along {}", file, box[e + 3],
                       box[e], "xyz"[e]);
    if (extent[e] == 0 && !sides.periodic(e) && !sides.slip(e))
      throw InputError(
          "{}: fluid.box_mm has no extent along {}; that is for directions with periodic or slip sides", file,
          "xyz"[e]);
    if (!cells.empty() && extent[e] > 0 && h == 0) h = extent[e] / cells[e];
  }
  if (!(h > 0)) throw InputError("{}: fluid.box_mm has no extent at all", file);
  fluid::Grid grid;
  grid.h = h;
  for (int e = 0; e < 3; ++e) {
    const int own = sides.frame().solver_axis(e);
    const double count = extent[e] > 0 ? extent[e] / h : !cells.empty() ? cells[e] : cells_of_no_extent;
    const bool whole = !cells.empty() && extent[e] > 0;
    // Behind an outflow or a slip side the box may end a part of a cell later.
    const bool ends_anywhere = cells.empty() && sides.ends_anywhere(e);
    const double asked = whole ? cells[e] : ends_anywhere ? std::ceil(count - 1e-6) : std::round(count);
    if (!ends_anywhere && std::abs(count - asked) > 1e-6 * count)
      throw InputError(
          "{}: fluid: the box is {} cells of {} mm long in {}, {} were asked for; cells are cubes of one "
          "size",
          file, count, h, "xyz"[e], asked);
    grid.cells[own] = static_cast<int>(asked) + sides.more_cells(e, 0) + sides.more_cells(e, 1);
    grid.origin[own] = low[e] - sides.more_cells(e, 0) * h;
    const int needed = fluid::fewest_cells(sides.periodic(e), sides.fluid_cells());
    if (grid.cells[own] < needed)
      throw InputError("{}: fluid: {} cells along {}; expected at least {}", file, grid.cells[own], "xyz"[e],
                       needed);
  }
  return grid;
}

fluid::FlowParameters parameters_of(const Case& scene, const Sides& sides) {
  fluid::FlowParameters p;
  if (sides.fluid_cells())
    p.krylov = fluid::KrylovSettings{.tolerance = scene.real("fluid.pressure_tolerance")};
  p.density = scene.real("fluid.density_g_per_mm3");
  p.viscosity = scene.real("fluid.viscosity_Pa_s");
  p.order = static_cast<int>(scene.integer("fluid.order"));
  p.convection = scene.is_set("fluid.convection") || p.order == 2
                     ? fluid::convection_from(scene.text("fluid.convection"))
                     : fluid::Convection::conserving4;
  p.penalisation_s = scene.real("fluid.penalisation_s");
  p.wall = fluid::wall_from(scene.text("fluid.wall"));
  p.wall_upwind = scene.text("fluid.wall_convection") == "upwind1";
  p.implicit_viscosity = scene.text("fluid.viscosity_scheme") == "implicit";
  if (scene.text("fluid.subgrid") == "vreman") p.extra_viscosity.vreman = scene.real("fluid.vreman_constant");
  if (scene.text("fluid.viscosity_model") == "carreau-yasuda")
    p.extra_viscosity.carreau_yasuda = fluid::CarreauYasuda{
        scene.real("fluid.zero_shear_viscosity_Pa_s"), scene.real("fluid.carreau_time_s"),
        scene.real("fluid.carreau_exponent"), scene.real("fluid.carreau_transition")};
  return p;
}

/// Bodies may reach up to slip sides and walls.
coupling::Surroundings beyond(const Sides& sides) {
  coupling::Surroundings out{};
  const fluid::Boundaries boundaries = sides.boundaries();
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const fluid::Side kind = boundaries.side[axis][side];
      if (kind == fluid::Side::slip) out[axis][side] = coupling::Beyond::slip;
      if (kind == fluid::Side::wall) out[axis][side] = coupling::Beyond::wall;
    }
  }
  return out;
}

std::vector<std::string> columns_of(const Probes& probes, const Bodies* bodies, const std::string& file) {
  std::vector<std::string> columns{"time_s", "largest_speed_mm_per_s"};
  columns.insert(columns.end(), probes.columns().begin(), probes.columns().end());
  if (!bodies) return columns;
  for (const std::string& column : bodies->columns()) {
    if (std::find(columns.begin(), columns.end(), column) != columns.end())
      throw InputError("{}: a [[probe]] and a [[flow_probe]] both give the column {}; rename one of them",
                       file, column);
    columns.push_back(column);
  }
  return columns;
}

/// An image whose axes are those of the solver, in those of the case.
std::vector<float> turned(const std::vector<float>& values, const std::array<int, 3>& cells,
                          const Frame& frame, int components) {
  std::array<int, 3> n;
  for (int e = 0; e < 3; ++e) n[frame.case_axis(e)] = cells[e];
  std::vector<float> out(values.size());
  std::size_t from = 0;
  std::array<int, 3> at;
  for (at[2] = 0; at[2] < cells[2]; ++at[2]) {
    for (at[1] = 0; at[1] < cells[1]; ++at[1]) {
      for (at[0] = 0; at[0] < cells[0]; ++at[0], from += components) {
        std::array<int, 3> to;
        for (int e = 0; e < 3; ++e) to[frame.case_axis(e)] = at[e];
        const std::size_t place = (static_cast<std::size_t>(to[2]) * n[1] + to[1]) * n[0] + to[0];
        for (int c = 0; c < components; ++c)
          out[place * components + (components == 3 ? frame.case_axis(c) : c)] = values[from + c];
      }
    }
  }
  return out;
}

}  // namespace

bool has_box(const Case& scene) {
  return scene.has("fluid") && scene.is_set("fluid.box_mm");
}

FlowScene::FlowScene(const Case& scene, MPI_Comm comm)
    : sides_(scene),
      grid_(grid_of(scene, sides_)),
      obstacles_(scene, grid_.h),
      bodies_(Bodies::of(scene, obstacles_)),
      flow_(std::make_unique<fluid::Flow>(comm, grid_, sides_.boundaries(), parameters_of(scene, sides_))),
      probes_(scene, sides_, obstacles_, bodies_.get()),
      history_(columns_of(probes_, bodies_.get(), scene.file().string())),
      force_(scene.texts("fluid.body_force_Pa_per_mm"),
             scene.file().string() + ": fluid.body_force_Pa_per_mm"),
      rk3_(scene.text("fluid.time_scheme") == "rk3"),
      cfl_(scene.real("fluid.cfl") > 0 ? scene.real("fluid.cfl")
           : rk3_                      ? 1.0
                                       : 0.35),
      given_step_s_(scene.real("fluid.step_s")),
      end_s_(scene.real("fluid.end_s")),
      average_from_s_(scene.real("fluid.average_from_s")),
      rows_(scene.integer("fluid.history_rows")),
      rescue_(comm) {
  if (average_from_s_ < 0) average_from_s_ = 0.5 * end_s_;
  if (const auto& law = flow_->parameters().extra_viscosity.carreau_yasuda)
    zero_shear_viscosity_ = law->zero_shear;
  start(scene);
}

void FlowScene::start(const Case& scene) {
  const std::string file = scene.file().string();
  const VectorExpression velocity(scene.texts("fluid.velocity"), file + ": fluid.velocity");
  const Expression pressure(scene.text("fluid.pressure"), file + ": fluid.pressure");
  obstacles_.place(*flow_, frame(), 0, bodies_ ? bodies_->places() : Points{});
  sides_.openings().place(*flow_, frame(), obstacles_);
  for (const Case& probe : scene.entries("flow_probe")) {
    const std::string& quantity = probe.text("flow_probe.quantity");
    if (quantity != "force" && quantity != "moment") continue;
    obstacles_.prepare_loads(*flow_, frame(), probe.text("flow_probe.of"));
    for (const std::string& name : probe.texts("flow_probe.with"))
      obstacles_.prepare_loads(*flow_, frame(), name);
  }
  sides_.couple(*flow_);
  sides_.set(*flow_, 0, 0);
  const auto at_start = [&](int d, const Vec3& x) {
    return velocity.component(frame().case_axis(d), frame().to_case(x), 0);
  };
  flow_->set_velocity(at_start);
  flow_->set_pressure([&](const Vec3& x) { return pressure(frame().to_case(x), 0); });
  double speed = 0;
  const fluid::Slab& slab = flow_->slab();
  for (int k = 0; k < slab.planes; ++k) {
    for (int j = 0; j < slab.grid.cells[1]; ++j) {
      for (int i = 0; i < slab.grid.cells[0]; ++i) {
        double sum = 0;
        for (int d = 0; d < 3; ++d) sum += std::abs(flow_->velocity()[d](i, j, k));
        if (!std::isfinite(sum))
          throw InputError("{}: fluid.velocity is not finite in the box; change the expression", file);
        speed = std::max(speed, sum);
      }
    }
  }
  speed_ = mpi::max(slab.comm, speed);
  set_force(0);
  if (bodies_)
    bodies_->immerse(scene, *flow_, frame(), cfl_,
                     std::min(stable_s(), 0.5 * end_s_ / static_cast<double>(rows_)), smallest_step * end_s_,
                     beyond(sides_));
}

void FlowScene::set_force(double time_s) {
  if (forced_ && !force_.changes() && !obstacles_.move()) return;
  const fluid::Slab& slab = flow_->slab();
  for (int d = 0; d < 3; ++d) {
    const int of_case = frame().case_axis(d);
    for (int k = 0; k < (d == 2 ? slab.w_planes() : slab.planes); ++k) {
      for (int j = 0; j < slab.grid.cells[1]; ++j) {
        for (int i = 0; i < slab.grid.cells[0]; ++i) {
          // None in obstacles: it would count as a force of the fluid on them.
          const bool fluid = flow_->solids().owner(d, i, j, k) == 0;
          const Vec3 x = frame().to_case(slab.grid.position(d, i, j, k + slab.first));
          flow_->force()[d](i, j, k) = fluid ? force_.component(of_case, x, time_s) : 0;
        }
      }
    }
  }
  forced_ = true;
}

double FlowScene::stable_s() const {
  const fluid::FlowParameters& p = flow_->parameters();
  const double h = flow_->grid().h;
  double nu = p.implicit_viscosity ? 0 : p.viscosity / p.density;
  if (zero_shear_viscosity_ > 0) nu = std::max(nu, zero_shear_viscosity_ / p.density);
  if (const auto* extra = flow_->extra_viscosity()) nu += p.extra_viscosity.vreman > 0 ? extra->largest() : 0;
  const double speed = std::max({speed_, sides_.largest_speed(*flow_), obstacles_.largest_speed(*flow_)});
  double limit = end_s_;
  if (nu > 0) limit = std::min(limit, (rk3_ ? 0.18 : 1.0 / 14) * h * h / nu);
  if (speed > 0) limit = std::min(limit, cfl_ * h / speed);
  return limit;
}

double FlowScene::next_step_s() const {
  if (given_step_s_ > 0) return given_step_s_;
  return std::min(stable_s(), step_s_ > 0 ? 1.2 * step_s_ : 1e-3 * end_s_);
}

void FlowScene::prescribe(double time_s) {
  if (obstacles_.move()) obstacles_.update(*flow_, frame(), time_s);
  sides_.set(*flow_, time_s_, time_s);
}

void FlowScene::step() {
  if (bodies_) return step_with_bodies();
  const double row_s = end_s_ * static_cast<double>(row_ + 1) / static_cast<double>(rows_);
  const double remaining = row_s - time_s_, most = next_step_s();
  double count = std::max(1.0, std::ceil(remaining / most - 1e-9));
  // Growth by 1.2 may round to none: then one step less to the row, if that is stable.
  if (given_step_s_ == 0 && count > 1 && remaining < (1 + 1e-9) * count * step_s_ &&
      remaining <= (count - 1) * stable_s())
    --count;
  const double dt = remaining / count, start = time_s_;
  set_force(start + 0.5 * dt);
  fluid::StepReport report;
  if (rk3_) {
    report = flow_->step_rk3(dt, [&](double part) { prescribe(start + part * dt); });
  } else {
    prescribe(start + dt);
    report = flow_->step(dt);
  }
  finish_step(start, dt, row_s, count == 1, report.max_speed);
}

void FlowScene::finish_step(double start_s, double dt_s, double row_s, bool meets_row, double max_speed) {
  sides_.advance(*flow_, start_s, dt_s);
  speed_ = max_speed;
  step_s_ = dt_s;
  ++steps_;
  row_due_ = meets_row;
  time_s_ = row_due_ ? row_s : start_s + dt_s;
  if (row_due_) ++row_;
}

// set_force for a field to which the bodies add theirs in every step.
void FlowScene::add_force_again(double time_s) {
  if (!constant_force_ || force_.changes() || obstacles_.move()) {
    forced_ = false;
    set_force(time_s);
    constant_force_ = flow_->force();
  } else {
    flow_->force() = *constant_force_;
  }
}

void FlowScene::step_with_bodies() {
  rescue_.before_step(steps_, bodies_->system(), [&] { return save_run(); });
  const double row_s = end_s_ * static_cast<double>(row_ + 1) / static_cast<double>(rows_);
  const double start = time_s_, remaining = row_s - start;
  coupling::StepHooks hooks;
  hooks.fit = [&](double dt) { return remaining / std::max(1.0, std::ceil(remaining / dt - 1e-9)); };
  hooks.set_force = [&](double dt) { add_force_again(start + 0.5 * dt); };
  hooks.set_ends = [&](double dt) { prescribe(start + dt); };
  coupling::ImmersedStep done;
  try {
    done = bodies_->step(start, next_step_s(), std::move(hooks));
  } catch (const NumericalFailure& alarm) {
    const std::string why = alarm.what();
    rescue_.go_back(why, bodies_->system(), [&](const state::State& copy) { load_run(copy); });
    row_due_ = false;
    log::warn("back to t = {:.6g} s, steps {:.2g} times as large: {}", time_s_, bodies_->system().caution(),
              why);
    return;
  }
  finish_step(start, done.dt_s, row_s, done.dt_s >= remaining, done.fluid.max_speed);
}

void FlowScene::add_row() {
  std::vector<double> row{time_s_, speed_};
  const std::vector<double> measured_now = probes_.values(measured());
  row.insert(row.end(), measured_now.begin(), measured_now.end());
  if (bodies_) {
    const std::vector<double> of_bodies = bodies_->values();
    row.insert(row.end(), of_bodies.begin(), of_bodies.end());
  }
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (!std::isfinite(row[i]))
      throw NumericalFailure("'{}' is not finite at {} s; reduce fluid.cfl or fluid.step_s",
                             history_.columns()[i], time_s_);
  }
  history_.add(row);
  if (time_s_ >= average_from_s_ - 1e-12 * end_s_) probes_.add_to_means(measured());
}

std::vector<std::pair<std::string, std::string>> FlowScene::profiles() {
  return probes_.profiles(measured());
}

std::map<std::string, double> FlowScene::metrics() const {
  std::map<std::string, double> out;
  if (bodies_) {
    out = bodies_->metrics();
    out["coupling_returns"] = static_cast<double>(rescue_.returns());
  }
  if (history_.rows() == 0) return out;
  const std::vector<double> time = history_.column("time_s");
  const auto first = static_cast<std::size_t>(
      std::lower_bound(time.begin(), time.end(), average_from_s_ - 1e-12 * end_s_) - time.begin());
  for (const std::string& column : history_.columns()) {
    if (column == "time_s") continue;
    const std::vector<double> value = history_.column(column);
    out[column] = value.back();
    if (first + 2 > value.size()) continue;
    double sum = 0, low = value[first], high = low;
    for (std::size_t i = first; i < value.size(); ++i) {
      low = std::min(low, value[i]);
      high = std::max(high, value[i]);
      if (i > first) sum += 0.5 * (value[i] + value[i - 1]) * (time[i] - time[i - 1]);
    }
    const double mean = sum / (time.back() - time[first]);
    out[column + "_mean"] = mean;
    out[column + "_min"] = low;
    out[column + "_max"] = high;
    // Upward crossings of the mean, where the signal moves at all.
    double first_crossing = 0, last_crossing = 0;
    int crossings = 0;
    for (std::size_t i = first + 1; i < value.size(); ++i) {
      if (!(value[i - 1] < mean && value[i] >= mean)) continue;
      const double share = (mean - value[i - 1]) / (value[i] - value[i - 1]);
      last_crossing = time[i - 1] + share * (time[i] - time[i - 1]);
      if (crossings++ == 0) first_crossing = last_crossing;
    }
    if (crossings > 2 && high - low > 1e-6 * std::max(std::abs(high), std::abs(low)))
      out[column + "_frequency_Hz"] = (crossings - 1) / (last_crossing - first_crossing);
  }
  return out;
}

std::map<std::string, state::Array> FlowScene::save() const {
  auto arrays = save_run();
  if (bodies_) arrays.merge(rescue_.save());
  return arrays;
}

void FlowScene::load(const state::State& state) {
  load_run(state);
  if (bodies_) rescue_.load(state);
}

std::map<std::string, state::Array> FlowScene::save_run() const {
  auto arrays = bodies_ ? bodies_->system().save() : flow_->save();
  if (flow_->slab().rank != 0) return arrays;
  arrays["scene/march"] = state::Array::of(
      std::vector<double>{time_s_, static_cast<double>(steps_), average_from_s_, step_s_, speed_});
  arrays["scene/history"] = state::Array::of(history_.values());
  arrays["scene/outlets"] = state::Array::of(sides_.save());
  arrays["scene/means"] = state::Array::of(probes_.save());
  if (obstacles_.move()) arrays["scene/obstacles"] = state::Array::of(obstacles_.save());
  if (bodies_) arrays["scene/bodies"] = state::Array::of(bodies_->save());
  return arrays;
}

void FlowScene::load_run(const state::State& state) {
  const auto& march = state.array("scene/march").doubles("scene/march");
  if (march.size() != 5)
    throw InputError("{}: scene/march has {} entries, expected 5", state.source, march.size());
  time_s_ = march[0];
  steps_ = static_cast<long>(march[1]);
  // Rows and what is averaged may be others than before.
  row_ = static_cast<long>(std::floor(time_s_ / end_s_ * static_cast<double>(rows_) + 1e-9));
  step_s_ = march[3];
  speed_ = march[4];
  history_.restore(state.array("scene/history").doubles("scene/history"));
  sides_.restore(state.array("scene/outlets").doubles("scene/outlets"));
  if (march[2] == average_from_s_) {
    probes_.restore(state.array("scene/means").doubles("scene/means"));
  } else if (time_s_ > average_from_s_) {
    log::warn("profiles are averaged from {} s on, not from {} s: the state has averages from {} s on",
              time_s_, average_from_s_, march[2]);
  }
  if (obstacles_.move()) {
    obstacles_.update(*flow_, frame(), time_s_);
    obstacles_.restore(state.array("scene/obstacles").doubles("scene/obstacles"));
  }
  sides_.set(*flow_, time_s_, time_s_);
  if (bodies_) {
    bodies_->restore(state.array("scene/bodies").doubles("scene/bodies"));
    bodies_->system().load(state);
  } else {
    flow_->load(state);
  }
}

state::Image FlowScene::image() const {
  state::Image image = flow_->image();
  const std::array<int, 3> cells = flow_->grid().cells;
  std::array<std::int64_t, 3> dimensions;
  for (int e = 0; e < 3; ++e) dimensions[frame().case_axis(e)] = cells[e];
  image.origin = frame().to_case(image.origin);
  image.dimensions = dimensions;
  std::vector<std::size_t> shape;
  for (int e = 2; e >= 0; --e) shape.push_back(static_cast<std::size_t>(dimensions[e]));
  for (auto& [name, array] : image.point_data) {
    const bool vector = array.shape.size() == 4;
    std::vector<std::size_t> of = shape;
    if (vector) of.push_back(3);
    array = state::Array::of(turned(array.floats(name), cells, frame(), vector ? 3 : 1), of);
  }
  if (flow_->slab().rank != 0 || obstacles_.all().empty()) return image;
  std::vector<float> solid(shape[0] * shape[1] * shape[2]);
  std::size_t at = 0;
  for (std::int64_t k = 0; k < dimensions[2]; ++k) {
    for (std::int64_t j = 0; j < dimensions[1]; ++j) {
      for (std::int64_t i = 0; i < dimensions[0]; ++i, ++at) {
        const Vec3 x = image.origin + flow_->grid().h * Vec3(i, j, k);
        for (const auto& obstacle : obstacles_.all())
          if (!obstacle.part && obstacle.distance_at(x, time_s_) < 0) solid[at] = 1;
      }
    }
  }
  image.point_data["obstacle"] = state::Array::of(std::move(solid), shape);
  return image;
}

}  // namespace valsalva::flow_scene
