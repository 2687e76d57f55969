#include "coupling/moving_walls.hpp"

#include <gtest/gtest.h>

#include "mpi_for_all.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::coupling;

class MovingWallsOfEveryKernel : public testing::TestWithParam<std::string> {};

// Couette flow between the wall y low, which moves along x with 3, and the wall y high, with 1 along z: nodes
// up to both take the fluid's velocity.
TEST_P(MovingWallsOfEveryKernel, CouetteFlowUpToTheWallsIsExact) {
  const fluid::Grid grid{{9, 6, 8}, Vec3(-5.0, 1.0, -3.0), 0.8};
  const fluid::Slab slab(MPI_COMM_SELF, grid, true);
  const std::array<bool, 3> periodic{true, false, true};
  const Surroundings beyond{{{}, {Beyond::wall, Beyond::wall}, {}}};
  MovingWalls::Velocities walls;
  for (auto& sides : walls) sides.fill(Vec3::Zero());
  walls[1] = {Vec3(3, 0, 0), Vec3(0, 0, 1)};
  const double low = grid.low()[1], high = grid.high()[1];
  const auto exact = [&](double y) {
    const double s = (y - low) / (high - low);
    return Vec3(3 * (1 - s), 0, s);
  };
  fluid::FaceField velocity(slab);
  for (int d : {0, 2})
    for (int k = 0; k < slab.planes; ++k)
      for (int j = 0; j < grid.cells[1]; ++j)
        for (int i = 0; i < grid.cells[0]; ++i) velocity[d](i, j, k) = exact(grid.position(d, i, j, k)[1])[d];
  Transfer transfer(slab, kernel_from(GetParam()), periodic, beyond);
  Points x;
  for (double y : {low, low + 0.1, low + 0.9, 3.4, high - 0.7, high - 0.3, high})
    x.emplace_back(-4.7, y, 2.9);
  transfer.locate(x);
  Points u;
  transfer.interpolate(velocity, u);
  const double without = (u.front() - exact(low)).norm();
  MovingWalls(grid, kernel_from(GetParam()), periodic, beyond).add(x, walls, u);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_LT((u[a] - exact(x[a][1])).norm(), 1e-12) << a;
  EXPECT_GT(without, 1);
}

// A fluid that moves along an edge of the box with both of its walls does so up to the edge.
TEST(MovingWalls, AlongAnEdgeBothWallsCountOnce) {
  const fluid::Grid grid{{8, 8, 8}, Vec3::Zero(), 1};
  const fluid::Slab slab(MPI_COMM_SELF, grid, false);
  Surroundings beyond{};
  beyond[1][1] = beyond[2][0] = Beyond::wall;
  MovingWalls::Velocities walls;
  for (auto& sides : walls) sides.fill(Vec3::Zero());
  walls[1][1] = walls[2][0] = Vec3(2, 0, 0);
  fluid::FaceField velocity(slab);
  velocity[0].fill(2);
  for (const std::string& kernel : kernel_names()) {
    Transfer transfer(slab, kernel_from(kernel), {}, beyond);
    const Points x{Vec3(4, 8, 4), Vec3(4, 8, 0), Vec3(4.3, 7.6, 0.2)};
    transfer.locate(x);
    Points u;
    transfer.interpolate(velocity, u);
    MovingWalls(grid, kernel_from(kernel), {}, beyond).add(x, walls, u);
    for (const Vec3& each : u) EXPECT_LT((each - Vec3(2, 0, 0)).norm(), 1e-13) << kernel;
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, MovingWallsOfEveryKernel, testing::ValuesIn(kernel_names()));

}  // namespace
