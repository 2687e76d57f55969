// A small device for tests: a short cylinder frame of diamond cells with a skirt sewn inside it.
#pragma once

#include <cmath>
#include <numbers>

#include "state/state.hpp"

namespace valsalva::crimp::test {

inline constexpr int cells = 6, rows = 3, around = 24, up = 4;
inline constexpr double radius = 5, row_height = 4, skirt_radius = 4.5, skirt_height = 4;

inline state::Mesh small_frame() {
  Points points;
  std::vector<Edge> edges;
  for (int i = 0; i < rows; ++i)
    for (int k = 0; k < cells; ++k) {
      const double angle = (2 * k + i % 2) * std::numbers::pi / cells;
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), row_height * i);
    }
  const auto strut = [&](int a, int b) {
    const Vec3 middle = 0.5 * (points[a] + points[b]);
    const double r = std::hypot(middle[0], middle[1]);
    points.emplace_back(middle[0] * radius / r, middle[1] * radius / r, middle[2]);
    const int m = static_cast<int>(points.size()) - 1;
    edges.push_back({a, m});
    edges.push_back({m, b});
  };
  for (int i = 0; i + 1 < rows; ++i)
    for (int k = 0; k < cells; ++k) {
      const int a = i * cells + k, side = i % 2 ? (k + 1) % cells : (k + cells - 1) % cells;
      strut(a, (i + 1) * cells + k);
      strut(a, (i + 1) * cells + side);
    }
  auto mesh = state::Mesh::of_lines(points, edges);
  mesh.point_data["reference"] = state::Array::of(points);
  mesh.cell_data["width_mm"] = state::Array::of(std::vector<double>(edges.size(), 0.25));
  mesh.cell_data["depth_mm"] = state::Array::of(std::vector<double>(edges.size(), 0.4));
  return mesh;
}

/// Node (i, k) stands at row i, angle 2 pi k / around.
inline state::Mesh small_skirt() {
  Points points, meridian, hoop;
  std::vector<Triangle> triangles;
  for (int i = 0; i <= up; ++i)
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      points.emplace_back(skirt_radius * std::cos(angle), skirt_radius * std::sin(angle),
                          skirt_height * i / up);
    }
  for (int i = 0; i < up; ++i)
    for (int k = 0; k < around; ++k) {
      const int a = i * around + k, b = i * around + (k + 1) % around, c = a + around, d = b + around;
      triangles.push_back({a, b, d});
      triangles.push_back({a, d, c});
    }
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    meridian.push_back(Vec3::UnitZ());
    hoop.push_back((points[triangles[t][1]] - points[triangles[t][0]]).normalized());
  }
  auto mesh = state::Mesh::of_triangles(points, triangles);
  mesh.point_data["reference"] = state::Array::of(points);
  mesh.point_data["thickness_mm"] = state::Array::of(std::vector<double>(points.size(), 0.34));
  mesh.point_data["attached"] = state::Array::of(std::vector<std::int64_t>(points.size(), 0));
  mesh.cell_data["leaflet"] = state::Array::of(std::vector<std::int64_t>(triangles.size(), 3));
  mesh.cell_data["fibre1"] = state::Array::of(meridian);
  mesh.cell_data["fibre2"] = state::Array::of(meridian);
  return mesh;
}

inline state::State small_device(bool tissue) {
  state::State s;
  s.stage = "stent";
  s.case_name = "small";
  s.final = true;
  s.meshes["frame"] = small_frame();
  s.restart["device/inflow_z_mm"] = state::Array::scalar(0);
  if (!tissue) return s;
  s.meshes["skirt"] = small_skirt();
  std::vector<std::int64_t> ties;
  for (int k = 0; k < cells; ++k) {  // the lowest crossings, and the next row half a cell on
    ties.insert(ties.end(), {k * around / cells, k});
    ties.insert(ties.end(), {up * around + k * around / cells + around / cells / 2, cells + k});
  }
  s.restart["ties/skirt"] = state::Array::of(ties);
  s.restart["ties/skirt"].shape = {ties.size() / 2, 2};
  return s;
}

}  // namespace valsalva::crimp::test
