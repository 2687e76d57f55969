#include <gtest/gtest.h>

#include <random>

#include "coupling/repulsion.hpp"
#include "coupling/standoff.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::coupling;

struct Cloud {
  Points x, start;  // far apart at the start
  std::vector<int> group;
  std::vector<double> area;
};

/// Repulsion with its own search.
struct Pushing {
  NearPairs near;
  Repulsion law;
  Pushing(const RepulsionParameters& parameters, const Points& rest, const Points& start,
          const std::vector<int>& group, const std::vector<double>& area)
      : near(parameters.range_mm, rest, start, group), law(parameters, area) {}
  double add_forces(const Points& x, Points& force) { return law.add_forces(x, near.find(x), force); }
};

Cloud cloud() {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 3);
  Cloud c;
  for (int a = 0; a < 150; ++a) {
    c.x.emplace_back(unit(random), unit(random), unit(random));
    c.start.emplace_back(a, 0, 0);
    c.group.push_back(a % 4 - 1);
    c.area.push_back(0.1 + 0.05 * unit(random));
  }
  return c;
}

TEST(Repulsion, IsTheGradientOfItsEnergyAndBalanced) {
  const Cloud c = cloud();
  Pushing repulsion({2e4, 0.7}, c.start, c.start, c.group, c.area);
  Points force(c.x.size(), Vec3::Zero());
  EXPECT_GT(repulsion.add_forces(c.x, force), 0);
  Vec3 total = Vec3::Zero();
  for (const Vec3& f : force) total += f;
  EXPECT_LT(total.norm(), 1e-8);
  for (int a : {1, 17, 58, 101})
    for (int d = 0; d < 3; ++d) {
      const double e = 1e-6;
      Points plus = c.x, minus = c.x, ignored(c.x.size(), Vec3::Zero());
      plus[a][d] += e;
      minus[a][d] -= e;
      const double slope =
          (repulsion.add_forces(plus, ignored) - repulsion.add_forces(minus, ignored)) / (2 * e);
      EXPECT_NEAR(force[a][d], -slope, 1e-4 * (1 + std::abs(slope)));
    }
}

TEST(Repulsion, TangentIsSymmetricAndBoundsTheSlopeAlongEachPair) {
  const Cloud c = cloud();
  Pushing repulsion({2e4, 0.7}, c.start, c.start, c.group, c.area);
  Points ignored(c.x.size(), Vec3::Zero()), y(c.x.size()), z(c.x.size());
  repulsion.add_forces(c.x, ignored);
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  for (std::size_t a = 0; a < y.size(); ++a) {
    y[a] = Vec3(normal(random), normal(random), normal(random));
    z[a] = Vec3(normal(random), normal(random), normal(random));
  }
  Points ky(y.size(), Vec3::Zero()), kz = ky;
  repulsion.law.add_tangent_product(y, ky);
  repulsion.law.add_tangent_product(z, kz);
  double yz = 0, zy = 0, yy = 0, slope = 0;
  const double e = 1e-6;
  Points plus = c.x, minus = c.x, up = ignored, down = ignored;
  for (std::size_t a = 0; a < y.size(); ++a) {
    yz += z[a].dot(ky[a]);
    zy += y[a].dot(kz[a]);
    yy += y[a].dot(ky[a]);
    plus[a] += e * y[a];
    minus[a] -= e * y[a];
  }
  repulsion.add_forces(plus, up);
  repulsion.add_forces(minus, down);
  for (std::size_t a = 0; a < y.size(); ++a) slope -= y[a].dot(up[a] - down[a]) / (2 * e);
  EXPECT_NEAR(yz, zy, 1e-9 * std::abs(yz));
  EXPECT_GT(yy, 0);
  EXPECT_GE(yy, slope);
}

TEST(Repulsion, FindsEveryPair) {
  const Cloud c = cloud();
  Pushing repulsion({1e4, 0.5}, c.start, c.start, c.group, c.area);
  Points force(c.x.size(), Vec3::Zero()), expected = force;
  repulsion.add_forces(c.x, force);
  double nearest = 0.5;
  for (std::size_t a = 0; a < c.x.size(); ++a)
    for (std::size_t b = 0; b < c.x.size(); ++b) {
      const Vec3 apart = c.x[a] - c.x[b];
      if (a == b || c.group[a] < 0 || c.group[b] < 0 || c.group[a] == c.group[b] || apart.norm() >= 0.5)
        continue;
      expected[a] +=
          3e4 / (M_PI * 0.25) * c.area[a] * c.area[b] * (1 - apart.norm() / 0.5) * apart.normalized();
      nearest = std::min(nearest, apart.norm());
    }
  for (std::size_t a = 0; a < c.x.size(); ++a) EXPECT_LT((force[a] - expected[a]).norm(), 1e-8);
  EXPECT_DOUBLE_EQ(repulsion.law.nearest(), nearest);
}

TEST(Repulsion, LeavesOneLeafletAlone) {
  const Cloud c = cloud();
  Pushing repulsion({1e4, 0.5}, c.start, c.start, std::vector<int>(c.x.size(), 0), c.area);
  Points force(c.x.size(), Vec3::Zero());
  EXPECT_EQ(repulsion.add_forces(c.x, force), 0);
  EXPECT_EQ(repulsion.law.nearest(), 0.5);
}

TEST(Repulsion, NeighboursAtTheStartDoNotPush) {
  const Cloud c = cloud();
  Pushing repulsion({1e4, 0.5}, c.x, c.x, c.group, c.area);
  Points force(c.x.size(), Vec3::Zero());
  EXPECT_EQ(repulsion.add_forces(c.x, force), 0);
}

TEST(Repulsion, RangesGrowFromTheDistanceOfTheStart) {
  const Points rest{{0, 0, 0}, {5, 0, 0}}, start{{0, 0, 0}, {0.1, 0, 0}};
  Pushing repulsion({1e4, 0.5}, rest, start, {0, 1}, {1, 1});
  const auto push = [&](double growth) {
    Points force(2, Vec3::Zero());
    repulsion.law.set_growth(growth);
    repulsion.add_forces(start, force);
    EXPECT_EQ(force[0], Vec3(-force[1]));
    return force[1].x();
  };
  EXPECT_EQ(push(0), 0);
  EXPECT_NEAR(push(0.5), 3e4 / (M_PI * 0.25) * (1 - 0.1 / 0.3), 1e-9);
  EXPECT_NEAR(push(1), 3e4 / (M_PI * 0.25) * (1 - 0.1 / 0.5), 1e-9);
}

TEST(Repulsion, SheetsPushWithThePressureOfTheHeaderOnAnyMesh) {
  const double p = 1e4, r = 1, D = 0.3;
  for (const double spacing : {0.2, 0.1}) {
    Points x;
    std::vector<int> group;
    const int n = static_cast<int>(std::lround(4 / spacing));
    for (int sheet = 0; sheet < 2; ++sheet)
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
          x.emplace_back(i * spacing, j * spacing, sheet * D);
          group.push_back(sheet);
        }
    Points far = x;
    for (std::size_t a = 0; a < x.size(); ++a) far[a].z() += 10 * group[a];
    const double area = spacing * spacing;
    Pushing repulsion({p, r}, far, far, group, std::vector<double>(x.size(), area));
    Points force(x.size(), Vec3::Zero());
    repulsion.add_forces(x, force);
    const int middle = (n / 2) * (n + 1) + n / 2;
    const double expected = -3 * p * D / r * (1 - D / r) * (1 - D / r);
    EXPECT_NEAR(force[middle].z() / area, expected, 0.03 * std::abs(expected)) << spacing;
  }
}

TEST(NearPairs, DoNotDependOnTheAgeOfTheList) {
  Cloud c = cloud();
  NearPairs aged(0.5, c.start, c.start, c.group);
  aged.find(c.x);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.02);
  for (int step = 0; step < 12; ++step) {
    for (Vec3& x : c.x) x += Vec3(normal(random), normal(random), normal(random));
    NearPairs fresh(0.5, c.start, c.start, c.group);
    const auto& one = aged.find(c.x);
    const auto& other = fresh.find(c.x);
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(one[i].a, other[i].a);
      EXPECT_EQ(one[i].b, other[i].b);
      EXPECT_EQ(one[i].distance_mm, other[i].distance_mm);
    }
  }
}

TEST(Standoff, SheetsCoupleAsFarApartAsItSays) {
  Points x;
  std::vector<int> group;
  for (int sheet = 0; sheet < 2; ++sheet)
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; j <= 20; ++j) {
        x.emplace_back(0.2 * i, 0.2 * j, 0.1 * sheet);
        group.push_back(sheet);
      }
  Points far = x, y;
  for (std::size_t a = 0; a < x.size(); ++a) far[a].z() += 10 * group[a];
  const Points up(x.size(), Vec3::UnitZ());
  NearPairs near(1.3, far, far, group);
  stand_off(1.3, x, up, near.find(x), y);
  for (std::size_t a = 0; a < 441; ++a) {
    EXPECT_NEAR(y[a + 441].z() - y[a].z(), 1.3, 1e-12);
    EXPECT_NEAR(y[a + 441].z() + y[a].z(), 0.1, 1e-12);
  }
  stand_off(0, x, up, near.find(x), y);
  EXPECT_EQ(y, x);
  NearPairs neighbours(1.3, x, x, group);  // near at rest: they stay where they are
  stand_off(1.3, x, up, neighbours.find(x), y);
  for (std::size_t a = 0; a < 441; ++a) EXPECT_LT((y[a] - x[a]).norm(), 1.3);
}

}  // namespace
