#include "geometry/remesh.hpp"

#include <gtest/gtest.h>

#include "geometry/quality.hpp"
#include "geometry/surface.hpp"
#include "simple_surfaces.hpp"

namespace valsalva::geometry {
namespace {

constexpr double pi = std::numbers::pi;

void expect_even(const TriMesh& mesh, double edge) {
  const EdgeLengths lengths = edge_lengths(mesh);
  EXPECT_NEAR(lengths.mean / edge, 1, 0.1);
  EXPECT_LT(lengths.longest / edge, 1.6);
  EXPECT_GT(quality_of(mesh).min_angle_deg, 20);
}

TEST(Remesh, SphereKeepsVolumeAndArea) {
  const double r = 10, edge = 1;
  const TriMesh mesh = remesh(test::sphere(r, 5), {edge});
  expect_even(mesh, edge);
  // A chord of length e lies e^2 / (8 r) inside: relative volume 3 e^2 / (8 r^2) at most, plus the input's
  // own.
  EXPECT_NEAR(enclosed_volume(mesh) / (4 * pi / 3 * r * r * r), 1, 5e-3);
  EXPECT_NEAR(surface_area(mesh) / (4 * pi * r * r), 1, 4e-3);
}

TEST(Remesh, TorusKeepsVolumeAndArea) {
  const double ring = 10, tube = 4, edge = 0.8;
  const TriMesh mesh = remesh(test::torus(ring, tube, 160, 64), {edge});
  expect_even(mesh, edge);
  EXPECT_NEAR(enclosed_volume(mesh) / (2 * pi * pi * ring * tube * tube), 1, 1.5e-2);
  EXPECT_NEAR(surface_area(mesh) / (4 * pi * pi * ring * tube), 1, 1e-2);
}

TEST(Remesh, RimsStayWhereTheyAre) {
  // Relaxing border vertices along their line once pulled the rims inwards by a tenth of their radius.
  const double r = 8, height = 10, edge = 1.5;
  const TriMesh mesh = remesh(test::cylinder(r, height, 400, 40), {edge});
  const auto loops = border_loops(mesh);
  ASSERT_EQ(loops.size(), 2u);
  for (const auto& loop : loops)
    for (int node : loop) {
      const Vec3& p = mesh.points[node];
      EXPECT_NEAR(p.head<2>().norm(), r, 1e-3);
      EXPECT_TRUE(p.z() == 0 || p.z() == height) << p.z();
    }
}

TEST(Remesh, CapsCloseATube) {
  const double r = 8, height = 10, edge = 1.5;
  const TriMesh closed = closed_by_caps(remesh(test::cylinder(r, height, 400, 40), {edge}), edge);
  EXPECT_TRUE(border_loops(closed).empty());
  EXPECT_NEAR(enclosed_volume(closed) / (pi * r * r * height), 1, 1e-2);
  EXPECT_GT(quality_of(closed).min_angle_deg, 10);
}

TEST(Remesh, SameInputSameBits) {
  const TriMesh input = test::torus(10, 4, 80, 32);
  const TriMesh one = remesh(input, {1.3}), two = remesh(input, {1.3});
  ASSERT_EQ(one.points.size(), two.points.size());
  EXPECT_EQ(one.triangles, two.triangles);
  for (std::size_t i = 0; i < one.points.size(); ++i) EXPECT_EQ(one.points[i], two.points[i]);
}

}  // namespace
}  // namespace valsalva::geometry
