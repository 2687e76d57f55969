#include "plane_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/errors.hpp"
#include "geometry/gmsh_session.hpp"

namespace valsalva::stent {

namespace {

constexpr double smallest_acceptable_deg = 10;

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// gmsh's node tags to our numbers: the geometric points first, in their order.
std::map<std::size_t, int> collect_nodes(int given, PlaneMesh& mesh) {
  std::map<std::size_t, int> number;
  std::vector<std::size_t> tags;
  std::vector<double> at, parameters;
  for (int p = 1; p <= given; ++p) {
    gmsh::model::mesh::getNodes(tags, at, parameters, 0, p);
    if (tags.size() != 1) throw NumericalFailure("gmsh lost point {} of a tissue pattern", p);
    number[tags[0]] = static_cast<int>(mesh.points.size());
    mesh.points.emplace_back(at[0], at[1]);
  }
  gmsh::model::mesh::getNodes(tags, at, parameters, 1, -1);
  if (!tags.empty())
    throw NumericalFailure("gmsh added {} nodes on the edge of a tissue pattern", tags.size());
  gmsh::model::mesh::getNodes(tags, at, parameters, 2, 1);
  for (std::size_t i = 0; i < tags.size(); ++i) {
    number[tags[i]] = static_cast<int>(mesh.points.size());
    mesh.points.emplace_back(at[3 * i], at[3 * i + 1]);
  }
  return number;
}

}  // namespace

double smallest_angle_deg(const std::vector<Vec2>& points, const std::vector<Triangle>& triangles) {
  double smallest = 180;
  for (const Triangle& t : triangles)
    for (int c = 0; c < 3; ++c) {
      const Vec2 a = points[t[(c + 1) % 3]] - points[t[c]], b = points[t[(c + 2) % 3]] - points[t[c]];
      smallest = std::min(smallest, std::atan2(cross(a, b), a.dot(b)) * 180 / std::numbers::pi);
    }
  return smallest;
}

PlaneMesh mesh_polygon(const std::vector<Vec2>& boundary, const std::vector<Vec2>& inner, double edge_mm) {
  PlaneMesh mesh;
  const int n = static_cast<int>(boundary.size()), given = n + static_cast<int>(inner.size());
  try {
    const geometry::GmshSession session;
    gmsh::option::setNumber("Mesh.Algorithm", 6);
    gmsh::option::setNumber("Mesh.MeshSizeMax", edge_mm);
    gmsh::option::setNumber("Mesh.Smoothing", 10);
    gmsh::model::add("pattern");
    std::vector<int> lines, embedded;
    for (const Vec2& p : boundary) gmsh::model::geo::addPoint(p.x(), p.y(), 0, edge_mm);
    for (const Vec2& p : inner) embedded.push_back(gmsh::model::geo::addPoint(p.x(), p.y(), 0, edge_mm));
    for (int i = 0; i < n; ++i) {
      lines.push_back(gmsh::model::geo::addLine(i + 1, (i + 1) % n + 1));
      gmsh::model::geo::mesh::setTransfiniteCurve(lines.back(), 2);
    }
    gmsh::model::geo::addPlaneSurface({gmsh::model::geo::addCurveLoop(lines)}, 1);
    gmsh::model::geo::synchronize();
    if (!embedded.empty()) gmsh::model::mesh::embed(0, embedded, 2, 1);
    gmsh::model::mesh::generate(2);

    const auto number = collect_nodes(given, mesh);
    std::vector<std::size_t> tags, ends;
    gmsh::model::mesh::getElementsByType(2, tags, ends, 1);
    for (std::size_t t = 0; t < tags.size(); ++t) {
      Triangle triangle{number.at(ends[3 * t]), number.at(ends[3 * t + 1]), number.at(ends[3 * t + 2])};
      const Vec2 &a = mesh.points[triangle[0]], &b = mesh.points[triangle[1]], &c = mesh.points[triangle[2]];
      if (cross(b - a, c - a) < 0) std::swap(triangle[1], triangle[2]);
      mesh.triangles.push_back(triangle);
    }
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw NumericalFailure("gmsh could not mesh a tissue pattern ({} boundary points, edge {} mm): {}", n,
                           edge_mm, error.what());
  }
  for (int i = 0; i < given; ++i) {
    const Vec2& wanted = i < n ? boundary[i] : inner[i - n];
    if ((mesh.points[i] - wanted).norm() > 1e-9)
      throw NumericalFailure("gmsh moved point {} of a tissue pattern", i);
    mesh.points[i] = wanted;
  }
  const double angle = smallest_angle_deg(mesh.points, mesh.triangles);
  if (mesh.triangles.empty() || angle < smallest_acceptable_deg)
    throw NumericalFailure(
        "a tissue pattern was meshed into {} triangles with a smallest angle of {:.3g} degrees (at least {} "
        "is "
        "needed); choose another edge length (device.leaflet_edge_mm, device.skirt_edge_mm) than {} mm",
        mesh.triangles.size(), angle, smallest_acceptable_deg, edge_mm);
  return mesh;
}

}  // namespace valsalva::stent
