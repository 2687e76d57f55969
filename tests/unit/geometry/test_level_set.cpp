// Level sets against analytic shapes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/level_set.hpp"
#include "geometry/surface.hpp"

namespace {

using namespace valsalva;
using geometry::GridSdf;
using std::numbers::pi;

const Vec3 middle(0.13, -0.21, 0.07);  // off the lattice

double sphere(const Vec3& x, double radius) {
  return (x - middle).norm() - radius;
}
double torus(const Vec3& x) {
  const Vec3 y = x - middle;
  return std::hypot(std::hypot(y.x(), y.y()) - 8, y.z()) - 3;
}
double cylinder(const Vec3& x) {
  const Vec3 y = x - middle;
  return std::max(std::hypot(y.x(), y.y()) - 6, std::abs(y.z()) - 7);
}

struct Shape {
  const char* name;
  double (*distance)(const Vec3&);
  double volume, area;
  double sharp_edges_mm;  // a convex right-angled edge is chamfered within one cell
};
const Shape shapes[] = {
    {"sphere", [](const Vec3& x) { return sphere(x, 8); }, 4.0 / 3 * pi * 512, 4 * pi * 64, 0},
    {"torus", torus, 2 * pi* pi * 8 * 9, 4 * pi* pi * 8 * 3, 0},
    {"cylinder", cylinder, pi * 36 * 14, 2 * pi * 36 + 2 * pi * 6 * 14, 4 * pi * 6}};

GridSdf sampled(double (*distance)(const Vec3&), double spacing) {
  return geometry::sample(Vec3::Constant(-14), Vec3::Constant(14), spacing, distance);
}

TEST(LevelSet, SurfaceHasTheVolumeAndAreaOfTheShape) {
  for (const Shape& shape : shapes) {
    const geometry::TriMesh mesh = geometry::zero_surface(sampled(shape.distance, 0.5));
    EXPECT_TRUE(geometry::border_loops(mesh).empty()) << shape.name;
    EXPECT_NEAR(geometry::enclosed_volume(mesh) / shape.volume, 1, 0.01) << shape.name;
    const double chamfer = (2 - std::numbers::sqrt2) * 0.5 * shape.sharp_edges_mm;
    EXPECT_NEAR(geometry::surface_area(mesh) / shape.area, 1, 0.01 + chamfer / shape.area) << shape.name;
  }
}

TEST(LevelSet, SmoothShapesConvergeWithSecondOrder) {
  for (int n = 0; n < 2; ++n) {
    const auto error = [&](double spacing) {
      const geometry::TriMesh mesh = geometry::zero_surface(sampled(shapes[n].distance, spacing));
      return std::abs(geometry::enclosed_volume(mesh) / shapes[n].volume - 1);
    };
    const double order = std::log2(error(1.0) / error(0.5));
    EXPECT_GT(order, 1.6) << shapes[n].name;
  }
}

TEST(LevelSet, VolumeInsideNeedsNoSurface) {
  for (const Shape& shape : shapes)
    EXPECT_NEAR(geometry::volume_inside(sampled(shape.distance, 0.5)) / shape.volume, 1, 0.005) << shape.name;
}

TEST(LevelSet, DistanceIsRestoredFromADistortedField) {
  const auto distorted = [](const Vec3& x) { return sphere(x, 8) * (2 + std::sin(x.x())); };
  const GridSdf grid =
      geometry::redistanced(geometry::sample(Vec3::Constant(-14), Vec3::Constant(14), 0.5, distorted));
  double near = 0, far = 0;
  for (int k = 0; k < grid.dimensions[2]; ++k)
    for (int j = 0; j < grid.dimensions[1]; ++j)
      for (int i = 0; i < grid.dimensions[0]; ++i) {
        const double exact = sphere(grid.origin + 0.5 * Vec3(i, j, k), 8);
        double& worst = std::abs(exact) < 1 ? near : far;
        if (exact > -6) worst = std::max(worst, std::abs(grid.at(i, j, k) - exact));  // the centre is a kink
      }
  // Linear interpolation: h^2 / 8 times the field's curvature (2) over its least slope (1).
  EXPECT_LT(near, 0.0625);
  EXPECT_LT(far, 0.5);  // first order: one spacing
}

TEST(LevelSet, DistanceToAClosedSurfaceAgreesWithTheField) {
  const GridSdf grid = sampled(torus, 0.5);
  const GridSdf distance = geometry::signed_distance(geometry::zero_surface(grid), grid);
  for (std::size_t n = 0; n < grid.values.size(); ++n)
    if (std::abs(grid.values[n]) < 1) {
      ASSERT_NEAR(distance.values[n], grid.values[n], 0.06);
    }
}

TEST(LevelSet, TrianglesFaceOutward) {
  EXPECT_GT(geometry::enclosed_volume(geometry::zero_surface(sampled(torus, 0.7))), 0);
}

TEST(LevelSet, SmoothingKeepsVolumeAndRemovesRoughness) {
  const auto rough = [](const Vec3& x) {
    return sphere(x, 8) + 0.6 * std::sin(3 * x.x()) * std::sin(3 * x.y());
  };
  const GridSdf before =
      geometry::redistanced(geometry::sample(Vec3::Constant(-14), Vec3::Constant(14), 0.4, rough));
  const GridSdf after = geometry::smoothed(before, 1.0);
  EXPECT_NEAR(geometry::volume_inside(after) / geometry::volume_inside(before), 1, 2e-4);
  const double area_before = geometry::surface_area(geometry::zero_surface(before));
  const double area_after = geometry::surface_area(geometry::zero_surface(after));
  EXPECT_GT(area_before / (4 * pi * 64), 1.1);
  EXPECT_NEAR(area_after / (4 * pi * 64), 1, 0.03);
}

TEST(LevelSet, ComponentsAndCavities) {
  const auto two = [](const Vec3& x) {
    return std::min((x - Vec3(-6, 0, 0)).norm(), (x - Vec3(6, 0, 0)).norm()) - 4;
  };
  const auto volume = [](const GridSdf& field) {
    return geometry::enclosed_volume(geometry::zero_surface(field));
  };
  const GridSdf both = sampled(two, 0.5);
  const double one = 4.0 / 3 * pi * 64;
  const GridSdf right = geometry::component_at(both, {Vec3(6, 0, 0)});
  EXPECT_NEAR(volume(right) / one, 1, 0.02);
  EXPECT_GT(right.value(Vec3(-6, 0, 0)), 0);
  EXPECT_EQ(volume(geometry::component_at(both, {Vec3(0, 0, 9)})), 0);
  EXPECT_NEAR(volume(geometry::component_at(both, {Vec3(6, 0, 0), Vec3(-6, 0, 0)})) / one, 2, 0.04);

  const auto hollow = [](const Vec3& x) { return std::max(sphere(x, 8), 3 - (x - middle).norm()); };
  const double full = 4.0 / 3 * pi * 512;
  EXPECT_NEAR(volume(geometry::without_cavities(sampled(hollow, 0.5))) / full, 1, 0.01);
}

}  // namespace
