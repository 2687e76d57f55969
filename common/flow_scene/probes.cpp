#include "flow_scene/probes.hpp"

#include <algorithm>
#include <cmath>

#include "assembly/entry.hpp"
#include "core/units.hpp"
#include "flow_scene/integrals.hpp"

namespace valsalva::flow_scene {

namespace {

using assembly::Entry;

int axis_from(const std::string& name) {
  return name == "x" ? 0 : name == "y" ? 1 : 2;
}

/// Names of the columns of a vector quantity, and the choice of its component.
struct Component {
  explicit Component(const Entry& e) : name(e.text("component")) {}
  std::vector<std::string> columns(const std::string& probe, const std::string& unit) const {
    if (name != "all") return {probe + "_" + unit};
    return {probe + "_x_" + unit, probe + "_y_" + unit, probe + "_z_" + unit};
  }
  void put(const Vec3& v, std::vector<double>& out) const {
    if (name == "all") {
      out.insert(out.end(), v.data(), v.data() + 3);
    } else {
      out.push_back(name == "magnitude" ? v.norm() : v[axis_from(name)]);
    }
  }
  std::string name;
};

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

Probes::Probes(const Case& scene, const Sides& sides, const Obstacles& obstacles, const Bodies* bodies) {
  for (const Case& entry : scene.entries("flow_probe")) {
    const Entry e(scene, "flow_probe", entry);
    const std::string name = e.text("name"), quantity = e.text("quantity"), what = e.what();
    const auto add = [&](const std::vector<std::string>& columns, Measure measure) {
      for (const std::string& column : columns) {
        if (std::find(columns_.begin(), columns_.end(), column) != columns_.end())
          e.fail(fmt::format("gives the column {} a second time; rename one of the probes", column));
        columns_.push_back(column);
      }
      measures_.push_back(std::move(measure));
    };
    const Component component(e);
    const Vec3 point = e.vector("point_mm");
    if (quantity == "velocity") {
      add(component.columns(name, "mm_per_s"), [=](const Measured& m, std::vector<double>& out) {
        component.put(m.frame.to_case(m.flow.velocity_at(Points{m.frame.to_solver(point)})[0]), out);
      });
    } else if (quantity == "pressure") {
      const auto& other = e.reals("minus_point_mm");
      if (!other.empty() && other.size() != 3)
        e.fail(fmt::format("minus_point_mm has {} entries; expected three", other.size()));
      add({name + "_Pa"}, [=](const Measured& m, std::vector<double>& out) {
        Points points{m.frame.to_solver(point)};
        if (!other.empty()) points.push_back(m.frame.to_solver(Vec3(other[0], other[1], other[2])));
        const std::vector<double> p = m.flow.pressure_at(points);
        out.push_back(other.empty() ? p[0] : p[0] - p[1]);
      });
    } else if (quantity == "profile") {
      const auto& ends = e.reals("line_mm");
      if (ends.size() != 6) e.fail(fmt::format("line_mm has {} entries; expected six", ends.size()));
      const Vec3 from(ends[0], ends[1], ends[2]), to(ends[3], ends[4], ends[5]);
      Line line;
      line.name = name;
      const auto count = entry.integer("flow_probe.points");
      for (std::int64_t i = 0; i < count; ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(count - 1);
        line.points.push_back(from + share * (to - from));
        line.s_mm.push_back(share * (to - from).norm());
      }
      line.sum.assign(4 * line.points.size(), 0.0);
      lines_.push_back(std::move(line));
    } else if (quantity == "flow" || quantity == "section_pressure") {
      const int axis = sides.frame().solver_axis(axis_from(e.text("axis")));
      const double at = e.real("at_mm");
      const Vec3 low = e.vector("low_mm"), high = e.vector("high_mm");
      const bool flow = quantity == "flow";
      add({name + (flow ? "_mL_per_s" : "_Pa")}, [=](const Measured& m, std::vector<double>& out) {
        const auto inside = [&](const Vec3& x) {
          const Vec3 c = m.frame.to_case(x);
          return (c.array() >= low.array()).all() && (c.array() <= high.array()).all();
        };
        out.push_back(flow ? section_flow(m.flow, axis, at, inside) / units::mm3_per_mL
                           : section_pressure(m.flow, axis, at, inside, what));
      });
    } else if (quantity == "side_flow") {
      const SideOfBox side = side_from(e.text("side"), what);
      add({name + "_mL_per_s"}, [=, &sides](const Measured& m, std::vector<double>& out) {
        out.push_back(sides.side_flow(m.flow, side) / units::mm3_per_mL);
      });
    } else if (quantity == "opening_flow") {
      const int opening = sides.openings().find(e.text("of"), what);
      add({name + "_mL_per_s"}, [=](const Measured& m, std::vector<double>& out) {
        out.push_back(m.flow.opening_flow(opening) / units::mm3_per_mL);
      });
    } else if (quantity == "opening_pressure") {
      const int opening = sides.openings().find(e.text("of"), what);
      add({name + "_Pa"}, [=](const Measured& m, std::vector<double>& out) {
        out.push_back(m.flow.openings().pressure(opening));
      });
    } else if (quantity == "pressure_iterations") {
      add({name},
          [](const Measured& m, std::vector<double>& out) { out.push_back(m.flow.pressure_iterations()); });
    } else if (quantity == "force" || quantity == "moment") {
      std::vector<std::string> names{e.text("of")}, soft;
      names.insert(names.end(), e.texts("with").begin(), e.texts("with").end());
      std::vector<const Obstacles::Obstacle*> hard;
      for (const std::string& one : names) {
        if (bodies && bodies->has(one)) {
          soft.push_back(one);
        } else {
          hard.push_back(&obstacles.find(one, what));
        }
      }
      const double speed = e.real("reference_speed_mm_per_s"), area = e.real("reference_area_mm2");
      const bool force = quantity == "force";
      if ((speed > 0) != (area > 0))
        e.fail("coefficients need both reference_speed_mm_per_s and reference_area_mm2");
      if (!force && area > 0) e.fail("coefficients are those of a force");
      auto columns = component.columns(name, force ? "N" : "N_mm");
      if (area > 0) columns = joined(columns, component.columns(name, "coefficient"));
      add(columns, [=](const Measured& m, std::vector<double>& out) {
        Obstacles::Load load{Vec3::Zero(), Vec3::Zero()};
        const auto take = [&](const Obstacles::Load& part) {
          load.force += part.force;
          load.moment += part.moment;
        };
        for (const auto* obstacle : hard)
          take(m.obstacles.load_on(m.flow, m.frame, *obstacle, point, m.time_s));
        for (const std::string& body : soft) take(m.bodies->load_on(body, point));
        component.put((force ? load.force : load.moment) / units::uN_per_N, out);
        if (area > 0)
          component.put(load.force / (0.5 * m.flow.parameters().density * speed * speed * area), out);
      });
    } else if (quantity == "momentum") {
      add(component.columns(name, "g_mm_per_s"), [=](const Measured& m, std::vector<double>& out) {
        Vec3 sum = m.frame.to_case(m.flow.momentum());
        if (m.bodies) sum += m.bodies->excess_momentum();
        component.put(sum, out);
      });
    } else if (quantity == "wall_shear_stress") {
      const auto& obstacle = obstacles.find(e.text("of"), what);
      add(component.columns(name, "Pa"), [=, &obstacle](const Measured& m, std::vector<double>& out) {
        const fluid::WallPoint wall = obstacle.wall_near(point, m.time_s, m.flow.grid().h, what);
        component.put(m.frame.to_case(m.flow.wall_shear_stress(
                          {{m.frame.to_solver(wall.x), m.frame.to_solver(wall.normal)}})[0]),
                      out);
      });
    } else if (quantity == "kinetic_energy" || quantity == "dissipation" || quantity == "enstrophy") {
      const int which = quantity == "kinetic_energy" ? 0 : quantity == "dissipation" ? 1 : 2;
      const std::array<const char*, 3> unit{"_nJ", "_nJ_per_s", "_mm3_per_s2"};
      add({name + unit[which]}, [=](const Measured& m, std::vector<double>& out) {
        const Turbulence now = turbulence(m.flow);
        out.push_back(which == 0   ? now.kinetic_nJ
                      : which == 1 ? now.dissipation_nJ_per_s
                                   : now.enstrophy_mm3_per_s2);
      });
    } else if (quantity == "divergence") {
      add({name + "_per_s"},
          [](const Measured& m, std::vector<double>& out) { out.push_back(m.flow.divergence()); });
    } else if (quantity == "step") {
      add({name + "_s"}, [](const Measured& m, std::vector<double>& out) { out.push_back(m.step_s); });
    } else if (quantity == "velocity_error") {
      const auto exact = std::make_shared<VectorExpression>(e.texts("exact"), what + ", exact");
      const bool rms = e.text("norm") == "rms";
      add({name + "_mm_per_s"}, [=](const Measured& m, std::vector<double>& out) {
        const Norms norms = velocity_error(m.flow, [&](int d, const Vec3& x) {
          return exact->component(m.frame.case_axis(d), m.frame.to_case(x), m.time_s);
        });
        out.push_back(rms ? norms.rms : norms.largest);
      });
    } else if (quantity == "pressure_error") {
      if (e.texts("exact").size() != 1)
        e.fail(fmt::format("exact has {} entries; expected one", e.texts("exact").size()));
      const auto exact = std::make_shared<Expression>(e.texts("exact")[0], what + ", exact");
      const bool rms = e.text("norm") == "rms";
      add({name + "_Pa"}, [=](const Measured& m, std::vector<double>& out) {
        const Norms norms =
            pressure_error(m.flow, [&](const Vec3& x) { return (*exact)(m.frame.to_case(x), m.time_s); });
        out.push_back(rms ? norms.rms : norms.largest);
      });
    } else {
      e.fail(fmt::format("quantity {} is not measured", quantity));
    }
  }
}

std::vector<double> Probes::values(const Measured& now) const {
  std::vector<double> out;
  for (const Measure& measure : measures_) measure(now, out);
  return out;
}

std::vector<double> Probes::on_line(const Line& line, const Measured& now) const {
  Points places;
  for (const Vec3& x : line.points) places.push_back(now.frame.to_solver(x));
  const std::vector<Vec3> u = now.flow.velocity_at(places);
  const std::vector<double> p = now.flow.pressure_at(places);
  std::vector<double> out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 here = now.frame.to_case(u[i]);
    out.insert(out.end(), {here[0], here[1], here[2], p[i]});
  }
  return out;
}

void Probes::add_to_means(const Measured& now) {
  for (Line& line : lines_) {
    const std::vector<double> values = on_line(line, now);
    for (std::size_t i = 0; i < values.size(); ++i) line.sum[i] += values[i];
    line.count += 1;
  }
}

std::vector<std::pair<std::string, std::string>> Probes::profiles(const Measured& now) const {
  std::vector<std::pair<std::string, std::string>> files;
  for (const Line& line : lines_) {
    const std::vector<double> values = on_line(line, now);
    const double count = std::max(1.0, line.count);
    const std::vector<double>& sums = line.count > 0 ? line.sum : values;
    std::string text =
        "s_mm,x_mm,y_mm,z_mm,u_mm_per_s,v_mm_per_s,w_mm_per_s,p_Pa,"
        "mean_u_mm_per_s,mean_v_mm_per_s,mean_w_mm_per_s,mean_p_Pa\n";
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const Vec3& x = line.points[i];
      text += fmt::format("{:.12g},{:.12g},{:.12g},{:.12g}", line.s_mm[i], x[0], x[1], x[2]);
      for (int c = 0; c < 4; ++c) text += fmt::format(",{:.12g}", values[4 * i + c]);
      for (int c = 0; c < 4; ++c) text += fmt::format(",{:.12g}", sums[4 * i + c] / count);
      text += '\n';
    }
    files.emplace_back("profile_" + line.name + ".csv", std::move(text));
  }
  return files;
}

std::vector<double> Probes::save() const {
  std::vector<double> all;
  for (const Line& line : lines_) {
    all.push_back(line.count);
    all.insert(all.end(), line.sum.begin(), line.sum.end());
  }
  return all;
}

void Probes::restore(const std::vector<double>& saved) {
  std::size_t at = 0;
  for (Line& line : lines_) {
    if (at + 1 + line.sum.size() > saved.size())
      throw InputError("the state does not hold the means of profile '{}'; start anew", line.name);
    line.count = saved[at];
    std::copy_n(saved.begin() + static_cast<long>(at) + 1, line.sum.size(), line.sum.begin());
    at += 1 + line.sum.size();
  }
}

}  // namespace valsalva::flow_scene
