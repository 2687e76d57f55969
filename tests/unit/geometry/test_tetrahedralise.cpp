#include "geometry/tetrahedralise.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "expect_error.hpp"
#include "geometry/quality.hpp"
#include "geometry/remesh.hpp"
#include "geometry/surface.hpp"
#include "simple_surfaces.hpp"

namespace valsalva::geometry {
namespace {

constexpr double pi = std::numbers::pi;

GridSdf tube_field(double radius, double height) {
  return sample(Vec3(-radius - 4, -radius - 4, -3), Vec3(radius + 4, radius + 4, height + 3), 0.5,
                [&](const Vec3& x) { return x.head<2>().norm() - radius; });
}

TEST(Tetrahedralise, TubeWallHasItsVolumeAndShape) {
  const double r = 12, height = 20, thickness = 1;
  const TriMesh lumen = remesh(test::cylinder(r, height, 300, 60), {1.0});
  const WallMesh grown = tetrahedral_wall(lumen, tube_field(r, height), {thickness, 2});
  const TetMesh& wall = grown.mesh;
  EXPECT_EQ(grown.thinned_nodes, 0);
  const TetQuality quality = quality_of(wall);
  const double volume = pi * ((r + thickness) * (r + thickness) - r * r) * height;
  EXPECT_EQ(wall.tetrahedra.size(), 6 * lumen.triangles.size());
  EXPECT_NEAR(quality.volume_mm3 / volume, 1, 1e-2);
  EXPECT_GT(quality.min_dihedral_deg, 12);
  EXPECT_GT(quality.min_scaled_jacobian, 0.15);
}

TEST(Tetrahedralise, NeighboursShareWholeFaces) {
  const TriMesh lumen = remesh(test::cylinder(5, 6, 120, 20), {1.2});
  const TetMesh wall = tetrahedral_wall(lumen, tube_field(5, 6), {0.8, 3}).mesh;
  std::map<std::array<int, 3>, int> faces;
  for (const auto& t : wall.tetrahedra)
    for (int skipped = 0; skipped < 4; ++skipped) {
      std::array<int, 3> face{};
      for (int k = 0, n = 0; k < 4; ++k)
        if (k != skipped) face[n++] = t[k];
      std::sort(face.begin(), face.end());
      ++faces[face];
    }
  // Every face twice but those of the skin, which has four surfaces: inside, outside, two rims.
  std::size_t skin = 0, rim = 0;
  for (const auto& loop : border_loops(lumen)) rim += loop.size();
  for (const auto& [face, uses] : faces) {
    ASSERT_LE(uses, 2);
    skin += uses == 1;
  }
  EXPECT_EQ(skin, 2 * lumen.triangles.size() + 2 * 3 * rim);
}

TEST(Tetrahedralise, WallIsThinnedInAFoldSharperThanItself) {
  // A tube with a waist whose outer groove is sharper than the wall of 2 mm is thick.
  const auto radius = [](double z) { return 7 - 3.5 * std::exp(-(z - 5) * (z - 5) / 0.8); };
  const TriMesh tube = test::grid_surface(160, 100, false, [&](double u, double v) {
    const double a = 2 * pi * u, z = 10 * v;
    return Vec3(radius(z) * std::cos(a), radius(z) * std::sin(a), z);
  });
  // True distance to the profile; it depends on radius and height only.
  const GridSdf field = sample(Vec3(-10, -10, -2), Vec3(10, 10, 12), 0.4, [&](const Vec3& x) {
    const double r = x.head<2>().norm();
    double least = 1e9;
    for (double z = -3; z < 13; z += 0.1) least = std::min(least, std::hypot(r - radius(z), x.z() - z));
    return r < radius(x.z()) ? -least : least;
  });
  const WallMesh wall = tetrahedral_wall(remesh(tube, {0.7}), field, {2.0, 1});
  EXPECT_GT(wall.thinned_nodes, 0);
  EXPECT_GT(quality_of(wall.mesh).min_scaled_jacobian, 0);
}

TEST(Tetrahedralise, LevelSetVolumeOfASphereZone) {
  const double r = 7;
  const GridSdf field =
      sample(Vec3(-9, -9, -9), Vec3(9, 9, 9), 0.5, [&](const Vec3& x) { return x.norm() - r; });
  const auto zone = [](double radius, double low, double high) {
    const auto primitive = [&](double z) { return pi * (radius * radius * z - z * z * z / 3); };
    return primitive(high) - primitive(low);
  };
  EXPECT_NEAR(level_set_volume(field, -1e9, 0, -2.3, 4.1) / zone(r, -2.3, 4.1), 1, 3e-3);
  EXPECT_NEAR(level_set_volume(field, 0, 1, -2.3, 4.1) / (zone(r + 1, -2.3, 4.1) - zone(r, -2.3, 4.1)), 1,
              5e-3);
}

}  // namespace
}  // namespace valsalva::geometry
