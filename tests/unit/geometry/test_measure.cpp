// Plane sections, their figures, and the centreline.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/centreline.hpp"

namespace {

using namespace valsalva;
using std::numbers::pi;

geometry::GridSdf elliptic_tube(double a, double b) {
  return geometry::sample(Vec3(-18, -18, -5), Vec3(18, 18, 5), 0.5,
                          [&](const Vec3& x) { return (std::hypot(x.x() / a, x.y() / b) - 1) * b; });
}

TEST(Section, EllipseHasItsFigures) {
  const auto tube = elliptic_tube(13.5, 11.5);
  const geometry::Plane plane = geometry::Plane::at(Vec3(0.4, 0.2, 0.3), Vec3::UnitZ());
  const geometry::Loop loop = geometry::loop_at_origin(geometry::section(tube, plane, 17, 0.25));
  const auto found = geometry::figures(loop, plane);
  const double h = std::pow((13.5 - 11.5) / (13.5 + 11.5), 2);
  EXPECT_NEAR(found.area_mm2, pi * 13.5 * 11.5, 1.5);
  EXPECT_NEAR(found.perimeter_mm, pi * 25 * (1 + 3 * h / (10 + std::sqrt(4 - 3 * h))), 0.2);  // Ramanujan
  EXPECT_NEAR(found.greatest_mm, 27, 0.05);
  EXPECT_NEAR(found.least_mm, 23, 0.05);
  EXPECT_LT((found.centre - Vec3(0, 0, 0.3)).norm(), 0.02);
  EXPECT_NEAR(geometry::distance_to(loop, {-0.4, -0.2}), -11.5, 0.05);
  EXPECT_NEAR(geometry::radii(loop, geometry::centroid(loop), 4)[0], 13.5, 0.05);
}

TEST(Section, ObliqueCutOfACylinderIsAnEllipse) {
  const auto tube = geometry::sample(Vec3::Constant(-20), Vec3::Constant(20), 0.5,
                                     [](const Vec3& x) { return std::hypot(x.x(), x.y()) - 9; });
  const geometry::Plane plane = geometry::Plane::at(Vec3::Zero(), Vec3(0, 1, 1));
  const auto found =
      geometry::figures(geometry::loop_at_origin(geometry::section(tube, plane, 18, 0.25)), plane);
  EXPECT_NEAR(found.greatest_mm, 18 * std::numbers::sqrt2, 0.1);
  EXPECT_NEAR(found.least_mm, 18, 0.1);
}

TEST(Section, ChoosesTheLoopAroundTheOriginAndReportsNone) {
  const auto two = geometry::sample(Vec3(-20, -10, -3), Vec3(20, 10, 3), 0.5, [](const Vec3& x) {
    return std::min(std::hypot(x.x() - 10, x.y()) - 6, std::hypot(x.x() + 10, x.y()) - 4);
  });
  const auto loops = geometry::section(two, geometry::Plane::at(Vec3(10, 0, 0), Vec3::UnitZ()), 30, 0.5);
  EXPECT_EQ(loops.size(), 2u);
  EXPECT_NEAR(geometry::area(geometry::loop_at_origin(loops)), pi * 36, 1);
  EXPECT_TRUE(geometry::loop_at_origin({}).empty());
}

TEST(Centreline, FollowsATorus) {
  const auto torus = geometry::sample(Vec3(-42, -42, -12), Vec3(42, 42, 12), 0.8, [](const Vec3& x) {
    return std::hypot(std::hypot(x.x(), x.y()) - 30, x.z()) - 8;
  });
  geometry::CentrelineOptions options;
  options.max_length_mm = 60;
  options.half_width_mm = 20;
  const auto line = geometry::follow(torus, Vec3(31, 0, 1), Vec3::UnitY(), options);
  ASSERT_GT(line.size(), 50u);
  for (const auto& p : line) {
    EXPECT_NEAR(std::hypot(p.position.x(), p.position.y()), 30, 1.2);
    EXPECT_NEAR(p.position.z(), 0, 0.3);
    EXPECT_NEAR(p.section.area_diameter_mm(), 16, 0.6);
  }
  EXPECT_TRUE(geometry::follow(torus, Vec3::Zero(), Vec3::UnitY(), options).empty());
}

}  // namespace
