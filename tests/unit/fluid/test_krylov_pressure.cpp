// The pressure of chosen cells: against the direct solver, a manufactured solution, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "expect_error.hpp"
#include "fluid/krylov_pressure.hpp"
#include "fluid/openings.hpp"
#include "fluid/poisson.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

using Values = std::vector<double>;

Values solved(PressureSolver& solver, const Slab& slab, const Values& b) {
  const int nx = slab.grid.cells[0], ny = slab.grid.cells[1], nz = slab.grid.cells[2];
  Field phi(slab);
  solver.solve(
      [&](int k, const CellRows& rows) {
        for (int j = 0; j < ny; ++j) std::copy_n(b.data() + (k * ny + j) * nx, nx, rows.row(j));
      },
      phi);
  Values values;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) values.insert(values.end(), phi.row(j, k), phi.row(j, k) + nx);
  }
  return values;
}

// Conductances of a box without solids.
void open_box(const Slab& slab, const Boundaries& boundaries, FaceField& conductance, Field& known) {
  const auto& n = slab.grid.cells;
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < n[2]; ++k) {
      for (int j = 0; j < n[1]; ++j) {
        for (int i = 0; i < n[0]; ++i)
          conductance[d](i, j, k) = (d == 0 ? i : d == 1 ? j : k) > 0 || boundaries.periodic(d) ? 1 : 0;
      }
    }
  }
  for (int j = 0; j < n[1]; ++j) {
    for (int i = 0; i < n[0]; ++i) {
      if (boundaries.end(End::low) == Side::open) known(i, j, 0) += 2;
      if (boundaries.end(End::high) == Side::open) known(i, j, n[2] - 1) += 2;
    }
  }
}

}  // namespace

TEST(KrylovPressure, GivesWhatTheDirectSolverGives) {
  using enum Side;
  const std::array<std::array<std::array<Side, 2>, 3>, 4> kinds{{
      {{{slip, slip}, {wall, wall}, {open, open}}},
      {{{periodic, periodic}, {slip, slip}, {inflow, open}}},
      {{{wall, wall}, {wall, wall}, {wall, wall}}},
      {{{periodic, periodic}, {periodic, periodic}, {periodic, periodic}}},
  }};
  using Preconditioner = KrylovSettings::Preconditioner;
  for (const auto& kind : kinds) {
    for (const Preconditioner preconditioner : {Preconditioner::multigrid, Preconditioner::aggregation}) {
      Grid grid;
      grid.cells = {14, 11, 17};
      grid.h = 0.3;
      Boundaries boundaries;
      boundaries.side = kind;
      const Slab slab(MPI_COMM_SELF, grid, boundaries.periodic(2));
      std::mt19937 random(1);
      std::uniform_real_distribution<double> uniform(-1, 1);
      Values b(grid.all_cells());
      for (double& value : b) value = uniform(random);

      Poisson direct(slab, boundaries);
      KrylovPressure krylov(slab, boundaries, {.tolerance = 1e-12, .preconditioner = preconditioner});
      FaceField conductance(slab);
      Field known(slab);
      open_box(slab, boundaries, conductance, known);
      krylov.build(conductance, known);
      const Values exact = solved(direct, slab, b), found = solved(krylov, slab, b);
      double largest = 0, difference = 0;
      for (std::size_t c = 0; c < b.size(); ++c) {
        largest = std::max(largest, std::abs(exact[c]));
        difference = std::max(difference, std::abs(exact[c] - found[c]));
      }
      EXPECT_LT(difference, 1e-9 * largest);
      // From its own solution on there is nothing left to do.
      krylov.set_floor(1e-9);
      EXPECT_EQ(solved(krylov, slab, b), found);
      EXPECT_EQ(krylov.iterations(), 0);
    }
  }
}

// phi = s psi, s the height over an oblique plane of known pressure; Neumann on the sides of the box.
TEST(KrylovPressure, IsOfSecondOrderAtAnObliquePlane) {
  const Vec3 normal = Vec3(0.5, 0.3, 1).normalized(), centre(0.5, 0.5, 1);
  const auto height = [&](const Vec3& x) { return (x - centre).dot(normal); };
  const auto psi = [](const Vec3& x) { return 1 + 0.3 * std::sin(2 * x[0] + x[1]) * std::cos(x[2]); };
  const auto slope = [](const Vec3& x) {
    const double c = 0.3 * std::cos(2 * x[0] + x[1]) * std::cos(x[2]);
    return Vec3(2 * c, c, -0.3 * std::sin(2 * x[0] + x[1]) * std::sin(x[2]));
  };
  const auto gradient = [&](const Vec3& x) { return Vec3(psi(x) * normal + height(x) * slope(x)); };
  const auto laplacian = [&](const Vec3& x) {
    return 2 * normal.dot(slope(x)) - 6 * (psi(x) - 1) * height(x);
  };
  std::vector<double> errors;
  std::vector<int> iterations;
  for (const int n : {12, 24, 48}) {
    Grid grid;
    grid.cells = {n, n, 2 * n};
    grid.h = 1.0 / n;
    Boundaries boundaries;
    boundaries.side[2] = {Side::slip, Side::slip};
    const Slab slab(MPI_COMM_SELF, grid, false);
    Solids solids(slab, 1);
    Openings openings(slab, 0);
    openings.add({.name = "top", .centre = centre, .normal = normal, .profile = {}});
    openings.build(solids);
    FaceField conductance(slab);
    Field known(slab);
    open_box(slab, boundaries, conductance, known);
    for (int d = 0; d < 3; ++d)
      for (int k = 0; k < 2 * n; ++k)
        for (int j = 0; j < n; ++j)
          for (int i = 0; i < n; ++i)
            if (solids.owner(d, i, j, k) != 0) conductance[d](i, j, k) = 0;
    openings.apply(conductance, known);
    KrylovPressure krylov(slab, boundaries, {.tolerance = 1e-11});
    krylov.build(conductance, known, true);
    Values b;
    for (int k = 0; k < 2 * n; ++k) {
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          b.push_back(laplacian(grid.position(3, i, j, k)));
          const std::array<int, 3> at{i, j, k};
          for (int d = 0; d < 3; ++d) {
            for (int up = 0; up < 2; ++up) {
              if (at[d] != (up ? grid.cells[d] - 1 : 0)) continue;
              const Vec3 x = grid.position(3, i, j, k) + (up - 0.5) * grid.h * Vec3::Unit(d);
              b.back() -= (up ? 1 : -1) * gradient(x)[d] / grid.h;
            }
          }
        }
      }
    }
    const Values phi = solved(krylov, slab, b);
    double largest = 0, count = 0;
    for (int k = 0; k < 2 * n; ++k) {
      for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
          if (!krylov.solves(i, j, k)) continue;
          const Vec3 x = grid.position(3, i, j, k);
          largest = std::max(largest, std::abs(phi[(k * n + j) * n + i] - height(x) * psi(x)));
          count += 1;
        }
      }
    }
    EXPECT_EQ(count, krylov.unknowns());
    errors.push_back(largest);
    iterations.push_back(krylov.iterations());
    std::printf("n = %d: %.0f unknowns, largest error %.3g, %d iterations\n", n, count, largest,
                krylov.iterations());
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.8);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.8);
  EXPECT_LE(iterations[2], iterations[0] + 6);
}

TEST(KrylovPressure, NamesThePlaceWhereItFails) {
  Grid grid;
  grid.cells = {16, 16, 16};
  Boundaries boundaries;
  const Slab slab(MPI_COMM_SELF, grid, false);
  KrylovPressure krylov(slab, boundaries, {.tolerance = 1e-13, .most_iterations = 2});
  FaceField conductance(slab);
  Field known(slab);
  open_box(slab, boundaries, conductance, known);
  krylov.build(conductance, known);
  Values b(grid.all_cells(), 0.0);
  b[5] = 1;
  test::expect_error(ExitCode::numerical, {"2 iterations", "mm", "pressure_tolerance"},
                     [&] { solved(krylov, slab, b); });
}
