#include "coupling/volume_keeper.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <functional>
#include <random>

namespace {

using namespace valsalva;
using namespace valsalva::coupling;

// 4 x 2.8 x 4.8 mm.
struct Block {
  Points x;
  std::vector<Cell> cells;
  explicit Block(bool tetrahedra, int per_edge = 4) {
    const double h = 4.0 / per_edge;
    const auto node = [per_edge](int i, int j, int k) {
      return (k * (per_edge + 1) + j) * (per_edge + 1) + i;
    };
    for (int k = 0; k <= per_edge; ++k)
      for (int j = 0; j <= per_edge; ++j)
        for (int i = 0; i <= per_edge; ++i) x.emplace_back(h * i, 0.7 * h * j, 1.2 * h * k);
    constexpr std::array<std::array<int, 4>, 6> parts{
        {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6}, {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}}};
    for (int k = 0; k < per_edge; ++k)
      for (int j = 0; j < per_edge; ++j)
        for (int i = 0; i < per_edge; ++i) {
          const std::array<int, 8> corner{
              node(i, j, k),     node(i + 1, j, k),     node(i + 1, j + 1, k),     node(i, j + 1, k),
              node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1), node(i, j + 1, k + 1)};
          if (!tetrahedra) {
            cells.push_back({8, corner});
            continue;
          }
          for (const auto& part : parts) {
            Cell cell{4, {}};
            for (int a = 0; a < 4; ++a) cell.nodes[a] = corner[part[a]];
            cells.push_back(cell);
          }
        }
  }
};

std::vector<Mat3> hold_sides(const Points& x) {
  std::vector<Mat3> held(x.size(), Mat3::Zero());
  for (std::size_t a = 0; a < held.size(); ++a) {
    if (x[a][0] == 0) held[a] = Mat3::Identity();
    if (x[a][2] == 0) held[a](2, 2) = 1;
  }
  return held;
}

Points random_points(std::size_t count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, size);
  Points out;
  for (std::size_t a = 0; a < count; ++a) out.emplace_back(normal(random), normal(random), normal(random));
  return out;
}

double product(const Points& f, const Points& u) {
  double sum = 0;
  for (std::size_t a = 0; a < u.size(); ++a) sum += f[a].dot(u[a]);
  return sum;
}

class VolumesOfCells : public testing::TestWithParam<bool> {};

TEST_P(VolumesOfCells, ComeBackAndHeldNodesStay) {
  const Block block(GetParam());
  const std::vector<Mat3> held = hold_sides(block.x);
  VolumeKeeper keeper(block.cells, block.x, held);
  const Points by = random_points(block.x.size(), 0.02, 1);
  Points x = block.x;
  for (std::size_t a = 0; a < x.size(); ++a) x[a] += by[a] - held[a] * by[a];
  EXPECT_GT(keeper.largest_change(x), 0.02);
  constexpr double dt = 0.1;
  double last = 1;
  for (int round = 0; round < 5; ++round) {  // Newton's method: the error squares
    keeper.update(x);
    Points u(x.size(), Vec3::Zero());
    keeper.constrain_velocity(u, dt);
    for (std::size_t a = 0; a < x.size(); ++a) x[a] += dt * u[a];
    const double now = keeper.largest_change(x);
    EXPECT_LT(now, std::max(0.5 * last, 1e-9));
    last = now;
  }
  EXPECT_LT(last, 1e-8);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_LT((held[a] * (x[a] - block.x[a])).norm(), 1e-15) << a;
}

TEST_P(VolumesOfCells, ConstrainedVelocityChangesNoneToFirstOrder) {
  const Block block(GetParam());
  const std::vector<Mat3> held = hold_sides(block.x);
  VolumeKeeper keeper(block.cells, block.x, held);
  Points u = random_points(block.x.size(), 1, 2);  // held nodes move too
  const Points before = u;
  const auto change = [&](double dt) {
    Points x = block.x;
    for (std::size_t a = 0; a < x.size(); ++a) x[a] += dt * u[a];
    return keeper.largest_change(x);
  };
  EXPECT_GT(change(1e-4), 1e-5);
  keeper.update(block.x);
  keeper.constrain_velocity(u);
  EXPECT_LT(change(1e-4), 1e-6);
  EXPECT_NEAR(change(2e-4) / change(1e-4), 4, 0.01);
  for (std::size_t a = 0; a < u.size(); ++a) EXPECT_LT((held[a] * (u[a] - before[a])).norm(), 1e-14) << a;
}

TEST_P(VolumesOfCells, ForcesDoTheWorkOfTheMotion) {
  const Block block(GetParam());
  const std::vector<Mat3> held = hold_sides(block.x);
  VolumeKeeper keeper(block.cells, block.x, held);
  keeper.update(block.x);
  const Points force = random_points(block.x.size(), 1, 3), velocity = random_points(block.x.size(), 1, 4);
  Points f = force, u = velocity;
  keeper.constrain_force(f);
  keeper.constrain_velocity(u);
  EXPECT_NEAR(product(f, velocity), product(force, u), 1e-10);
  EXPECT_GT(std::abs(product(force, velocity) - product(force, u)), 0.1);
}

TEST_P(VolumesOfCells, FreeBodiesKeepForceAndTorque) {
  const Block block(GetParam());
  VolumeKeeper keeper(block.cells, block.x, {});
  keeper.update(block.x);
  const Points force = random_points(block.x.size(), 1, 5);
  Points f = force;
  keeper.constrain_force(f);
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t a = 0; a < f.size(); ++a) {
    sum += f[a] - force[a];
    torque += block.x[a].cross(f[a] - force[a]);
  }
  EXPECT_LT(sum.norm(), 1e-11);
  EXPECT_LT(torque.norm(), 1e-11);
}

TEST_P(VolumesOfCells, WhatKeepsThemIsLeftAlone) {
  const Block block(GetParam());
  VolumeKeeper keeper(block.cells, block.x, {});
  const Eigen::AngleAxisd turn(0.8, Vec3(1, 2, 2).normalized());
  const Mat3 shear = (Mat3() << 1.25, 0.4, 0.1, 0, 0.8, 0.3, 0, 0, 1).finished();
  Points x, spin;
  for (const Vec3& p : block.x) {
    x.push_back(turn * (shear * p) + Vec3(3, -1, 2));
    spin.push_back(Vec3(0.3, -0.2, 0.9).cross(x.back()) + Vec3(1, 2, 3));
  }
  keeper.update(x);
  Points u = spin;
  keeper.constrain_velocity(u, 0.01);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_LT((u[a] - spin[a]).norm(), 1e-10);
}

TEST_P(VolumesOfCells, IterationsFindWhatFactorsDo) {
  const Block block(GetParam());
  const std::vector<Mat3> held = hold_sides(block.x);
  VolumeKeeper direct(block.cells, block.x, held), iterated(block.cells, block.x, held, 0);
  direct.update(block.x);
  iterated.update(block.x);
  Points u = random_points(block.x.size(), 1, 6), v = u, f = u, g = u;
  direct.constrain_velocity(u, 0.1);
  iterated.constrain_velocity(v, 0.1);
  direct.constrain_force(f);
  iterated.constrain_force(g);
  for (std::size_t a = 0; a < u.size(); ++a) {
    EXPECT_LT((u[a] - v[a]).norm(), 1e-7) << a;
    EXPECT_LT((f[a] - g[a]).norm(), 1e-7) << a;
  }
}

// Relative change of a velocity, or of the forces of a density (in the integral).
double lost(const Block& block, const std::function<Vec3(const Vec3&)>& field, bool as_force) {
  VolumeKeeper keeper(block.cells, block.x, {});
  keeper.update(block.x);
  const std::vector<double> measure = nodal_measures(block.cells, block.x);
  Points now;
  for (std::size_t a = 0; a < block.x.size(); ++a)
    now.push_back((as_force ? measure[a] : 1) * field(block.x[a] - Vec3(2, 1.4, 2.4)));
  const Points before = now;
  as_force ? keeper.constrain_force(now) : keeper.constrain_velocity(now);
  double change = 0, size = 0;
  for (std::size_t a = 0; a < now.size(); ++a) {
    const double weight = as_force ? 1 / measure[a] : measure[a];
    change += weight * (now[a] - before[a]).squaredNorm();
    size += weight * before[a].squaredNorm();
  }
  return std::sqrt(change / size);
}

Vec3 bend(const Vec3& p) {
  return Vec3(-p.x() * p.z(), 0, 0.5 * (p.x() * p.x() + p.z() * p.z()));
}
Vec3 twist(const Vec3& p) {
  return Vec3(0, -p.x() * p.z(), p.x() * p.y());
}
Vec3 wave(const Vec3& p) {
  return Vec3(std::sin(p.x()) * std::cos(p.z()), 0, -std::cos(p.x()) * std::sin(p.z()));
}

TEST_P(VolumesOfCells, BodiesStillBendAndTwist) {
  // No locking: what is left of motions that are free of divergence, and of forces with such a density.
  for (bool as_force : {false, true}) {
    EXPECT_LT(lost(Block(GetParam()), bend, as_force), 0.1) << as_force;
    EXPECT_LT(lost(Block(GetParam()), twist, as_force), 0.1) << as_force;
    EXPECT_LT(lost(
                  Block(GetParam()), [](const Vec3&) { return Vec3(1, -2, 3); }, as_force),
              1e-9)
        << as_force;
  }
}

TEST_P(VolumesOfCells, WhatIsFreeOfDivergencePassesWithOrderTwo) {
  for (bool as_force : {false, true}) {
    const double coarse = lost(Block(GetParam(), 4), wave, as_force),
                 fine = lost(Block(GetParam(), 8), wave, as_force);
    std::printf("%s: %.4f -> %.4f, order %.2f\n", as_force ? "force" : "velocity", coarse, fine,
                std::log2(coarse / fine));
    EXPECT_GT(std::log2(coarse / fine), 1.4);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, VolumesOfCells, testing::Bool(),
                         [](const auto& info) { return info.param ? "tetrahedra" : "hexahedra"; });

TEST(VolumeKeeper, SheetsAndBeamsHaveNone) {
  const Points x{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  const std::vector<Cell> cells{{3, {0, 1, 2}}, {2, {0, 1}}};
  EXPECT_TRUE(VolumeKeeper(cells, x, {}).empty());
}

}  // namespace
