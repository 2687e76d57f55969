#include "flow_scene/openings.hpp"

#include <algorithm>
#include <cmath>

#include "assembly/entry.hpp"
#include "core/units.hpp"
#include "flow_scene/section_profile.hpp"

namespace valsalva::flow_scene {

Openings::Openings(const Case& scene) {
  for (const Case& entry : scene.entries("opening")) {
    const assembly::Entry e(scene, "opening", entry);
    Opening out;
    out.name = e.text("name");
    out.what = e.what();
    out.centre = e.vector("centre_mm");
    out.normal = e.direction("normal");
    out.radius = e.real("radius_mm");
    if (!(out.radius > 0)) e.fail("radius_mm is missing; it must reach across the vessel's section");
    for (const Opening& other : openings_)
      if (other.name == out.name) e.fail("a second opening of this name; rename one");
    out.profile = e.text("profile");
    out.factor = std::make_shared<Factor>(scene, entry, "opening", e.what());
    const bool known_flow = e.text("kind") == "flow";
    for (const char* key :
         {"pressure_Pa", "resistance_Pa_s_per_mL", "compliance_mL_per_Pa", "characteristic_Pa_s_per_mL"})
      if (e.is_set(key) && known_flow) e.fail(fmt::format("{} is for kind pressure", key));
    for (const char* key : {"flow_mL_per_s", "profile"})
      if (e.is_set(key) && !known_flow) e.fail(fmt::format("{} is for kind flow", key));
    if (known_flow) {
      if (!e.is_set("flow_mL_per_s")) e.fail("flow_mL_per_s is missing; it counts into the fluid");
      out.inflow = e.real("flow_mL_per_s") * units::mm3_per_mL;
    } else {
      out.pressure.emplace(scene, entry, "opening");
    }
    openings_.push_back(std::move(out));
  }
}

int Openings::add_side(const std::string& name, int axis, int side, const KnownPressure& pressure) {
  Opening out;
  out.name = name;
  out.normal = (side == 0 ? -1 : 1) * Vec3::Unit(axis);
  out.side_axis = axis;
  out.side = side;
  out.pressure = pressure;
  openings_.push_back(std::move(out));
  return static_cast<int>(openings_.size()) - 1;
}

bool Openings::have_known_pressure() const {
  return std::any_of(openings_.begin(), openings_.end(),
                     [](const Opening& o) { return o.pressure.has_value(); });
}

int Openings::find(const std::string& name, const std::string& what) const {
  for (std::size_t o = 0; o < openings_.size(); ++o)
    if (openings_[o].name == name && openings_[o].side_axis < 0) return static_cast<int>(o);
  throw InputError("{}: of = '{}' is no opening; expected the name of an [[opening]]", what, name);
}

void Openings::place(fluid::Flow& flow, const Frame& frame, const Obstacles& obstacles) {
  const double h = flow.grid().h;
  for (Opening& opening : openings_) {
    if (opening.side_axis >= 0) {
      const Vec3 end = frame.to_case(opening.side == 0 ? flow.grid().low() : flow.grid().high());
      opening.centre = Vec3::Zero();
      opening.centre[opening.side_axis] =
          end[opening.side_axis] + (opening.side == 0 ? 1 : -1) * fluid::ghosts * h;
    }
    fluid::OpeningPlane plane{
        opening.name, frame.to_solver(opening.centre), frame.to_solver(opening.normal), opening.radius, {}};
    if (!opening.pressure && opening.profile == "uniform") plane.profile = [](const Vec3&) { return 1.0; };
    if (!opening.pressure && opening.profile == "parabola") {
      // One cell before the plane: a closed surface may end on it.
      const auto fluid = [&](const Vec3& x) {
        double distance = 1e300;
        for (const auto& obstacle : obstacles.all())
          if (!obstacle.part) distance = std::min(distance, obstacle.distance_at(x - h * opening.normal, 0));
        return distance;
      };
      const auto profile = section_profile(opening.centre, opening.normal, opening.radius, fluid, 0.5 * h);
      plane.profile = [profile, frame](const Vec3& x) { return profile(frame.to_case(x)); };
    }
    flow.add_opening(plane);
  }
}

void Openings::set(fluid::Flow& flow, double time_s) const {
  for (std::size_t o = 0; o < openings_.size(); ++o) {
    const Opening& opening = openings_[o];
    if (opening.pressure) {
      flow.openings().set_pressure(static_cast<int>(o), opening.pressure->at(time_s));
    } else {
      flow.openings().set_flow(static_cast<int>(o), -opening.inflow * (*opening.factor)(time_s));
    }
  }
}

void Openings::advance(const fluid::Flow& flow, double time_s, double dt_s) {
  for (std::size_t o = 0; o < openings_.size(); ++o)
    if (openings_[o].pressure)
      openings_[o].pressure->advance(time_s, dt_s, outflow(flow, static_cast<int>(o)));
}

double Openings::outflow(const fluid::Flow& flow, int opening) const {
  return flow.opening_flow(opening);
}

double Openings::largest_speed(const fluid::Flow& flow) const {
  const fluid::Openings* all = flow.openings_if_any();
  return all ? all->largest_prescribed() : 0;
}

std::vector<double> Openings::save() const {
  std::vector<double> all;
  for (const Opening& opening : openings_) {
    if (!opening.pressure) continue;
    const auto one = opening.pressure->save();
    all.insert(all.end(), one.begin(), one.end());
  }
  return all;
}

void Openings::restore(const std::vector<double>& saved, std::size_t& at) {
  for (Opening& opening : openings_)
    if (opening.pressure) opening.pressure->restore(saved, at);
}

}  // namespace valsalva::flow_scene
