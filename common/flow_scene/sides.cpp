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

void read_table(const std::filesystem::path& file, const std::string& what, std::vector<double>& time,
                std::vector<double>& value) {
  std::ifstream in(file);
  if (!in) throw InputError("{}: factor_file '{}' cannot be read", what, file.string());
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    double t, f;
    if (!(fields >> t >> f)) continue;  // header, comment
    time.push_back(t);
    value.push_back(f);
  }
  if (time.empty())
    throw InputError("{}: factor_file '{}' holds no row of two numbers, time_s and factor", what,
                     file.string());
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

Factor::Factor(const Case& scene, const Case& entry, const std::string& what)
    : time_(entry.reals("boundary.time_s")),
      value_(entry.reals("boundary.factor")),
      period_s_(entry.real("boundary.period_s")) {
  const std::string &file = entry.text("boundary.factor_file"), &text = entry.text("boundary.factor_of_t");
  if ((!time_.empty() || !value_.empty()) + !file.empty() + !text.empty() > 1)
    throw InputError("{}: more than one of factor, factor_file, factor_of_t; expected one", what);
  if (!text.empty()) expression_.emplace(text, what + ", factor_of_t");
  if (expression_ && expression_->varies())
    throw InputError("{}: factor_of_t '{}' has x, y or z; expected t alone", what, text);
  if (!file.empty()) read_table(scene.resolve(file), what, time_, value_);
  if (time_.empty() && value_.empty()) return;
  const assembly::TimeTable checked(time_, value_, what);
  if (period_s_ > 0 && time_.back() > period_s_)
    throw InputError("{}: time_s ends at {} s, after period_s = {}", what, time_.back(), period_s_);
}

double Factor::operator()(double time_s) const {
  if (expression_) return (*expression_)(Vec3::Zero(), time_s);
  if (time_.empty()) return 1;
  double t = time_s;
  if (period_s_ > 0) t -= period_s_ * std::floor(t / period_s_);
  const auto next = std::upper_bound(time_.begin(), time_.end(), t);
  std::size_t to = next - time_.begin();
  const bool wraps = period_s_ > 0 && (to == 0 || to == time_.size());
  if (!wraps && to == 0) return value_.front();
  if (!wraps && to == time_.size()) return value_.back();
  const std::size_t from = to == 0 ? time_.size() - 1 : to - 1;
  const double start = to == 0 ? time_[from] - period_s_ : time_[from];
  const double end = to == time_.size() ? time_[0] + period_s_ : time_[to];
  if (to == time_.size()) to = 0;
  const double share = end > start ? (t - start) / (end - start) : 0;
  return value_[from] + share * (value_[to] - value_[from]);
}

Sides::Sides(const Case& scene) {
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
  for (int axis = 0; axis < 3; ++axis) {
    if ((kind_[axis][0] == Side::periodic) != (kind_[axis][1] == Side::periodic))
      throw InputError("{}: one side along {} is periodic and the other is not; make both periodic",
                       scene.file().string(), axis_name[axis]);
    for (int side = 0; side < 2; ++side) {
      if (kind_[axis][side] != Side::open) continue;
      if (open && axis != open_axis)
        throw InputError(
            "{}: outflow sides along {} and along {}; known pressure is possible along one axis only: give "
            "the others as inflow with a known velocity",
            scene.file().string(), axis_name[open_axis], axis_name[axis]);
      open = true;
      open_axis = axis;
    }
  }
  frame_ = Frame::with_open_axis(open_axis);
  for (int side = 0; side < 2; ++side) {
    if (!open || kind_[open_axis][side] != Side::open) continue;
    const Entry& entry = entries_[entry_of_[open_axis][side]];
    Outlet outlet{side, &entry, nullptr};
    if (entry.windkessel)
      outlet.terminal = std::make_unique<circulation::Windkessel>(*entry.windkessel, entry.pressure);
    else if (entry.resistance > 0)
      outlet.terminal = std::make_unique<circulation::Resistance>(entry.resistance, entry.pressure);
    outlets_.push_back(std::move(outlet));
  }
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
  out.pressure = e.real("pressure_Pa");
  out.factor = std::make_shared<Factor>(scene, entry, e.what());
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
  const double resistance = e.real("resistance_Pa_s_per_mL") / units::mm3_per_mL;
  const double compliance = e.real("compliance_mL_per_Pa") * units::mm3_per_mL;
  if (compliance > 0) {
    if (!(resistance > 0)) e.fail("compliance_mL_per_Pa needs a resistance_Pa_s_per_mL");
    out.windkessel = circulation::WindkesselParameters{
        e.real("characteristic_Pa_s_per_mL") / units::mm3_per_mL, resistance, compliance};
  } else {
    out.resistance = resistance;
  }
  return out;
}

bool Sides::has_outflow() const {
  return !outlets_.empty();
}

fluid::Boundaries Sides::boundaries() const {
  fluid::Boundaries out;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) out.side[frame_.solver_axis(axis)][side] = kind_[axis][side];
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

void Sides::set(fluid::Flow& flow, double time_s) {
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
    flow.set_end_pressure(outlet.end == 0 ? fluid::End::low : fluid::End::high,
                          outlet.terminal ? outlet.terminal->pressure()
                                          : outlet.entry->pressure * (*outlet.entry->factor)(time_s));
}

void Sides::advance(fluid::Flow& flow, double time_s, double dt_s) {
  for (Outlet& outlet : outlets_)
    if (outlet.terminal) outlet.terminal->advance(time_s, dt_s, flow.outflow(2, outlet.end));
}

double Sides::largest_speed(const fluid::Flow& flow) const {
  double largest = 0;
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
    if (!outlet.terminal) continue;
    const auto one = outlet.terminal->save();
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

void Sides::restore(const std::vector<double>& saved) {
  std::size_t at = 0;
  for (Outlet& outlet : outlets_) {
    if (!outlet.terminal) continue;
    const std::size_t count = outlet.terminal->save().size();
    if (at + count > saved.size())
      throw InputError("the state does not hold what stands behind the outflow sides; start anew");
    outlet.terminal->restore(
        {saved.begin() + static_cast<long>(at), saved.begin() + static_cast<long>(at + count)});
    at += count;
  }
}

}  // namespace valsalva::flow_scene
