// A three-lobed aortic root with known radii, as level set, as closed surface and as segment's state.
#pragma once

#include <cmath>
#include <numbers>

#include "bodies/level_set.hpp"
#include "geometry/grid_sdf.hpp"
#include "simple_surfaces.hpp"
#include "state/state.hpp"

namespace valsalva::test {

struct SyntheticRoot {
  double annulus_radius_mm = 12, junction_radius_mm = 13, sinus_depth_mm = 4;
  double junction_z_mm = 20, lower_z_mm = -10, upper_z_mm = 32;
  std::array<double, 3> commissures{0.4, 0.4 + 2 * std::numbers::pi / 3, 0.4 + 4 * std::numbers::pi / 3};

  double wall_radius(double angle, double z) const {
    const double rise = std::clamp(z / junction_z_mm, 0.0, 1.0);
    const double base =
        annulus_radius_mm + (junction_radius_mm - annulus_radius_mm) * rise * rise * (3 - 2 * rise);
    const double swell = std::pow(std::sin(std::numbers::pi * rise), 2);
    const double lobe = 0.5 * (1 - std::cos(3 * (angle - commissures[0])));
    return base + sinus_depth_mm * swell * (0.25 + 0.75 * lobe);
  }
  /// Distance along the radius, close to the true one as the wall is steep.
  geometry::GridSdf level_set(double spacing = 0.5) const {
    return geometry::sample(
        Vec3(-22, -22, lower_z_mm - 3), Vec3(22, 22, upper_z_mm + 3), spacing,
        [&](const Vec3& x) { return x.head<2>().norm() - wall_radius(std::atan2(x.y(), x.x()), x.z()); });
  }
  /// Closed by a fan at either end.
  geometry::TriMesh surface() const {
    const int around = 180, rows = 80;
    geometry::TriMesh mesh = grid_surface(around, rows, false, [&](double u, double v) {
      const double a = 2 * std::numbers::pi * u, z = lower_z_mm + v * (upper_z_mm - lower_z_mm);
      const double r = wall_radius(a, z);
      return Vec3(r * std::cos(a), r * std::sin(a), z);
    });
    const int low = int(mesh.points.size()), high = low + 1, top = around * rows;
    mesh.points.push_back({0, 0, lower_z_mm});
    mesh.points.push_back({0, 0, upper_z_mm});
    for (int i = 0; i < around; ++i) {
      const int next = (i + 1) % around;
      mesh.triangles.push_back({low, next, i});
      mesh.triangles.push_back({high, top + i, top + next});
    }
    return mesh;
  }
  state::State state() const {
    state::State out;
    out.stage = "segment";
    out.case_name = "synthetic";
    out.version = "test";
    out.final = true;
    const auto mesh = surface();
    out.meshes["lumen"] = state::Mesh::of_triangles(mesh.points, mesh.triangles);
    bodies::put_level_set(out, "lumen", level_set());
    out.restart["anatomy/commissure_angles_rad"] =
        state::Array::of(std::vector<double>(commissures.begin(), commissures.end()));
    out.restart["anatomy/z_mm"] = state::Array::of(
        std::vector<double>{lower_z_mm, -5, 0, junction_z_mm / 2, junction_z_mm, upper_z_mm});
    out.restart["anatomy/annulus_diameter_mm"] = state::Array::scalar(2 * annulus_radius_mm);
    return out;
  }
};

}  // namespace valsalva::test
