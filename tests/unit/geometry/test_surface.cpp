#include "geometry/surface.hpp"

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "geometry/surface_cut.hpp"
#include "geometry/surface_fill.hpp"
#include "geometry/surface_intersections.hpp"
#include "simple_surfaces.hpp"

namespace valsalva::geometry {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Surface, SphereVolumeAndAreaConvergeAtSecondOrder) {
  const double volume = 4 * pi / 3, area = 4 * pi;
  const TriMesh coarse = test::sphere(1, 3), fine = test::sphere(1, 4);
  const double volume_ratio = (volume - enclosed_volume(coarse)) / (volume - enclosed_volume(fine));
  const double area_ratio = (area - surface_area(coarse)) / (area - surface_area(fine));
  EXPECT_NEAR(volume_ratio, 4, 0.2);
  EXPECT_NEAR(area_ratio, 4, 0.2);
}

TEST(Surface, AngleDefectTellsCupFromSheet) {
  TriMesh cup = test::sphere(1, 4);
  std::erase_if(cup.triangles, [&](const Triangle& t) {
    return cup.points[t[0]].z() + cup.points[t[1]].z() + cup.points[t[2]].z() < 0;
  });
  EXPECT_NEAR(total_gauss_curvature(compacted(cup)), 2 * pi, 0.5);
  EXPECT_NEAR(total_gauss_curvature(test::cylinder(3, 5, 24, 7)), 0, 1e-9);
}

TEST(Surface, BordersOfATubeAreItsTwoRims) {
  const auto loops = border_loops(test::cylinder(2, 3, 12, 4));
  ASSERT_EQ(loops.size(), 2u);
  EXPECT_EQ(loops[0].size(), 12u);
  EXPECT_EQ(loops[1].size(), 12u);
  EXPECT_TRUE(border_loops(test::sphere(1, 2)).empty());
}

TEST(Surface, FillingANotchedPolygonCoversItsArea) {
  // A square with a notch: area 12, and no triangle may lie in the notch.
  const Points corners{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, 0.0 + 2, 0}, {0, 4, 0}};
  const auto triangles = filled_loop(corners, {0, 1, 2, 3, 4});
  double area = 0;
  for (const auto& [a, b, c] : triangles) {
    const Vec3 p = corners[b] - corners[a], q = corners[c] - corners[a];
    const double twice = p.x() * q.y() - p.y() * q.x();
    EXPECT_LT(twice, 0) << "turned with the border, not against it";
    area += std::abs(twice) / 2;
  }
  EXPECT_EQ(triangles.size(), 3u);
  EXPECT_NEAR(area, 12, 1e-12);
}

TEST(Surface, CutSphereHasTheVolumeOfItsZone) {
  const double radius = 10, low = -3, high = 5;
  const TriMesh zone = cut_closed_between(test::sphere(radius, 6), low, high);
  const auto primitive = [&](double z) { return pi * (radius * radius * z - z * z * z / 3); };
  EXPECT_TRUE(border_loops(zone).empty());
  EXPECT_NEAR(enclosed_volume(zone) / (primitive(high) - primitive(low)), 1, 2e-3);
  const TriMesh open = without_caps(zone, low, high);
  ASSERT_EQ(border_loops(open).size(), 2u);
  for (const auto& loop : border_loops(open))
    for (int node : loop) EXPECT_TRUE(open.points[node].z() == low || open.points[node].z() == high);
}

TEST(Surface, CutThatMissesIsAnError) {
  test::expect_error(ExitCode::input, {"cut plane", "12.0"},
                     [] { cut_closed_between(test::sphere(10, 2), -3, 12); });
}

TEST(Surface, SelfIntersectionsAreFoundAndOnlyThose) {
  TriMesh two = test::sphere(1, 2);
  EXPECT_TRUE(self_intersections(two).empty());
  const TriMesh other = test::sphere(1, 2);
  const int offset = static_cast<int>(two.points.size());
  for (const Vec3& p : other.points) two.points.push_back(p + Vec3(1.3, 0.1, 0.2));
  for (const auto& [a, b, c] : other.triangles) two.triangles.push_back({a + offset, b + offset, c + offset});
  EXPECT_FALSE(self_intersections(two).empty());
}

}  // namespace
}  // namespace valsalva::geometry
