// The trileaflet shapes, copies about the axis, and thickness on a grid.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "assembly/valve_shapes.hpp"
#include "expect_error.hpp"

namespace valsalva::assembly {
namespace {

const Frame upright{Vec3(1, 2, 3), Mat3::Identity()};

ValveShape sample() {
  ValveShape v;
  v.radius = 12;
  v.height = 11;
  v.post = 2;
  v.gap = 2.5;
  v.peak = 1;
  v.half_angle_deg = 57;
  v.base = 3;
  return v;
}

TEST(ValveShapes, TheLeafletHangsOnTheTubeAndTheCrownEndsThere) {
  const ValveShape v = sample();
  const double half = 57 * M_PI / 180;
  const auto attachment = [&](const Vec3& x) { return 11 * std::pow(std::atan2(x.y(), x.x()) / half, 2); };
  const BodyMesh leaflet = sheet(leaflet_map(upright, v, {-1, 1}), {16, 8}, Pattern::alternating);
  for (const char* side : {"start1", "start2", "end1"})
    for (int a : leaflet.groups.at(side)) {
      const Vec3 x = leaflet.points[a] - upright.origin;
      EXPECT_NEAR(x.head<2>().norm(), 12, 1e-9);
      if (x.z() < 11 - 1e-6) {
        EXPECT_NEAR(x.z(), attachment(x), 1e-9) << side;
      } else {
        EXPECT_NEAR(std::abs(std::atan2(x.y(), x.x())), half, 1e-6) << side;
      }
    }
  const BodyMesh crown = sheet(crown_map(upright, v, {-1, 1}), {16, 4}, Pattern::alternating);
  for (int a : crown.groups.at("end2")) {
    const Vec3 x = crown.points[a] - upright.origin;
    EXPECT_NEAR(x.head<2>().norm(), 12, 1e-12);
    EXPECT_NEAR(x.z(), attachment(x), 1e-12);
  }
  const auto& edge = leaflet.groups.at("end2");
  const Vec3 middle = leaflet.points[edge[8]] - upright.origin;
  EXPECT_LT((middle - Vec3(2.5, 0, 14)).norm(), 1e-6);
  const Vec3 tip = leaflet.points[edge[0]] - upright.origin;
  EXPECT_NEAR(tip.head<2>().norm(), 12, 1e-9);
  EXPECT_NEAR(std::atan2(tip.y(), tip.x()), -half, 1e-9);
}

TEST(ValveShapes, TheFreeEdgeCanFollowTheTubeAndIsLongerThen) {
  ValveShape v = sample();
  const auto edge = [&] {
    const BodyMesh leaflet = sheet(leaflet_map(upright, v, {-1, 1}), {64, 8}, Pattern::alternating);
    Points x;
    for (int a : leaflet.groups.at("end2")) x.push_back(leaflet.points[a] - upright.origin);
    return x;
  };
  const auto length = [](const Points& x) {
    double sum = 0;
    for (std::size_t i = 1; i < x.size(); ++i) sum += (x[i] - x[i - 1]).head<2>().norm();
    return sum;
  };
  const double bowed = length(edge());
  v.edge_exponent = 2;
  const Points x = edge();
  EXPECT_GT(length(x), 1.02 * bowed);
  for (const Vec3& p : x) {
    const double s = std::atan2(p.y(), p.x()) / (57 * M_PI / 180);
    EXPECT_NEAR(p.head<2>().norm(), 12 - 9.5 * std::pow(std::cos(0.5 * M_PI * s), 2), 1e-6);
  }
  v.gap = 9;
  check_valve(v, "beyond the chord");
  v.gap = 12.1;
  test::expect_error(ExitCode::input, {"gap is 12.1", "12 mm"}, [&] { check_valve(v, "x"); });
}

// Twice the area over the longest side squared: 0.87 for an equilateral triangle. The worst lie where two
// sides of the patch meet in a straight line.
TEST(ValveShapes, ElementsKeepTheirShapeIntoTheCommissures) {
  for (const std::array<double, 2> part : {std::array{-1.0, 1.0}, {0.0, 1.0}}) {
    const BodyMesh leaflet = sheet(leaflet_map(upright, sample(), part), {16, 12}, Pattern::alternating);
    int poor = 0;
    for (const Triangle& t : leaflet.triangles) {
      const Vec3 &p = leaflet.points[t[0]], &q = leaflet.points[t[1]], &r = leaflet.points[t[2]];
      const double longest = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
      const double shape = (q - p).cross(r - p).norm() / (longest * longest);
      EXPECT_GT(shape, 0.04);
      if (shape < 0.12) ++poor;
    }
    EXPECT_LT(poor, 10) << "of " << leaflet.triangles.size();
  }
}

TEST(ValveShapes, TheLeafletsNormalPointsToTheAorta) {
  const BodyMesh leaflet = sheet(leaflet_map(upright, sample(), {-1, 1}), {16, 8}, Pattern::alternating);
  for (const Triangle& t : leaflet.triangles) {
    const Vec3 &p = leaflet.points[t[0]], &q = leaflet.points[t[1]], &r = leaflet.points[t[2]];
    const Vec3 outward((p + q + r) / 3 - upright.origin);
    EXPECT_GT((q - p).cross(r - p).dot(Vec3(outward.x(), outward.y(), 12)), 0);
  }
}

TEST(ValveShapes, AHalfEndsInTheSymmetryPlaneThroughItsWall) {
  ValveShape v = sample();
  v.wall = 0.4;
  const BodyMesh half = block(leaflet_map({}, v, {0, 1}), {8, 8, 2}, structure::Shape::hex8);
  for (int a : half.groups.at("start1")) EXPECT_NEAR(half.points[a].y(), 0, 1e-6);
}

TEST(ValveShapes, ThreeCrownsAndPostsCloseTheRing) {
  ValveShape v = sample();
  v.half_angle_deg = 60;
  const BodyMesh crown = sheet(crown_map(upright, v, {-1, 1}), {16, 4}, Pattern::alternating);
  const BodyMesh ring = repeated_round(crown, upright, 3);
  EXPECT_EQ(ring.triangles.size(), 3 * crown.triangles.size());
  EXPECT_EQ(ring.points.size(), 3 * crown.points.size() - 3 * 5) << "neighbours share their last column";
  EXPECT_EQ(ring.groups.at("start2").size(), 3u * 16);
  EXPECT_EQ(ring.groups.at("end2_2").size(), 17u);
}

TEST(ValveShapes, ImpossibleOnesAreRefused) {
  ValveShape v = sample();
  v.gap = 9;
  test::expect_error(ExitCode::input, {"case.toml: [[body]] 'leaflet'", "gap is 9", "6.536"},
                     [&] { check_valve(v, "case.toml: [[body]] 'leaflet'"); });
  v = sample();
  v.post = 0;
  test::expect_error(ExitCode::input, {"post 0", "positive"}, [&] { check_valve(v, "x"); });
}

TEST(Generate, BilinearValuesMeetTheirPointsAndAreLinearBetween) {
  const std::vector<double> values{1, 2, 4, 3, 5, 8};
  EXPECT_EQ(bilinear(values, {3, 2}, 0, 0), 1);
  EXPECT_EQ(bilinear(values, {3, 2}, 1, 1), 8);
  EXPECT_EQ(bilinear(values, {3, 2}, 0.5, 0), 2);
  EXPECT_EQ(bilinear(values, {3, 2}, 0.75, 0.5), 0.5 * (3 + 6.5));
}

TEST(Generate, NodesKnowTheirPlaceInTheGrid) {
  for (const Pattern pattern : {Pattern::alternating, Pattern::crossed}) {
    const BodyMesh mesh = sheet(plate_map({}, {4, 2, 0}, 0), {5, 3}, pattern);
    ASSERT_EQ(mesh.fields.at("grid1").size(), mesh.points.size());
    for (std::size_t a = 0; a < mesh.points.size(); ++a) {
      EXPECT_NEAR(4 * mesh.fields.at("grid1")[a], mesh.points[a].x(), 1e-12);
      EXPECT_NEAR(2 * mesh.fields.at("grid2")[a], mesh.points[a].y(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace valsalva::assembly
