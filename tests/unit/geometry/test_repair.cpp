// The table of bad surfaces: what is repaired, and what is refused with its place.
#include "geometry/repair.hpp"

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "geometry/surface.hpp"
#include "geometry/surface_intersections.hpp"
#include "simple_surfaces.hpp"

namespace valsalva::geometry {
namespace {

TriMesh ball() {
  return test::sphere(10, 4);
}

/// Repaired to a closed, outward ball without self-intersections; returns the actions as one text.
std::string expect_ball(const TriMesh& bad, double volume_tolerance = 1e-9) {
  const auto repaired = repair_closed_surface(bad, {}, "ball");
  EXPECT_TRUE(border_loops(repaired.mesh).empty());
  EXPECT_NEAR(enclosed_volume(repaired.mesh) / enclosed_volume(ball()), 1, volume_tolerance);
  EXPECT_TRUE(self_intersections(repaired.mesh).empty());
  std::string text;
  for (const auto& action : repaired.actions) text += action + "\n";
  return text;
}

void expect_refused(const TriMesh& bad, std::initializer_list<const char*> words) {
  test::expect_error(ExitCode::input, words, [&] { repair_closed_surface(bad, {}, "ball"); });
}

bool holds(const std::string& text, const char* word) {
  return text.find(word) != std::string::npos;
}

TEST(Repair, SoundSurfaceIsLeftAlone) {
  const auto repaired = repair_closed_surface(ball(), {}, "ball");
  EXPECT_TRUE(repaired.actions.empty());
  EXPECT_EQ(repaired.mesh.triangles, ball().triangles);
}

TEST(Repair, SmallHoleIsClosed) {
  TriMesh bad = ball();
  bad.triangles.erase(bad.triangles.begin() + 100);
  EXPECT_TRUE(holds(expect_ball(bad), "hole of"));
}

TEST(Repair, LargeHoleIsRefused) {
  TriMesh bad = ball();
  std::erase_if(bad.triangles, [&](const Triangle& t) { return bad.points[t[0]].z() > 8; });
  expect_refused(bad, {"ball", "hole of", "around (", "max_hole_perimeter_mm"});
}

TEST(Repair, FlippedTrianglesAreTurned) {
  TriMesh bad = ball();
  for (int i : {3, 77, 512}) std::swap(bad.triangles[i][0], bad.triangles[i][1]);
  EXPECT_TRUE(holds(expect_ball(bad), "3 flipped triangles turned"));
}

TEST(Repair, InsideOutIsTurned) {
  TriMesh bad = ball();
  for (Triangle& t : bad.triangles) std::swap(t[0], t[1]);
  EXPECT_TRUE(holds(expect_ball(bad), "inside out"));
}

TEST(Repair, TriangleSoupIsWelded) {
  const TriMesh sound = ball();
  TriMesh bad;
  for (const Triangle& t : sound.triangles) {
    const int first = static_cast<int>(bad.points.size());
    for (int node : t) bad.points.push_back(sound.points[node] + Vec3(1e-6 * (first % 7), 0, 0));
    bad.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_TRUE(holds(expect_ball(bad, 1e-5), "coincident vertices welded"));
}

TEST(Repair, DoubledAndDegenerateTrianglesAreDropped) {
  TriMesh bad = ball();
  bad.triangles.push_back(bad.triangles[5]);
  bad.triangles.push_back({7, 7, 9});
  const std::string actions = expect_ball(bad);
  EXPECT_TRUE(holds(actions, "1 doubled"));
  EXPECT_TRUE(holds(actions, "1 degenerate"));
}

TEST(Repair, FinIsRemoved) {
  TriMesh bad = ball();
  const Triangle t = bad.triangles[40];
  bad.points.push_back(1.2 * bad.points[t[0]]);
  bad.triangles.push_back({t[0], t[1], static_cast<int>(bad.points.size()) - 1});
  EXPECT_TRUE(holds(expect_ball(bad), "1 fin"));
}

TEST(Repair, SplinterIsDropped) {
  TriMesh bad = ball();
  const int offset = static_cast<int>(bad.points.size());
  const TriMesh splinter = test::sphere(0.5, 1);
  for (const Vec3& p : splinter.points) bad.points.push_back(p + Vec3(20, 0, 0));
  for (const auto& [a, b, c] : splinter.triangles)
    bad.triangles.push_back({a + offset, b + offset, c + offset});
  EXPECT_TRUE(holds(expect_ball(bad), "1 splinters dropped"));
}

TEST(Repair, TwoLargePiecesAreRefused) {
  TriMesh bad = ball();
  const int offset = static_cast<int>(bad.points.size());
  for (const Vec3& p : ball().points) bad.points.push_back(p + Vec3(30, 0, 0));
  for (const auto& [a, b, c] : ball().triangles)
    bad.triangles.push_back({a + offset, b + offset, c + offset});
  expect_refused(bad, {"2 separate pieces"});
}

TEST(Repair, NonManifoldEdgeIsRefused) {
  // A second ball that shares one edge with the first: that edge has four triangles.
  TriMesh bad = ball();
  const auto [p, q, unused] = bad.triangles[40];
  const Vec3 middle = 0.5 * (bad.points[p] + bad.points[q]);
  const int offset = static_cast<int>(bad.points.size());
  for (const Vec3& x : ball().points) bad.points.push_back(2 * middle - x);
  for (auto [a, b, c] : ball().triangles) {
    Triangle turned{c + offset, b + offset, a + offset};
    for (int& node : turned) {
      if (node == p + offset)
        node = q;
      else if (node == q + offset)
        node = p;
    }
    bad.triangles.push_back(turned);
  }
  expect_refused(bad, {"1 non-manifold edges", "near ("});
}

TEST(Repair, PinchedVertexIsSplit) {
  // Two balls that touch in one vertex: the smaller piece then goes as a splinter.
  TriMesh bad = ball();
  const TriMesh small = test::sphere(0.6, 1);
  const int offset = static_cast<int>(bad.points.size());
  for (const Vec3& x : small.points) bad.points.push_back(x + Vec3(0, 0, 10.6));
  for (const auto& [a, b, c] : small.triangles) bad.triangles.push_back({a + offset, b + offset, c + offset});
  const std::string actions = expect_ball(bad);
  EXPECT_TRUE(holds(actions, "touches itself")) << actions;
  EXPECT_TRUE(holds(actions, "splinters")) << actions;
}

TEST(Repair, LocalSelfIntersectionIsCutOut) {
  TriMesh bad = test::sphere(10, 5);
  // One vertex pushed through the opposite side of its own neighbourhood.
  const Triangle t = bad.triangles[200];
  bad.points[t[0]] = bad.points[t[0]] + 3.0 * (bad.points[t[1]] - bad.points[t[0]]);
  ASSERT_FALSE(self_intersections(bad).empty());
  EXPECT_TRUE(holds(expect_ball(bad, 1e-2), "self-intersection of"));
}

TEST(Repair, LargeSelfIntersectionIsRefused) {
  // A torus whose tube is wider than its ring passes through itself around the axis.
  expect_refused(test::torus(3, 5, 60, 40), {"passes through itself", "near ("});
}

TEST(Repair, MoebiusBandIsRefused) {
  TriMesh band;
  const int n = 40;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    const Vec3 out(std::cos(a), std::sin(a), 0);
    const Vec3 across = std::cos(a / 2) * out + std::sin(a / 2) * Vec3::UnitZ();
    band.points.push_back(5 * out - across);
    band.points.push_back(5 * out + across);
  }
  for (int i = 0; i < n; ++i) {
    const int a = 2 * i, b = 2 * i + 1;
    const int c = i + 1 < n ? a + 2 : 1, d = i + 1 < n ? b + 2 : 0;
    band.triangles.push_back({a, b, c});
    band.triangles.push_back({b, d, c});
  }
  expect_refused(band, {"one side only"});
}

TEST(Repair, NonsenseIsRefused) {
  TriMesh bad = ball();
  bad.points[4].y() = std::nan("");
  expect_refused(bad, {"vertex 4", "not finite"});
  bad = ball();
  bad.triangles[6][1] = 99999;
  expect_refused(bad, {"triangle 6", "99999"});
  expect_refused({}, {"no triangles"});
}

}  // namespace
}  // namespace valsalva::geometry
