// Surfaces with known area and volume.
#pragma once

#include <cmath>
#include <map>
#include <numbers>

#include "geometry/mesh.hpp"

namespace valsalva::test {

using geometry::TriMesh;

/// Regular octahedron, refined and pushed to the sphere.
inline TriMesh sphere(double radius, int refinements) {
  TriMesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
               {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  for (int level = 0; level < refinements; ++level) {
    std::map<Edge, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [found, fresh] =
          middles.try_emplace({std::min(a, b), std::max(a, b)}, int(mesh.points.size()));
      if (fresh) mesh.points.push_back((mesh.points[a] + mesh.points[b]).normalized());
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  for (Vec3& p : mesh.points) p *= radius;
  return mesh;
}

/// A grid of `around` columns and `rows` rows of quadrilaterals, closed in both directions or open in the
/// second.
template <class Position>
TriMesh grid_surface(int around, int rows, bool closed, Position&& position) {
  TriMesh mesh;
  for (int j = 0; j < rows + !closed; ++j)
    for (int i = 0; i < around; ++i) mesh.points.push_back(position(double(i) / around, double(j) / rows));
  const int levels = rows + !closed;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < around; ++i) {
      const int next = (i + 1) % around, up = (j + 1) % levels;
      const int a = j * around + i, b = j * around + next, c = up * around + next, d = up * around + i;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

inline TriMesh torus(double ring, double tube, int around, int rows) {
  return grid_surface(around, rows, true, [&](double u, double v) {
    const double a = 2 * std::numbers::pi * u, b = 2 * std::numbers::pi * v;
    return Vec3((ring + tube * std::cos(b)) * std::cos(a), (ring + tube * std::cos(b)) * std::sin(a),
                tube * std::sin(b));
  });
}

/// Open at both ends, from z = 0 to `height`.
inline TriMesh cylinder(double radius, double height, int around, int rows) {
  return grid_surface(around, rows, false, [&](double u, double v) {
    const double a = 2 * std::numbers::pi * u;
    return Vec3(radius * std::cos(a), radius * std::sin(a), height * v);
  });
}

}  // namespace valsalva::test
