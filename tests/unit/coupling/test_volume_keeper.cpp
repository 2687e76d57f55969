#include "coupling/volume_keeper.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

namespace {

using namespace valsalva;
using namespace valsalva::coupling;

constexpr int per_edge = 4;  // cells
int node(int i, int j, int k) {
  return (k * (per_edge + 1) + j) * (per_edge + 1) + i;
}

struct Block {
  Points x;
  std::vector<Cell> cells;
  explicit Block(bool tetrahedra) {
    for (int k = 0; k <= per_edge; ++k)
      for (int j = 0; j <= per_edge; ++j)
        for (int i = 0; i <= per_edge; ++i) x.emplace_back(i, 0.7 * j, 1.2 * k);
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

class VolumesOfCells : public testing::TestWithParam<bool> {};

TEST_P(VolumesOfCells, ComeBackAndHeldNodesStay) {
  const Block block(GetParam());
  std::vector<Mat3> held(block.x.size(), Mat3::Zero());
  for (std::size_t a = 0; a < held.size(); ++a) {
    if (block.x[a][0] == 0) held[a] = Mat3::Identity();
    if (block.x[a][2] == 0) held[a](2, 2) = 1;
  }
  const VolumeKeeper keeper(block.cells, block.x, held);
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.02);
  Points x = block.x;
  for (std::size_t a = 0; a < x.size(); ++a) {
    const Vec3 by(normal(random), normal(random), normal(random));
    x[a] += by - held[a] * by;
  }
  const double before = keeper.largest_change(x);
  EXPECT_GT(before, 0.05);
  double last = before;
  for (int round = 0; round < 4; ++round) {
    for (int i = 0; i < 100; ++i) keeper.correct(1, x);
    EXPECT_LT(keeper.largest_change(x), last);
    last = keeper.largest_change(x);
  }
  EXPECT_LT(last, 0.05 * before);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_EQ((held[a] * (x[a] - block.x[a])).norm(), 0) << a;
}

TEST_P(VolumesOfCells, WhatKeepsThemIsLeftAlone) {
  const Block block(GetParam());
  const VolumeKeeper keeper(block.cells, block.x, {});
  const Eigen::AngleAxisd turn(0.8, Vec3(1, 2, 2).normalized());
  const Mat3 shear = (Mat3() << 1.25, 0.4, 0.1, 0, 0.8, 0.3, 0, 0, 1).finished();
  Points x;
  for (const Vec3& p : block.x) x.push_back(turn * (shear * p) + Vec3(3, -1, 2));
  Points after = x;
  keeper.correct(1, after);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_LT((after[a] - x[a]).norm(), 1e-13);
}

INSTANTIATE_TEST_SUITE_P(Shapes, VolumesOfCells, testing::Bool(),
                         [](const auto& info) { return info.param ? "tetrahedra" : "hexahedra"; });

TEST(VolumeKeeper, SheetsAndBeamsHaveNone) {
  const Points x{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  const std::vector<Cell> cells{{3, {0, 1, 2}}, {2, {0, 1}}};
  EXPECT_TRUE(VolumeKeeper(cells, x, {}).empty());
}

}  // namespace
