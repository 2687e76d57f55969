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
  const TetMesh wall = tetrahedral_wall(lumen, tube_field(r, height), {thickness, 2});
  const TetQuality quality = quality_of(wall);
  const double volume = pi * ((r + thickness) * (r + thickness) - r * r) * height;
  EXPECT_EQ(wall.tetrahedra.size(), 6 * lumen.triangles.size());
  EXPECT_NEAR(quality.volume_mm3 / volume, 1, 1e-2);
  EXPECT_GT(quality.min_dihedral_deg, 12);
  EXPECT_GT(quality.min_scaled_jacobian, 0.15);
}

TEST(Tetrahedralise, NeighboursShareWholeFaces) {
  const TriMesh lumen = remesh(test::cylinder(5, 6, 120, 20), {1.2});
  const TetMesh wall = tetrahedral_wall(lumen, tube_field(5, 6), {0.8, 3});
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

TEST(Tetrahedralise, WallThickerThanItsFoldIsRefused) {
  // Lumen of two tubes that meet in a sharp outer groove of the wall's own width, and a level set that has no
  // distance of 3 mm there: the field of the inside of a tube only.
  const TriMesh lumen = remesh(test::cylinder(4, 6, 120, 20), {1.0});
  const GridSdf field = sample(Vec3(-8, -8, -2), Vec3(8, 8, 8), 0.5, [](const Vec3& x) {
    return std::min(x.head<2>().norm() - 4, 5.0 - x.head<2>().norm());
  });
  EXPECT_THROW(tetrahedral_wall(lumen, field, {3, 1}), Error);
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
