#include <gtest/gtest.h>

#include <random>

#include "contact/intersections.hpp"
#include "scenes.hpp"

namespace valsalva::contact {
namespace {

TEST(Crossings, SegmentThroughAndBesideATriangle) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_TRUE(segment_crosses_triangle({0.2, 0.2, -1}, {0.3, 0.2, 1}, a, b, c));
  EXPECT_TRUE(segment_crosses_triangle({0.2, 0.2, 1}, {0.3, 0.2, -1}, a, b, c));
  EXPECT_FALSE(segment_crosses_triangle({0.2, 0.2, 0.1}, {0.3, 0.2, 1}, a, b, c));
  EXPECT_FALSE(segment_crosses_triangle({0.8, 0.8, -1}, {0.8, 0.8, 1}, a, b, c));
}

TEST(Crossings, CountsThoseOfAPushedThroughStrut) {
  auto tissue = test::sheet(6, 0.5, 0);
  Points x = tissue.points;
  x.insert(x.end(), {Vec3(0.9, 1.3, -1), Vec3(0.9, 1.3, 1), Vec3(2.1, 1.3, 1), Vec3(2.1, 1.3, 0.5)});
  CollisionMesh mesh(x);
  mesh.add_shell({"tissue", 0}, 0, tissue.triangles, std::vector<double>(tissue.points.size(), 0.1));
  mesh.add_beams({"frame", 0}, static_cast<int>(tissue.points.size()), {{0, 1}, {1, 2}, {2, 3}},
                 {0.1, 0.1, 0.1});
  EXPECT_EQ(crossings(mesh, x).size(), 1u);
  mesh.identify(static_cast<int>(tissue.points.size()), mesh.faces()[crossings(mesh, x)[0][1]].node[0]);
  EXPECT_TRUE(crossings(mesh, x).empty()) << "a strut sewn to the triangle is its neighbour";
}

TEST(Crossings, EqualBruteForceOnACrumpledSheet) {
  auto tissue = test::sheet(12, 0.5, 0);
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 0.4);
  Points x = tissue.points;
  for (Vec3& p : x) p += Vec3(noise(random), noise(random), noise(random));
  CollisionMesh mesh(tissue.points);
  mesh.add_shell({"tissue", 0}, 0, tissue.triangles, std::vector<double>(x.size(), 0.1));
  std::vector<std::array<int, 2>> brute;
  for (int e = 0; e < static_cast<int>(mesh.edges().size()); ++e)
    for (int f = 0; f < static_cast<int>(mesh.faces().size()); ++f) {
      const auto& n = mesh.edges()[e].node;
      const auto& m = mesh.faces()[f].node;
      bool shared = false;
      for (int i : n)
        for (int j : m) shared = shared || i == j;
      if (!shared && segment_crosses_triangle(x[n[0]], x[n[1]], x[m[0]], x[m[1]], x[m[2]]))
        brute.push_back({e, f});
    }
  EXPECT_GT(brute.size(), 100u);
  EXPECT_EQ(crossings(mesh, x), brute);
}

}  // namespace
}  // namespace valsalva::contact
