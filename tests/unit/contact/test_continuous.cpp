// Continuous detection: no pair passes its limit, and no pair that may is overlooked.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "contact/intersections.hpp"
#include "scenes.hpp"

namespace valsalva::contact {
namespace {

using Quad = std::array<Vec3, 4>;

Quad between(const Quad& a, const Quad& b, double share) {
  Quad x;
  for (int k = 0; k < 4; ++k) x[k] = a[k] + share * (b[k] - a[k]);
  return x;
}

TEST(Continuous, APointStopsAboveATriangle) {
  const Quad from{Vec3(0.2, 0.2, 1), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  Quad to = from;
  to[0].z() = -1;
  const double share = allowed_share(PairKind::point_triangle, from, to, 0.1);
  EXPECT_LE(share, 0.45);
  EXPECT_GT(share, 0.42);  // within the twentieth of the way that is left
}

TEST(Continuous, CommonMotionIsFree) {
  const Quad from{Vec3(0.2, 0.2, 0.05), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  Quad to = from;
  for (Vec3& p : to) p += Vec3(100, -30, 20);
  EXPECT_EQ(allowed_share(PairKind::point_triangle, from, to, 0.04), 1);
}

TEST(Continuous, RandomPairsStayAboveTheirLimitAllTheWay) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  int stopped = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const PairKind kind = trial % 2 ? PairKind::edge_edge : PairKind::point_triangle;
    Quad from, to;
    const double size = std::pow(10.0, trial % 5 - 1);
    for (int k = 0; k < 4; ++k) {
      from[k] = Vec3(normal(random), normal(random), normal(random));
      to[k] = from[k] + size * Vec3(normal(random), normal(random), normal(random));
    }
    const double start = nearest(kind, from).distance, limit = 0.3 * start;
    const double share = allowed_share(kind, from, to, limit);
    ASSERT_GT(share, 0);
    for (int i = 0; i <= 60; ++i)
      EXPECT_GT(nearest(kind, between(from, to, share * i / 60)).distance, limit * (1 - 1e-9));
    if (share == 1) continue;
    ++stopped;
    EXPECT_LT(nearest(kind, between(from, to, share)).distance, limit + 0.051 * (start - limit));
  }
  EXPECT_GT(stopped, 250);
}

TEST(Continuous, SweptListsHoldEveryPairThatComesNear) {
  test::TwoSheets scene(4, 0.5, 0.05);
  const std::size_t half = scene.lower.points.size();
  Candidates candidates(scene.mesh, {1e5, 0.9, 0.3, 0.05});
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  for (double way : {0.01, 0.1, 1.5}) {  // within the near list, the wide list, beyond both
    Points from = scene.reference;
    for (std::size_t i = half; i < from.size(); ++i) from[i].z() = 0.1 + 0.5 * way;
    candidates.update(from);
    Points to = from;
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] += 0.2 * way * Vec3(normal(random), normal(random), normal(random));
      if (i >= half) to[i] -= Vec3(0.3 * way, 0.2 * way, way);
    }
    const Candidates::Swept swept = candidates.along(from, to);
    std::set<std::pair<int, int>> points, edges;
    for (const auto& p : swept.point_triangle) points.insert({p.first, p.second});
    for (const auto& p : swept.edge_edge) edges.insert({p.first, p.second});
    const auto comes_near = [&](PairKind kind, const std::array<int, 4>& n) {
      const Quad a{from[n[0]], from[n[1]], from[n[2]], from[n[3]]}, b{to[n[0]], to[n[1]], to[n[2]], to[n[3]]};
      for (int i = 0; i <= 60; ++i)
        if (nearest(kind, between(a, b, i / 60.0)).distance < 0.1) return true;
      return false;
    };
    const auto neighbours = [](const auto& a, const auto& b) {
      for (int i : a)
        for (int j : b)
          if (i == j) return true;
      return false;
    };
    int near = 0;
    for (int v = 0; v < int(scene.mesh.vertices().size()); ++v)
      for (int f = 0; f < int(scene.mesh.faces().size()); ++f) {
        const int node = scene.mesh.vertices()[v].node;
        const auto& face = scene.mesh.faces()[f].node;
        if (neighbours(std::array{node}, face)) continue;
        if (!comes_near(PairKind::point_triangle, {node, face[0], face[1], face[2]})) continue;
        ++near;
        EXPECT_TRUE(points.count({v, f}));
      }
    for (int a = 0; a < int(scene.mesh.edges().size()); ++a)
      for (int b = a + 1; b < int(scene.mesh.edges().size()); ++b) {
        const auto &one = scene.mesh.edges()[a].node, &other = scene.mesh.edges()[b].node;
        if (neighbours(one, other)) continue;
        if (!comes_near(PairKind::edge_edge, {one[0], one[1], other[0], other[1]})) continue;
        ++near;
        EXPECT_TRUE(edges.count({a, b}));
      }
    EXPECT_GT(near, 20) << way;
  }
}

TEST(Continuous, AllowedMotionKeepsSheetsApartAtAnySpeed) {
  for (double speed : {1.0, 10.0, 1000.0}) {
    test::TwoSheets scene(3, 0.5, 0.05);
    BodyContact contact(Candidates(scene.mesh, {1e5, 0.9, 0.3, 0.05}), Law::barrier);
    const std::size_t half = scene.lower.points.size();
    auto now = test::at(scene.reference);
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    for (std::size_t i = half; i < now.x.size(); ++i) now.x[i].z() = 0.3;
    for (int step = 0; step < 8; ++step) {  // no forces: only the limit stands between
      contact.begin_step(now, 1);
      Points to = now.x;
      for (std::size_t i = half; i < to.size(); ++i)
        to[i] += 0.1 * speed * Vec3(0.1 * normal(random), 0.1 * normal(random), -1 + 0.3 * normal(random));
      const double share = contact.allowed_motion(now, to);
      ASSERT_GT(share, 0);
      for (std::size_t i = 0; i < to.size(); ++i) now.x[i] += share * (to[i] - now.x[i]);
      ASSERT_TRUE(crossings(scene.mesh, now.x).empty()) << speed << " " << step;
    }
    for (std::size_t i = half; i < now.x.size(); ++i) EXPECT_GT(now.x[i].z(), 0) << speed;
  }
}

}  // namespace
}  // namespace valsalva::contact
