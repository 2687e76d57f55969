// A straight tube with three flaps that bend inwards: the smallest anatomy that deploy can work on.
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "bodies/level_set.hpp"
#include "geometry/grid_sdf.hpp"
#include "state/state.hpp"

namespace valsalva::test {

inline state::Mesh flaps(double radius) {
  Points points;
  std::vector<Triangle> triangles;
  std::vector<std::int64_t> attached, leaflet;
  Points fibre1, fibre2;
  const int around = 10, along = 6;
  for (int part = 0; part < 3; ++part) {
    const int first = static_cast<int>(points.size());
    for (int j = 0; j <= along; ++j)
      for (int i = 0; i <= around; ++i) {
        const double angle = 2 * M_PI / 3 * part + 1.9 * (static_cast<double>(i) / around - 0.5);
        const double r = radius - 0.05 - 0.35 * j, z = -2 + 0.9 * j;
        points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
        attached.push_back(j == 0 ? 1 : 0);
      }
    for (int j = 0; j < along; ++j)
      for (int i = 0; i < around; ++i) {
        const int a = first + j * (around + 1) + i, b = a + 1, c = a + around + 1, d = c + 1;
        for (const Triangle& t : {Triangle{a, b, c}, Triangle{b, d, c}}) {
          triangles.push_back(t);
          leaflet.push_back(part);
          const Vec3 u = (points[t[1]] - points[t[0]]).normalized();
          const Vec3 n = u.cross(points[t[2]] - points[t[0]]).normalized();
          fibre1.push_back(u);
          fibre2.push_back(n.cross(u));
        }
      }
  }
  state::Mesh mesh = state::Mesh::of_triangles(points, triangles);
  mesh.point_data["reference"] = state::Array::of(points);
  mesh.point_data["thickness_mm"] = state::Array::of(std::vector<double>(points.size(), 0.4));
  mesh.point_data["attached"] = state::Array::of(attached);
  mesh.cell_data["leaflet"] = state::Array::of(leaflet);
  mesh.cell_data["fibre1"] = state::Array::of(fibre1);
  mesh.cell_data["fibre2"] = state::Array::of(fibre2);
  return mesh;
}

/// As mesher hands it on.
inline state::State tube(double radius, bool with_flaps) {
  state::State s;
  s.stage = "mesher";
  s.case_name = "tube";
  s.version = "test";
  s.parameters_sha256 = "none";
  s.final = true;
  const double extent = radius + 3;
  const geometry::GridSdf wall =
      geometry::sample({-extent, -extent, -25}, {extent, extent, 60}, 0.5,
                       [&](const Vec3& x) { return std::hypot(x.x(), x.y()) - radius; });
  bodies::put_level_set(s, "lumen", wall);
  s.restart["anatomy/annulus_diameter_mm"] = state::Array::scalar(2 * radius);
  Points ring;
  for (int i = 0; i < 12; ++i)
    ring.emplace_back(radius * std::cos(M_PI / 6 * i), radius * std::sin(M_PI / 6 * i), 0);
  s.meshes["lumen"] = state::Mesh::of_triangles(ring, {{0, 4, 8}, {1, 5, 9}});
  if (with_flaps) s.meshes["native_leaflets"] = flaps(radius);
  return s;
}

}  // namespace valsalva::test
