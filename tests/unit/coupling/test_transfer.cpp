#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <random>

#include "core/errors.hpp"
#include "core/mpi.hpp"
#include "coupling/transfer.hpp"
#include "mpi_for_all.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::coupling;

fluid::Grid small_grid() {
  return {{13, 11, 15}, Vec3(-5.0, 1.0, -3.0), 0.8};
}

Points random_points(const fluid::Grid& grid, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Points points(count);
  for (Vec3& p : points)
    for (int d = 0; d < 3; ++d) p[d] = grid.origin[d] + grid.h * (2 + unit(random) * (grid.cells[d] - 4));
  return points;
}

Points random_vectors(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Points points(count);
  for (Vec3& p : points) p = Vec3(normal(random), normal(random), normal(random));
  return points;
}

template <class Visit>
void for_owned_faces(const fluid::Slab& slab, Visit&& visit) {
  for (int d = 0; d < 3; ++d)
    for (int k = 0; k < (d == 2 ? slab.w_planes() : slab.planes); ++k)
      for (int j = 0; j < slab.grid.cells[1] + (d == 1); ++j)
        for (int i = 0; i < slab.grid.cells[0] + (d == 0); ++i) visit(d, i, j, k);
}

class TransferOfEveryKernel : public testing::TestWithParam<std::string> {};

TEST_P(TransferOfEveryKernel, SpreadingAndInterpolationAreAdjoint) {
  const fluid::Slab slab(MPI_COMM_SELF, small_grid(), false);
  Transfer transfer(slab, kernel_from(GetParam()));
  transfer.locate(random_points(slab.grid, 200, 1));
  const Points force = random_vectors(200, 2);
  fluid::FaceField velocity(slab), density(slab);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for_owned_faces(slab, [&](int d, int i, int j, int k) { velocity[d](i, j, k) = normal(random); });
  transfer.spread(force, density);
  Points interpolated;
  transfer.interpolate(velocity, interpolated);
  double on_grid = 0, at_nodes = 0, size = 0;
  for_owned_faces(slab, [&](int d, int i, int j, int k) {
    on_grid += std::pow(slab.grid.h, 3) * density[d](i, j, k) * velocity[d](i, j, k);
    size += std::abs(std::pow(slab.grid.h, 3) * density[d](i, j, k) * velocity[d](i, j, k));
  });
  for (int a = 0; a < 200; ++a) at_nodes += force[a].dot(interpolated[a]);
  EXPECT_NEAR(on_grid, at_nodes, 1e-14 * size);
}

TEST_P(TransferOfEveryKernel, SpreadingKeepsForceAndTorque) {
  const fluid::Slab slab(MPI_COMM_SELF, small_grid(), false);
  Transfer transfer(slab, kernel_from(GetParam()));
  const Points x = random_points(slab.grid, 50, 4), force = random_vectors(50, 5);
  transfer.locate(x);
  fluid::FaceField density(slab);
  transfer.spread(force, density);
  Vec3 total = Vec3::Zero(), torque = Vec3::Zero();
  for_owned_faces(slab, [&](int d, int i, int j, int k) {
    const Vec3 f = std::pow(slab.grid.h, 3) * density[d](i, j, k) * Vec3::Unit(d);
    total += f;
    torque += slab.grid.position(d, i, j, k).cross(f);
  });
  for (int a = 0; a < 50; ++a) {
    total -= force[a];
    torque -= x[a].cross(force[a]);
  }
  EXPECT_LT(total.norm(), 1e-11);
  EXPECT_LT(torque.norm(), 1e-10);
}

TEST_P(TransferOfEveryKernel, LinearVelocityIsInterpolatedExactly) {
  const fluid::Slab slab(MPI_COMM_SELF, small_grid(), false);
  Transfer transfer(slab, kernel_from(GetParam()));
  const Points x = random_points(slab.grid, 100, 6);
  transfer.locate(x);
  Mat3 gradient;
  gradient << 1, 2, -3, 0.5, -1.5, 2, 4, -2, 0.25;
  fluid::FaceField velocity(slab);
  for_owned_faces(slab, [&](int d, int i, int j, int k) {
    velocity[d](i, j, k) = (gradient * slab.grid.position(d, i, j, k))[d] + 7;
  });
  Points interpolated;
  transfer.interpolate(velocity, interpolated);
  for (int a = 0; a < 100; ++a)
    EXPECT_LT((interpolated[a] - gradient * x[a] - Vec3::Constant(7)).norm(), 1e-12);
}

// Nodes up to the sides, beyond which the velocity goes on as its image.
TEST_P(TransferOfEveryKernel, UpToSlipSidesAndWallsItIsAdjointAndExact) {
  const fluid::Slab slab(MPI_COMM_SELF, small_grid(), false);
  const fluid::Grid& grid = slab.grid;
  const Surroundings beyond{
      {{Beyond::slip, Beyond::wall}, {Beyond::wall, Beyond::slip}, {Beyond::wall, Beyond::slip}}};
  Transfer transfer(slab, kernel_from(GetParam()), {}, beyond);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  Points x(300);
  for (Vec3& p : x)
    for (int d = 0; d < 3; ++d) {
      const double place = unit(random) < 0.3 ? 1.5 * unit(random) : unit(random) * grid.cells[d];
      p[d] = grid.origin[d] + grid.h * (unit(random) < 0.3 ? grid.cells[d] - place : place);
    }
  x[0] = grid.low();
  x[1] = grid.high();
  transfer.locate(x);
  const Points force = random_vectors(300, 12);
  fluid::FaceField velocity(slab), density(slab);
  const auto on_side = [&](int d, int i, int j, int k) {
    const int at = std::array{i, j, k}[d];
    return at == 0 || at == grid.cells[d];
  };
  for_owned_faces(slab, [&](int d, int i, int j, int k) {
    velocity[d](i, j, k) = on_side(d, i, j, k) ? 0 : normal(random);
  });
  transfer.spread(force, density);
  Points interpolated;
  transfer.interpolate(velocity, interpolated);
  double on_grid = 0, at_nodes = 0, size = 0;
  for_owned_faces(slab, [&](int d, int i, int j, int k) {
    const double part = std::pow(grid.h, 3) * density[d](i, j, k) * velocity[d](i, j, k);
    on_grid += part;
    size += std::abs(part);
    if (on_side(d, i, j, k)) {
      EXPECT_EQ(density[d](i, j, k), 0);
    }
  });
  for (int a = 0; a < 300; ++a) at_nodes += force[a].dot(interpolated[a]);
  EXPECT_NEAR(on_grid, at_nodes, 1e-14 * size);

  // u = y above the wall y low (x: away from the wall there), w = -(z - top) below the slip side z high.
  const double top = grid.high()[2], bottom = grid.low()[1];
  velocity.fill(0);
  for_owned_faces(slab, [&](int d, int i, int j, int k) {
    const Vec3 at = grid.position(d, i, j, k);
    if (d == 0) velocity[0](i, j, k) = at[1] - bottom;
    if (d == 2) velocity[2](i, j, k) = top - at[2];
  });
  const Vec3 middle = 0.5 * (grid.low() + grid.high());
  const Points near{{middle[0], bottom + 0.3 * grid.h, middle[2]},
                    {middle[0], middle[1], top - 0.6 * grid.h}};
  transfer.locate(near);
  transfer.interpolate(velocity, interpolated);
  EXPECT_NEAR(interpolated[0][0], 0.3 * grid.h, 1e-12);
  EXPECT_NEAR(interpolated[1][2], 0.6 * grid.h, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(Kernels, TransferOfEveryKernel, testing::ValuesIn(kernel_names()));

// The composite kernels were made for this: the divergence of the interpolated field (linear in the normal
// derivative) vanishes where the discrete one does.
double interpolated_divergence(const std::string& kernel) {
  const fluid::Slab slab(MPI_COMM_SELF, small_grid(), false);
  const fluid::Grid& grid = slab.grid;
  fluid::FaceField velocity(slab);
  // Discretely divergence-free: the discrete curl of a potential on edges along z.
  auto potential = [&](int i, int j) { return std::sin(1.3 * i) * std::cos(0.9 * j + 0.2); };
  for_owned_faces(slab, [&](int d, int i, int j, int k) {
    if (d == 0) velocity[0](i, j, k) = potential(i, j + 1) - potential(i, j);
    if (d == 1) velocity[1](i, j, k) = -(potential(i + 1, j) - potential(i, j));
  });
  Transfer transfer(slab, kernel_from(kernel));
  const double e = 1e-5 * grid.h;
  const Points centres = random_points({grid.cells, grid.origin, grid.h}, 40, 8);
  double worst = 0;
  for (const Vec3& centre : centres) {
    const Vec3 c = centre.cwiseMax(grid.low() + Vec3::Constant(2.1 * grid.h))
                       .cwiseMin(grid.high() - Vec3::Constant(2.1 * grid.h));
    Points around;
    for (int d = 0; d < 3; ++d)
      for (double sign : {1.0, -1.0}) around.push_back(c + sign * e * Vec3::Unit(d));
    transfer.locate(around);
    Points u;
    transfer.interpolate(velocity, u);
    double divergence = 0;
    for (int d = 0; d < 3; ++d) divergence += (u[2 * d][d] - u[2 * d + 1][d]) / (2 * e);
    worst = std::max(worst, std::abs(divergence));
  }
  return worst;
}

TEST(Transfer, CompositeKernelsInterpolateDivergenceFree) {
  EXPECT_LT(interpolated_divergence("cbs32"), 1e-8);
  EXPECT_LT(interpolated_divergence("cbs43"), 1e-8);
  EXPECT_GT(interpolated_divergence("ib4"), 1e-3);
}

TEST(Transfer, ANodeThatLeavesTheBoxIsAFailure) {
  const fluid::Slab slab(MPI_COMM_SELF, small_grid(), false);
  Transfer transfer(slab, kernel_from("ib4"));
  EXPECT_THROW(transfer.locate({slab.grid.origin + Vec3(1, 5, 5)}), NumericalFailure);
  EXPECT_THROW(transfer.locate({Vec3(std::nan(""), 5, 5)}), NumericalFailure);
}

}  // namespace
