#include "measures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "contact/distance.hpp"
#include "contact/intersections.hpp"
#include "core/units.hpp"

namespace valsalva::deploy {
namespace {

struct Section {
  double perimeter = 0, narrowest = 0, widest = 0;
};

/// The frame's outline where its struts cross a height, by the convex hull of the crossings.
Section section_at(const Points& x, const std::vector<Edge>& struts, double height, double outwards) {
  std::vector<Eigen::Vector2d> points;
  for (const Edge& e : struts) {
    const double a = x[e[0]].z() - height, b = x[e[1]].z() - height;
    if ((a < 0) == (b < 0)) continue;
    const Vec3 p = x[e[0]] + a / (a - b) * (x[e[1]] - x[e[0]]);
    points.emplace_back(p.x(), p.y());
  }
  if (points.size() < 3) return {};
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::vector<Eigen::Vector2d> hull;  // Andrew's monotone chain
  const auto cross = [](const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (a - o).x() * (b - o).y() - (a - o).y() * (b - o).x();
  };
  for (int side = 0; side < 2; ++side) {
    const std::size_t start = hull.size();
    for (const auto& p : points) {
      while (hull.size() >= start + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  Section s;
  for (std::size_t i = 0; i < hull.size(); ++i) s.perimeter += (hull[(i + 1) % hull.size()] - hull[i]).norm();
  s.perimeter += 2 * M_PI * outwards;
  s.narrowest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 90; ++k) {
    const Eigen::Vector2d u(std::cos(M_PI * k / 90), std::sin(M_PI * k / 90));
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const auto& p : hull) {
      low = std::min(low, p.dot(u));
      high = std::max(high, p.dot(u));
    }
    s.narrowest = std::min(s.narrowest, high - low + 2 * outwards);
    s.widest = std::max(s.widest, high - low + 2 * outwards);
  }
  return s;
}

double distance_to(const Vec3& p, const Points& x, const std::vector<Triangle>& triangles,
                   const std::map<std::array<int, 3>, std::vector<int>>& cells, double cell) {
  double nearest = std::numeric_limits<double>::infinity();
  const std::array<int, 3> at = {static_cast<int>(std::floor(p.x() / cell)),
                                 static_cast<int>(std::floor(p.y() / cell)),
                                 static_cast<int>(std::floor(p.z() / cell))};
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k) {
        const auto it = cells.find({at[0] + i, at[1] + j, at[2] + k});
        if (it == cells.end()) continue;
        for (int e : it->second) {
          const Triangle& t = triangles[e];
          nearest = std::min(nearest, contact::point_triangle(p, x[t[0]], x[t[1]], x[t[2]]).distance);
        }
      }
  return nearest;
}

double gap_area(const Simulation& s, const Inputs& in, const Parameters& p, double strut_depth) {
  const ShellBody* skirt = find(in.tissue, "skirt");
  if (!skirt) return 0;
  const double cell = 2;
  Points native;
  std::map<std::array<int, 3>, std::vector<int>> cells;
  if (in.native) {
    native = s.points(in.native->name);
    const auto& triangles = in.native->shell->mesh().triangles;
    for (std::size_t e = 0; e < triangles.size(); ++e) {
      const Vec3 c = (native[triangles[e][0]] + native[triangles[e][1]] + native[triangles[e][2]]) / 3;
      cells[{static_cast<int>(std::floor(c.x() / cell)), static_cast<int>(std::floor(c.y() / cell)),
             static_cast<int>(std::floor(c.z() / cell))}]
          .push_back(static_cast<int>(e));
    }
  }
  const Points x = s.points("skirt");
  double area = 0;
  for (const Triangle& t : skirt->shell->mesh().triangles) {
    const Vec3 centre = (x[t[0]] + x[t[1]] + x[t[2]]) / 3;
    // The struts lie between the skirt and what it seals against.
    const double between = 0.5 * skirt->shell->mesh().thickness_mm[t[0]] + strut_depth;
    double distance = -in.wall.value(centre) - between;
    if (in.native && distance > p.apposition_gap)
      distance =
          std::min(distance, distance_to(centre, native, in.native->shell->mesh().triangles, cells, cell) -
                                 between - 0.5 * in.native->shell->mesh().thickness_mm[0]);
    if (distance > p.apposition_gap) area += 0.5 * (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]).norm();
  }
  return area;
}

}  // namespace

double depth_now(const Simulation& s, const Inputs& in) {
  const ShellBody* skirt = find(in.tissue, "skirt");
  const std::vector<int> nodes = skirt ? skirt_edge_nodes(*skirt) : inflow_nodes(in.frame);
  const int offset = s.system().body(skirt ? "skirt" : "frame").offset;
  double sum = 0;
  for (int a : nodes) sum += s.system().state.x[offset + a].z();
  return -sum / static_cast<double>(nodes.size());
}

double inflow_diameter_now(const Simulation& s, const Inputs& in) {
  const int offset = s.system().body("frame").offset;
  const std::vector<int> nodes = inflow_nodes(in.frame);
  Vec3 centre = Vec3::Zero();
  for (int a : nodes) centre += s.system().state.x[offset + a] / static_cast<double>(nodes.size());
  double sum = 0;
  for (int a : nodes) {
    const Vec3 d = s.system().state.x[offset + a] - centre;
    sum += std::hypot(d.x(), d.y());
  }
  return 2 * sum / static_cast<double>(nodes.size());
}

Measures measure(const Simulation& s, const Inputs& in, const Parameters& p) {
  Measures m;
  const structure::Configuration& now = s.system().state;
  const structure::Body& frame = s.system().body("frame");
  const Points x = s.points("frame");
  const structure::BeamMesh& beams = in.frame.network->mesh();
  m.implant_depth_mm = depth_now(s, in);
  const double strut = 0.5 * *std::max_element(beams.depth_mm.begin(), beams.depth_mm.end());
  const Section annulus = section_at(x, beams.elements, 0, strut);
  m.expanded_diameter_annulus_mm = annulus.perimeter / M_PI;
  m.eccentricity = annulus.widest > 0 ? 1 - annulus.narrowest / annulus.widest : 0;
  m.max_penetration_mm = s.wall_penetration_mm();
  m.apposition_gap_area_mm2 = gap_area(s, in, p, 2 * strut);

  Points on_device = s.native_on_device();  // becomes the sum with the wall's forces
  std::vector<double> normal(s.system().nodes(), 0.0);
  for (std::size_t a = 0; a < normal.size(); ++a) normal[a] = on_device[a].norm();
  for (const contact::WallContact* wall : {s.frame_wall(), s.tissue_wall()})
    for (const auto& f : wall->node_forces(now)) {
      on_device[f.node] += f.normal_uN + f.friction_uN;
      normal[f.node] += f.normal_uN.norm();
    }
  std::map<int, double> bands;
  constexpr double band_mm = 2;
  for (const char* name : {"frame", "leaflets", "skirt"}) {
    if (!s.has(name)) continue;
    const structure::Body& body = s.system().body(name);
    for (int a = body.begin(); a < body.end(); ++a) {
      Vec3 outward(now.x[a].x(), now.x[a].y(), 0);
      if (outward.norm() < 1e-9) continue;
      const double radial = -on_device[a].dot(outward.normalized());
      m.chronic_outward_force_N += radial / units::uN_per_N;
      bands[static_cast<int>(std::floor(now.x[a].z() / band_mm))] += radial;
    }
  }
  for (const auto& [band, force] : bands)
    m.max_wall_stress_kPa =
        std::max(m.max_wall_stress_kPa, force / (2 * M_PI * band_mm * p.wall_thickness) / units::pa_per_kPa);
  for (int e = 0; e < in.frame.network->elements(); ++e) {
    const double length = (x[beams.elements[e][1]] - x[beams.elements[e][0]]).norm();
    for (int a : beams.elements[e])
      if (normal[frame.offset + a] > 0) m.contact_area_mm2 += 0.5 * length * beams.width_mm[e];
    m.max_frame_strain =
        std::max(m.max_frame_strain,
                 in.frame.network->element_state(now.x, now.rotation, e, frame.offset, frame.rotation_offset)
                     .max_strain);
  }
  for (const ShellBody& tissue : in.tissue) {
    const structure::Body& body = s.system().body(tissue.name);
    const std::vector<double> area = tissue.shell->lumped_area();
    for (int a = 0; tissue.name == "skirt" && a < body.count; ++a)
      if (normal[body.offset + a] > 0) m.contact_area_mm2 += area[a];
    for (int e = 0; e < tissue.shell->elements(); ++e)
      m.max_leaflet_stretch =
          std::max(m.max_leaflet_stretch, tissue.shell->element_state(now.x, e, body.offset).stretch_major);
    m.max_exponent = std::max(m.max_exponent, tissue.shell->max_exponent(now.x, body.offset));
  }
  m.strut_crossings = static_cast<long>(contact::crossings(s.contact().candidates().mesh(), now.x).size());
  m.frame_force_uN.assign(on_device.begin() + frame.begin(), on_device.begin() + frame.end());
  for (int a = frame.begin(); a < frame.end(); ++a) m.friction_capacity_uN.push_back(p.friction * normal[a]);
  return m;
}

}  // namespace valsalva::deploy
