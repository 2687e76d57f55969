#include "measures.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "contact/intersections.hpp"

namespace valsalva::crimp {
namespace {

/// Point of the segment at height z, if it reaches across.
std::optional<Vec3> cut(const Vec3& a, const Vec3& b, double z) {
  if ((a[2] < z) == (b[2] < z)) return std::nullopt;
  return Vec3(a + (z - a[2]) / (b[2] - a[2]) * (b - a));
}

double strut_section(const Simulation& s, double z) {
  const auto& mesh = s.device().frame->mesh();
  const auto& x = s.system().state.x;
  const int offset = s.system().body("frame").offset;
  double area = 0;
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    const Vec3 &a = x[offset + mesh.elements[e][0]], &b = x[offset + mesh.elements[e][1]];
    if (!cut(a, b, z)) continue;
    const double slope = std::abs(b[2] - a[2]) / (b - a).norm();
    area += mesh.width_mm[e] * mesh.depth_mm[e] / std::max(slope, 0.1);
  }
  return area;
}

/// Area of the tissue's cut at full thickness: length of the cut times thickness over the slope of the sheet.
double tissue_section(const Simulation& s, double z) {
  const auto& x = s.system().state.x;
  double area = 0;
  for (const auto& body : s.device().tissue) {
    const int offset = s.system().body(body.name).offset;
    const auto& triangles = body.shell->mesh().triangles;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const Vec3 &a = x[offset + triangles[t][0]], &b = x[offset + triangles[t][1]],
                 &c = x[offset + triangles[t][2]];
      std::array<std::optional<Vec3>, 3> ends{cut(a, b, z), cut(b, c, z), cut(c, a, z)};
      std::vector<Vec3> points;
      for (const auto& end : ends)
        if (end) points.push_back(*end);
      if (points.size() != 2) continue;
      const Vec3 normal = (b - a).cross(c - a).normalized();
      const double flat = std::hypot(normal[0], normal[1]);
      area +=
          (points[1] - points[0]).norm() * body.shell->thickness(static_cast<int>(t)) / std::max(flat, 0.1);
    }
  }
  return area;
}

}  // namespace

double outer_diameter_mm(const Simulation& s, double thickness_fraction) {
  double radius = 0;
  for (const auto& nodes :
       {frame_surface(s.device(), s.system()), tissue_surface(s.device(), s.system(), thickness_fraction)})
    for (const auto& n : nodes) {
      const Vec3& x = s.system().state.x[n.node];
      radius = std::max(radius, std::hypot(x[0], x[1]) + n.radius_mm);
    }
  return 2 * radius;
}

double max_strut_strain(const Simulation& s) {
  const auto& now = s.system().state;
  const auto& body = s.system().body("frame");
  double most = 0;
  for (int e = 0; e < s.device().frame->elements(); ++e)
    most = std::max(most, s.device()
                              .frame->element_state(now.x, now.rotation, e, body.offset, body.rotation_offset)
                              .max_strain);
  return most;
}

TissueStretch tissue_stretch(const Simulation& s, const std::string& name) {
  TissueStretch result;
  for (const auto& body : s.device().tissue) {
    if (body.name != name) continue;
    for (int e = 0; e < body.shell->elements(); ++e) {
      const auto state = body.shell->element_state(s.system().state.x, e, s.system().body(name).offset);
      const double area = state.stretch_major * state.stretch_minor;
      result.largest = std::max(result.largest, state.stretch_major);
      result.smallest_area = std::min(result.smallest_area, area);
      if (!(area > 0.01)) ++result.inverted;
    }
  }
  return result;
}

AreaBudget area_budget(const Simulation& s, double thickness_fraction, double spacing_mm) {
  double low = 1e9, high = -1e9;
  for (const Vec3& x : s.system().state.x) {
    low = std::min(low, x[2]);
    high = std::max(high, x[2]);
  }
  AreaBudget most;
  for (double z = low + 0.5 * spacing_mm; z < high; z += spacing_mm) {
    const double struts = strut_section(s, z), tissue = tissue_section(s, z);
    if (struts + tissue <= most.struts_mm2 + most.tissue_full_mm2) continue;
    most = {z, 0, struts, tissue, thickness_fraction * tissue};
  }
  most.inside_mm2 = std::numbers::pi * std::pow(s.crimper_radius_mm(), 2);
  return most;
}

long crossings(const Simulation& s) {
  return static_cast<long>(
      contact::crossings(s.body_contact().candidates().mesh(), s.system().state.x).size());
}

double penetration_mm(const Simulation& s) {
  const auto& bodies = s.body_contact().candidates().mesh().bodies();
  double most = 0;
  for (std::size_t a = 0; a < bodies.size(); ++a)
    for (std::size_t b = a; b < bodies.size(); ++b)
      most =
          std::max(most, s.body_contact().penetration_mm(s.system().state.x, bodies[a].name, bodies[b].name));
  return most;
}

double strut_penetration_mm(const Simulation& s) {
  double most = 0;
  for (const auto& body : s.device().tissue)
    most = std::max(most, s.body_contact().penetration_mm(s.system().state.x, "frame", body.name));
  return most;
}

}  // namespace valsalva::crimp
