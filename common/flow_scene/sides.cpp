#include "flow_scene/sides.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "assembly/entry.hpp"
#include "core/units.hpp"

namespace valsalva::flow_scene {

namespace {

using fluid::Side;

const std::array<const char*, 3> axis_name{"x", "y", "z"};
const std::array<const char*, 2> end_name{"low", "high"};

std::string name_of(const SideOfBox& side) {
  return fmt::format("{}_{}", axis_name[side.axis], end_name[side.side]);
}

std::vector<SideOfBox> sides_from(const std::vector<std::string>& names, const std::string& what) {
  std::vector<SideOfBox> sides;
  for (const std::string& name : names) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        if (name == "all" || name == axis_name[axis]) sides.push_back({axis, side});
      }
    }
    if (name != "all" && name.size() != 1) sides.push_back(side_from(name, what));
  }
  if (sides.empty())
    throw InputError("{}: sides is empty or unknown; expected some of x_low, x_high ... z_high, x, y, z, all",
                     what);
  return sides;
}

}  // namespace

SideOfBox side_from(const std::string& name, const std::string& what) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      if (name == name_of({axis, side})) return {axis, side};
    }
  }
  throw InputError("{}: side '{}' is not known; expected x_low, x_high, y_low, y_high, z_low or z_high", what,
                   name);
}

Sides::Sides(const Case& scene) : openings_(scene) {
  for (auto& sides : cut_) sides = {-1, -1};
  for (auto& sides : kind_) sides = {Side::slip, Side::slip};
  for (auto& sides : entry_of_) sides = {-1, -1};
  for (const Case& entry : scene.entries("boundary")) {
    entries_.push_back(read(scene, entry));
    for (const auto& [axis, side] : entries_.back().sides) {
      if (entry_of_[axis][side] >= 0)
        throw InputError("{}: the side {} is also in {}; expected one entry a side", entries_.back().what,
                         name_of({axis, side}), entries_[entry_of_[axis][side]].what);
      entry_of_[axis][side] = static_cast<int>(entries_.size()) - 1;
      kind_[axis][side] = entries_.back().kind;
    }
  }
  int open_axis = 2;
  bool open = false;
  const std::string solver = scene.text("fluid.pressure_solver");
  for (int axis = 0; axis < 3; ++axis) {
    if ((kind_[axis][0] == Side::periodic) != (kind_[axis][1] == Side::periodic))
      throw InputError("{}: one side along {} is periodic and the other is not; make both periodic",
                       scene.file().string(), axis_name[axis]);
    for (int side = 0; side < 2; ++side) {
      if (kind_[axis][side] != Side::open) continue;
      const Case& entry = scene.entries("boundary")[entry_of_[axis][side]];
      if (!open || axis == open_axis) {
        outlets_.push_back({side, KnownPressure(scene, entry, "boundary")});
        open_axis = axis;
      } else {
        if (solver == "direct")
          throw InputError(
              "{}: outflow sides along {} and along {}; the direct pressure solver knows pressure along one "
              "axis only: leave fluid.pressure_solver, or give the others as inflow with a known velocity",
              scene.file().string(), axis_name[open_axis], axis_name[axis]);
        cut_[axis][side] =
            openings_.add_side(name_of({axis, side}), axis, side, KnownPressure(scene, entry, "boundary"));
      }
      open = true;
    }
  }
  frame_ = Frame::with_open_axis(open_axis);
  if (openings_.any() && solver == "direct")
    throw InputError("{}: [[opening]] needs fluid.pressure_solver auto or krylov, found direct",
                     scene.file().string());
  fluid_cells_ = openings_.any() || solver == "krylov";
}

Sides::Entry Sides::read(const Case& scene, const Case& entry) const {
  const assembly::Entry e(scene, "boundary", entry);
  Entry out;
  out.what = e.what();
  out.sides = sides_from(e.texts("sides"), e.what());
  const std::string& kind = e.text("kind");
  out.velocity = std::make_shared<VectorExpression>(e.texts("velocity"), e.what() + ", velocity");
  // A wall that moves differently from place to place is a side of known velocity.
  out.kind = kind == "slip"           ? Side::slip
             : kind == "periodic"     ? Side::periodic
             : kind == "inflow"       ? Side::inflow
             : kind == "outflow"      ? Side::open
             : out.velocity->varies() ? Side::inflow
                                      : Side::wall;
  out.profile = kind == "wall" ? "wall" : e.text("profile");
  out.centre = e.vector("centre_mm");
  out.radius = e.real("radius_mm");
  out.speed = e.real("speed_mm_per_s");
  out.mean = e.real("mean_speed_mm_per_s");
  out.flow_mm3 = e.real("flow_mL_per_s") * units::mm3_per_mL;
  out.factor = std::make_shared<Factor>(scene, entry, "boundary", e.what());
  if (kind == "inflow" && out.profile != "given") {
    if ((out.speed != 0) + (out.mean != 0) + (out.flow_mm3 != 0) != 1)
      e.fail(fmt::format("profile {} needs one of speed_mm_per_s, mean_speed_mm_per_s, flow_mL_per_s",
                         out.profile));
    if (out.profile == "disc" && !(out.radius > 0)) e.fail("profile disc needs a radius_mm above 0");
  }
  for (const char* key : {"speed_mm_per_s", "mean_speed_mm_per_s", "flow_mL_per_s", "profile"})
    if (e.is_set(key) && (kind != "inflow" || out.profile == "given") && e.text("profile") == "given")
      e.fail(fmt::format("{} is for inflow with profile uniform, parabola or disc", key));
  for (const char* key :
       {"pressure_Pa", "resistance_Pa_s_per_mL", "compliance_mL_per_Pa", "characteristic_Pa_s_per_mL"})
    if (e.is_set(key) && kind != "outflow") e.fail(fmt::format("{} is for outflow", key));
  return out;
}

bool Sides::has_outflow() const {
  return !outlets_.empty() || openings_.have_known_pressure();
}

fluid::Boundaries Sides::boundaries() const {
  fluid::Boundaries out;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side)
      out.side[frame_.solver_axis(axis)][side] = cut_[axis][side] < 0 ? kind_[axis][side] : Side::slip;
  }
  return out;
}

void Sides::set_inflow(fluid::Flow& flow, const Entry& entry, const SideOfBox& side, double time_s) const {
  const int axis = side.axis, solver_axis = frame_.solver_axis(axis);
  const double factor = (*entry.factor)(time_s);
  if (entry.profile == "given" || entry.profile == "wall") {
    const bool wall = entry.profile == "wall";
    flow.set_inflow(solver_axis, side.side, [&](int d, const Vec3& x) {
      const int c = frame_.case_axis(d);
      return wall && c == axis ? 0 : factor * entry.velocity->component(c, frame_.to_case(x), time_s);
    });
    return;
  }
  const Vec3 low = frame_.to_case(flow.grid().low()), high = frame_.to_case(flow.grid().high());
  const auto shape = [&](const Vec3& x) {
    Vec3 r = x - entry.centre;
    r[axis] = 0;
    if (entry.profile == "disc") return std::max(0.0, 1 - r.squaredNorm() / (entry.radius * entry.radius));
    if (entry.profile == "uniform") return entry.radius > 0 && r.norm() >= entry.radius ? 0.0 : 1.0;
    double product = 1;
    for (int e = 0; e < 3; ++e) {
      if (e == axis || kind_[e][0] != Side::wall || kind_[e][1] != Side::wall) continue;
      const double s = (x[e] - low[e]) / (high[e] - low[e]);
      product *= 4 * s * (1 - s);
    }
    return product;
  };
  double scale = factor * (side.side == 0 ? 1 : -1);
  const auto set = [&](double by) {
    flow.set_inflow(solver_axis, side.side, [&](int d, const Vec3& x) {
      return d == solver_axis ? by * shape(frame_.to_case(x)) : 0.0;
    });
  };
  if (entry.speed != 0) {
    scale *= entry.speed;
  } else {
    set(side.side == 0 ? 1 : -1);
    const auto carried = flow.given_inflow(solver_axis, side.side);
    if (!(carried.inwards > 0))
      throw InputError("{}: the profile carries no flow through {}; check that the fluid reaches this side",
                       entry.what, name_of(side));
    scale *= (entry.mean != 0 ? entry.mean * carried.flowing_area : entry.flow_mm3) / carried.inwards;
  }
  set(scale);
}

// Without a side of known pressure what comes in must go out. Known velocities do so up to their
// discretisation; the rest is spread over the open faces of the inflow sides.
void Sides::balance(fluid::Flow& flow) const {
  double net = 0, size = 0, area = 0;
  const auto each = [&](const auto& body) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int side = 0; side < 2; ++side) {
        if (kind_[axis][side] == Side::inflow && entries_[entry_of_[axis][side]].profile != "wall")
          body(frame_.solver_axis(axis), side);
      }
    }
  };
  each([&](int axis, int side) {
    const auto given = flow.given_inflow(axis, side);
    net += given.inwards;
    size += given.size;
    area += given.area;
  });
  if (std::abs(net) > 0.01 * size)
    throw InputError(
        "the inflow sides take in {:.6g} mL/s more than they let out, and no side is an outflow; make one an "
        "outflow, or let velocities balance",
        net / units::mm3_per_mL);
  if (net == 0) return;
  each([&](int axis, int side) { flow.shift_inflow(axis, side, -net / area); });
}

void Sides::couple(fluid::Flow& flow) {
  ends_ = std::make_unique<coupling::ImplicitEnds>(flow);
  const auto add = [&](const KnownPressure& pressure, coupling::ImplicitEnds::Place place) {
    if (!pressure.modelled()) return;
    ends_->add(std::move(place));
    modelled_.push_back(&pressure);
  };
  for (const Outlet& outlet : outlets_)
    add(outlet.pressure, {outlet.end == 0 ? fluid::End::low : fluid::End::high,
                          [&flow, end = outlet.end] { return flow.outflow(2, end); }});
  for (int o = 0; o < openings_.count(); ++o)
    if (const KnownPressure* pressure = openings_.pressure(o))
      add(*pressure, {o, [&flow, o] { return flow.opening_flow(o); }});
  if (!modelled_.empty())
    flow.after_projection(
        [this](double dt_s, const fluid::StepReport& found) { return meet_models(dt_s, found); });
}

fluid::StepReport Sides::meet_models(double dt_s, const fluid::StepReport& found) {
  std::vector<coupling::Answer> answers(modelled_.size());
  for (std::size_t i = 0; i < modelled_.size(); ++i) {
    const auto answer = [this, model = modelled_[i]](double outflow) {
      return model->after(start_s_, until_s_ - start_s_, outflow);
    };
    const int place = static_cast<int>(i);
    if (coupling::slope(answer, ends_->outflow(place)) * dt_s * ends_->taken_by_itself(place) >
        coupling::explicit_until)
      answers[i] = answer;
  }
  return ends_->settle(dt_s, found, answers);
}

void Sides::set(fluid::Flow& flow, double start_s, double time_s) {
  start_s_ = start_s;
  until_s_ = time_s;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      if (entry_of_[axis][side] < 0) continue;
      const Entry& entry = entries_[entry_of_[axis][side]];
      if (entry.kind == Side::wall) {
        const Vec3 velocity = (*entry.factor)(time_s) * (*entry.velocity)(Vec3::Zero(), time_s);
        flow.set_wall_velocity(frame_.solver_axis(axis), side, frame_.to_solver(velocity));
      } else if (entry.kind == Side::inflow) {
        set_inflow(flow, entry, {axis, side}, time_s);
      }
    }
  }
  if (!has_outflow()) balance(flow);
  for (const Outlet& outlet : outlets_)
    flow.set_end_pressure(outlet.end == 0 ? fluid::End::low : fluid::End::high, outlet.pressure.at(time_s));
  openings_.set(flow, time_s);
}

void Sides::advance(fluid::Flow& flow, double time_s, double dt_s) {
  for (Outlet& outlet : outlets_) outlet.pressure.advance(time_s, dt_s, flow.outflow(2, outlet.end));
  openings_.advance(flow, time_s, dt_s);
}

double Sides::side_flow(const fluid::Flow& flow, const SideOfBox& side) const {
  const int opening = cut_[side.axis][side.side];
  return opening < 0 ? flow.outflow(frame_.solver_axis(side.axis), side.side)
                     : openings_.outflow(flow, opening);
}

double Sides::largest_speed(const fluid::Flow& flow) const {
  double largest = openings_.largest_speed(flow);
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const fluid::SideVelocity& given = flow.boundaries().inflow[axis][side];
      double sum = 0;
      for (int d = 0; d < 3; ++d) {
        double of = flow.boundaries().side[axis][side] == Side::wall
                        ? std::abs(flow.boundaries().velocity[axis][side][d])
                        : 0;
        for (double v : given.value[d]) of = std::max(of, std::abs(v));
        sum += of;
      }
      largest = std::max(largest, sum);
    }
  }
  return mpi::max(flow.slab().comm, largest);
}

std::vector<double> Sides::save() const {
  std::vector<double> all;
  for (const Outlet& outlet : outlets_) {
    const auto one = outlet.pressure.save();
    all.insert(all.end(), one.begin(), one.end());
  }
  const auto of_openings = openings_.save();
  all.insert(all.end(), of_openings.begin(), of_openings.end());
  return all;
}

void Sides::restore(const std::vector<double>& saved) {
  std::size_t at = 0;
  for (Outlet& outlet : outlets_) outlet.pressure.restore(saved, at);
  openings_.restore(saved, at);
}

}  // namespace valsalva::flow_scene
