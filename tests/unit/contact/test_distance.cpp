#include <gtest/gtest.h>

#include <random>

#include "contact/distance.hpp"

namespace valsalva::contact {
namespace {

using Four = std::array<Vec3, 4>;

Four random_four(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Four x;
  for (Vec3& p : x) p = Vec3(unit(random), unit(random), unit(random));
  return x;
}
double of_point(const Four& x) {
  return point_triangle(x[0], x[1], x[2], x[3]).distance;
}
double of_edges(const Four& x) {
  return edge_edge(x[0], x[1], x[2], x[3]).distance;
}

double sampled_triangle_distance(const Four& x) {
  double least = 1e9;
  constexpr int n = 200;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const double u = double(i) / n, v = double(j) / n;
      least = std::min(least, (x[0] - ((1 - u - v) * x[1] + u * x[2] + v * x[3])).norm());
    }
  return least;
}

TEST(Distance, PointTriangleIsTheLeastOverAllSamples) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Four x = random_four(random);
    const double d = of_point(x);
    EXPECT_LE(d, sampled_triangle_distance(x) + 1e-12);
    EXPECT_NEAR(d, sampled_triangle_distance(x), 2e-2);
  }
}

TEST(Distance, EdgeEdgeIsTheLeastOverAllSamples) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const Four x = random_four(random);
    double least = 1e9;
    for (int i = 0; i <= 200; ++i)
      for (int j = 0; j <= 200; ++j)
        least = std::min(least, (x[0] + i / 200.0 * (x[1] - x[0]) - x[2] - j / 200.0 * (x[3] - x[2])).norm());
    EXPECT_LE(of_edges(x), least + 1e-12);
    EXPECT_NEAR(of_edges(x), least, 2e-2);
  }
}

TEST(Distance, WeightsReproduceTheDistance) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Four x = random_four(random);
    for (const Nearest& n : {point_triangle(x[0], x[1], x[2], x[3]), edge_edge(x[0], x[1], x[2], x[3])}) {
      Vec3 sum = Vec3::Zero();
      double total = 0;
      for (int k = 0; k < 4; ++k) {
        sum += n.weight[k] * x[k];
        total += n.weight[k];
      }
      EXPECT_NEAR(total, 0, 1e-14);
      EXPECT_NEAR((sum - n.distance * n.direction).norm(), 0, 1e-14);
    }
  }
}

// The error of a central difference falls by 4 when its step is halved; round-off ends that at about 1e-10.
template <class Distance>
void expect_second_order(const Four& x, const Nearest& near, Distance&& distance) {
  std::array<double, 2> error{};
  for (int level = 0; level < 2; ++level) {
    const double h = level == 0 ? 2e-3 : 1e-3;
    for (int k = 0; k < 4; ++k)
      for (int d = 0; d < 3; ++d) {
        Four high = x, low = x;
        high[k][d] += h;
        low[k][d] -= h;
        const double slope = (distance(high) - distance(low)) / (2 * h);
        error[level] = std::max(error[level], std::abs(slope - near.weight[k] * near.direction[d]));
      }
  }
  EXPECT_LT(error[1], 1e-4);
  if (error[1] > 1e-9) EXPECT_NEAR(error[0] / error[1], 4, 0.2);
}

TEST(Distance, GradientOfPointTriangleInEveryRegion) {
  const Vec3 a(0, 0, 0), b(1, 0.1, 0), c(0.2, 1, 0.1);
  for (const Vec3& p :
       {Vec3(0.4, 0.3, 0.3), Vec3(0.5, -0.4, 0.2), Vec3(-0.3, -0.4, 0.2), Vec3(1.4, 0.1, -0.2),
        Vec3(0.9, 0.9, 0.2), Vec3(-0.4, 0.5, 0.3), Vec3(0.2, 1.5, -0.1)})
    expect_second_order({p, a, b, c}, point_triangle(p, a, b, c), of_point);
}

TEST(Distance, GradientOfEdgeEdgeInsideAndAtEnds) {
  const Vec3 a0(0, 0, 0), a1(1, 0, 0.05);
  for (const auto& [b0, b1] : {std::pair{Vec3(0.5, -0.5, 0.3), Vec3(0.4, 0.6, 0.2)},
                               std::pair{Vec3(1.3, -0.5, 0.3), Vec3(1.4, 0.6, 0.2)},
                               std::pair{Vec3(0.3, 0.3, 0.3), Vec3(0.2, 1.2, 0.2)},
                               std::pair{Vec3(1.3, 0.3, 0.3), Vec3(1.5, 1.2, 0.2)}})
    expect_second_order({a0, a1, b0, b1}, edge_edge(a0, a1, b0, b1), of_edges);
}

TEST(Distance, ParallelEdgesHaveTheDistanceOfTheirLines) {
  EXPECT_NEAR(edge_edge({0, 0, 0}, {1, 0, 0}, {0.3, 0.2, 0}, {1.4, 0.2, 0}).distance, 0.2, 1e-15);
  EXPECT_NEAR(edge_edge({0, 0, 0}, {1, 0, 0}, {3, 0, 0}, {2, 0, 0}).distance, 1, 1e-15);
}

TEST(Distance, FeaturesThatMeetHaveAUnitDirection) {
  EXPECT_NEAR(point_triangle({0.2, 0.2, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}).direction.norm(), 1, 1e-15);
  EXPECT_NEAR(edge_edge({0, 0, 0}, {1, 0, 0}, {0.5, -1, 0}, {0.5, 1, 0}).direction.norm(), 1, 1e-15);
}

}  // namespace
}  // namespace valsalva::contact
