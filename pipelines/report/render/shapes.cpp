#include "render/shapes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace valsalva::report {

Surface clip(const Surface& surface, const std::function<bool(const Vec3&)>& keep) {
  std::vector<char> kept(surface.points.size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = keep(surface.points[i]);
  Surface result = surface;
  result.triangles.clear();
  for (const Triangle& t : surface.triangles)
    if (kept[t[0]] && kept[t[1]] && kept[t[2]]) result.triangles.push_back(t);
  return result;
}

Surface tubes(const Points& points, const std::vector<Edge>& edges, const std::vector<double>& radius,
              int sides) {
  Surface surface;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const Vec3 axis = points[edges[e][1]] - points[edges[e][0]];
    const double length = axis.norm();
    if (length == 0) continue;
    const Vec3 along = axis / length;
    const Vec3 u = along.unitOrthogonal(), v = along.cross(u);
    const int first = static_cast<int>(surface.points.size());
    for (int end = 0; end < 2; ++end) {
      const Vec3 centre = points[edges[e][end]] + (end ? 0.5 : -0.5) * radius[e] * along;
      for (int s = 0; s < sides; ++s) {
        const double angle = 2 * std::numbers::pi * s / sides;
        surface.points.push_back(centre + radius[e] * (std::cos(angle) * u + std::sin(angle) * v));
      }
    }
    for (int s = 0; s < sides; ++s) {
      const int a = first + s, b = first + (s + 1) % sides;
      surface.triangles.push_back({a, b, b + sides});
      surface.triangles.push_back({a, b + sides, a + sides});
    }
  }
  return surface;
}

Surface boundary(const Points& points, const std::vector<Tetrahedron>& tetrahedra,
                 const std::function<bool(const Vec3&)>& keep) {
  static constexpr int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  std::map<Triangle, std::pair<Triangle, int>> seen;
  for (const Tetrahedron& tet : tetrahedra) {
    const Vec3 centroid = (points[tet[0]] + points[tet[1]] + points[tet[2]] + points[tet[3]]) / 4;
    if (!keep(centroid)) continue;
    for (const auto& face : faces) {
      const Triangle t{tet[face[0]], tet[face[1]], tet[face[2]]};
      Triangle key = t;
      std::sort(key.begin(), key.end());
      auto& entry = seen.try_emplace(key, t, 0).first->second;
      ++entry.second;
    }
  }
  Surface surface;
  std::vector<int> renumbered(points.size(), -1);
  for (const auto& [key, entry] : seen) {
    if (entry.second != 1) continue;
    Triangle t = entry.first;
    for (int& node : t) {
      if (renumbered[node] < 0) {
        renumbered[node] = static_cast<int>(surface.points.size());
        surface.points.push_back(points[node]);
      }
      node = renumbered[node];
    }
    surface.triangles.push_back(t);
  }
  return surface;
}

namespace {

Surface clustered(const Surface& surface, const Vec3& origin, double cell) {
  Surface result = surface;
  result.points.clear();
  result.triangles.clear();
  std::map<std::array<long, 3>, int> cells;
  std::vector<int> node(surface.points.size()), count;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Vec3 g = (surface.points[i] - origin) / cell;
    const std::array<long, 3> key{std::lround(g.x()), std::lround(g.y()), std::lround(g.z())};
    node[i] = cells.try_emplace(key, static_cast<int>(result.points.size())).first->second;
    if (node[i] == static_cast<int>(result.points.size())) {
      result.points.push_back(Vec3::Zero());
      count.push_back(0);
    }
    result.points[node[i]] += surface.points[i];
    ++count[node[i]];
  }
  for (std::size_t i = 0; i < count.size(); ++i) result.points[i] /= count[i];
  for (const Triangle& t : surface.triangles) {
    const Triangle merged{node[t[0]], node[t[1]], node[t[2]]};
    if (merged[0] != merged[1] && merged[1] != merged[2] && merged[2] != merged[0])
      result.triangles.push_back(merged);
  }
  return result;
}

}  // namespace

Surface simplified(const Surface& surface, std::size_t triangles) {
  if (surface.triangles.size() <= triangles) return surface;
  Box box;
  box.add(surface.points);
  Surface result = surface;
  for (double cell = (box.high - box.low).norm() / 500; result.triangles.size() > triangles; cell *= 1.3)
    result = clustered(surface, box.low, cell);
  return result;
}

std::vector<std::array<Vec3, 2>> cross_section(const Points& points, const std::vector<Triangle>& triangles,
                                               const Vec3& origin, const Vec3& normal) {
  std::vector<std::array<Vec3, 2>> segments;
  for (const Triangle& t : triangles) {
    std::vector<Vec3> hits;
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = points[t[k]], &b = points[t[(k + 1) % 3]];
      const double da = (a - origin).dot(normal), db = (b - origin).dot(normal);
      if ((da < 0) != (db < 0)) hits.push_back(a + (b - a) * (da / (da - db)));
    }
    if (hits.size() == 2) segments.push_back({hits[0], hits[1]});
  }
  return segments;
}

Surface strokes(const std::vector<std::array<Vec3, 2>>& segments, double radius) {
  Points points;
  std::vector<Edge> edges;
  for (const auto& segment : segments) {
    edges.push_back({static_cast<int>(points.size()), static_cast<int>(points.size()) + 1});
    points.insert(points.end(), segment.begin(), segment.end());
  }
  return tubes(points, edges, std::vector<double>(edges.size(), radius), 6);
}

void Box::add(const Points& points) {
  for (const Vec3& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
}

}  // namespace valsalva::report
