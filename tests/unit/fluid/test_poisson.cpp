// The pressure solve against the operator it inverts, for every combination of sides.
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <random>

#include "fluid/poisson.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

struct Sides {
  const char* name;
  Side x, y, low, high;
};

void PrintTo(const Sides& sides, std::ostream* out) {
  *out << sides.name;
}

class PoissonSides : public testing::TestWithParam<Sides> {};

TEST_P(PoissonSides, LaplacianOfTheSolutionIsTheRightHandSide) {
  const Sides& sides = GetParam();
  Grid grid;
  grid.cells = {7, 6, 9};
  grid.h = 0.3;
  Boundaries boundaries;
  boundaries.side = {{{sides.x, sides.x}, {sides.y, sides.y}, {sides.low, sides.high}}};
  const Slab slab(MPI_COMM_SELF, grid, boundaries.periodic(2));

  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<double> b(grid.all_cells());
  double mean = 0;
  for (double& value : b) mean += (value = uniform(random)) / b.size();
  const bool free_mean = sides.low != Side::open && sides.high != Side::open;
  if (free_mean) {
    for (double& value : b) value -= mean;
  }

  Field phi(slab);
  Poisson poisson(slab, boundaries);
  const std::size_t plane_cells = grid.plane_cells();
  const int nx = grid.cells[0];
  poisson.solve(
      [&](int k, const CellRows& rows) {
        for (int j = 0; j < grid.cells[1]; ++j)
          std::copy_n(b.data() + k * plane_cells + j * nx, nx, rows.row(j));
      },
      phi);
  fill_pressure_ghosts(slab, boundaries, phi, {0, 0});
  double worst = 0, sum = 0;
  for (int k = 0; k < grid.cells[2]; ++k) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        const double laplacian = (phi(i + 1, j, k) + phi(i - 1, j, k) + phi(i, j + 1, k) + phi(i, j - 1, k) +
                                  phi(i, j, k + 1) + phi(i, j, k - 1) - 6 * phi(i, j, k)) /
                                 (grid.h * grid.h);
        worst = std::max(worst, std::abs(laplacian - b[k * plane_cells + j * grid.cells[0] + i]));
        sum += phi(i, j, k);
      }
    }
  }
  EXPECT_LT(worst, 1e-12);
  if (free_mean) {
    EXPECT_NEAR(sum, 0, 1e-11);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, PoissonSides,
    testing::Values(Sides{"tube", Side::slip, Side::slip, Side::open, Side::open},
                    Sides{"inflow", Side::wall, Side::slip, Side::inflow, Side::open},
                    Sides{"outflow_below", Side::wall, Side::wall, Side::open, Side::wall},
                    Sides{"closed", Side::wall, Side::wall, Side::wall, Side::wall},
                    Sides{"channel", Side::periodic, Side::wall, Side::open, Side::open},
                    Sides{"periodic", Side::periodic, Side::periodic, Side::periodic, Side::periodic},
                    Sides{"periodic_z", Side::wall, Side::periodic, Side::periodic, Side::periodic}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
