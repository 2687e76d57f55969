// Which faces are solid, and what penalisation does to them.
#include <gtest/gtest.h>

#include <cmath>

#include "core/errors.hpp"
#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

Grid box(int n) {
  Grid grid;
  grid.cells = {n, n, n};
  grid.h = 10.0 / n;
  grid.origin = Vec3::Constant(-5);
  return grid;
}

TEST(Solids, LumenHasTheAreaOfItsSection) {
  const Slab slab(MPI_COMM_SELF, box(80), false);
  Solids solids(slab, 1e-3);
  solids.set_lumen([](const Vec3& x) { return std::hypot(x[0], x[1]) - 4; });
  long open = 0;
  for (int j = 0; j < 80; ++j) {
    for (int i = 0; i < 80; ++i) open += solids.owner(2, i, j, 40) == 0;
  }
  const double exact = M_PI * 16;
  EXPECT_NEAR(open * slab.grid.h * slab.grid.h, exact, 0.01 * exact);
}

TEST(Solids, MarksWhatIsWithinTheRadiusAndNothingElse) {
  const Slab slab(MPI_COMM_SELF, box(20), false);
  Solids solids(slab, 1e-3);
  const Vec3 a(-2.1, -1.3, -0.4), b(2.7, -0.9, 0.3), c(0.2, 2.8, 1.9);
  const double radius = 0.7;
  const int body = solids.add_body("triangle");
  solids.mark_triangles(body, {a, b, c}, {{0, 1, 2}}, radius);
  // The distance again, by brute force over points of the triangle.
  for (int d = 0; d < 4; ++d) {
    for (int k = 0; k < 20; ++k) {
      for (int j = 0; j < 20; ++j) {
        for (int i = 0; i < 20; ++i) {
          const Vec3 x = slab.grid.position(d, i, j, k);
          double nearest = 1e30;
          constexpr int n = 60;
          for (int s = 0; s <= n; ++s) {
            for (int t = 0; s + t <= n; ++t) {
              nearest = std::min(nearest, (x - (a + (b - a) * s / n + (c - a) * t / n)).norm());
            }
          }
          const bool marked = solids.owner(d, i, j, k) == 1 + body;
          if (nearest < radius - 0.005) {
            EXPECT_TRUE(marked) << x.transpose();
          } else if (nearest > radius + 0.005) {
            EXPECT_FALSE(marked) << x.transpose();
          }
        }
      }
    }
  }
}

TEST(Solids, AFaceBelongsToItsFirstBodyAndIsFreedWithIt) {
  const Slab slab(MPI_COMM_SELF, box(20), false);
  Solids solids(slab, 1e-3);
  const int first = solids.add_body("first"), second = solids.add_body("second");
  const Points points{Vec3(-2, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0)};
  // A body's faces are counted by what an even acceleration takes.
  const double of_a_face = 1e-3 * std::pow(slab.grid.h, 3);
  const auto faces = [&](int body) {
    const auto even = [](const Vec3&) -> Vec3 { return Vec3::Ones(); };
    return std::lround(solids.inertia(body, even, Vec3::Zero())[0].sum() / of_a_face);
  };
  solids.mark_segments(first, points, {{0, 1}}, 0.6);
  const long alone = faces(first);
  EXPECT_GT(alone, 0);
  solids.mark_segments(second, points, {{1, 2}}, 0.6);
  EXPECT_EQ(faces(first), alone);
  const long shared = faces(second);
  solids.clear_body(first);
  EXPECT_EQ(faces(first), 0);
  solids.clear_body(second);
  solids.mark_segments(second, points, {{1, 2}}, 0.6);
  EXPECT_GT(faces(second), shared);
}

TEST(Solids, TooManyBodiesAreRefused) {
  const Slab slab(MPI_COMM_SELF, box(4), false);
  Solids solids(slab, 1e-3);
  for (int body = 1; body < 255; ++body) solids.add_body("b");
  EXPECT_THROW(solids.add_body("one too many"), InputError);
}

TEST(Solids, MovingBodyCarriesTheFluidAndFeelsItsMomentum) {
  // A body in a closed periodic box of fluid at rest: what momentum the fluid gains, the body has given.
  Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
  Flow flow(MPI_COMM_SELF, box(24), boundaries, {});
  const int body = flow.solids().add_body("sphere");
  flow.solids().mark_inside(
      body, [](const Vec3& x) { return x.norm() - 2; }, Vec3::Constant(-2), Vec3::Constant(2));
  flow.solids().set_motion(body, {Vec3(10, 0, -4), Vec3(0, 0, 3), Vec3::Zero()});
  const double dt = 2e-4;
  Vec3 given = Vec3::Zero();
  for (int step = 0; step < 50; ++step) {
    flow.step(dt);
    given -= dt * flow.solids().force_on(body);
  }
  EXPECT_LT((flow.momentum() - given).norm(), 1e-9 * given.norm());
  EXPECT_GT(given[0], 0);
  EXPECT_LT(given[2], 0);
  const Vec3 inside = flow.velocity_at({0.5, 0.5, 0.1});
  EXPECT_NEAR(inside[0], 10 - 1.5, 0.05);
  EXPECT_NEAR(inside[1], 1.5, 0.05);
  EXPECT_NEAR(inside[2], -4, 0.05);
}

TEST(Solids, ForceOnTheWallBalancesThePressureThatDrives) {
  // Steady flow in a tube between two pressures: the wall takes the whole driving force.
  Boundaries boundaries;
  boundaries.side[2] = {Side::periodic, Side::periodic};
  Grid grid = box(16);
  Flow flow(MPI_COMM_SELF, grid, boundaries, {});
  flow.solids().set_lumen([](const Vec3& x) { return std::hypot(x[0], x[1]) - 3; });
  const double gradient = 2;  // Pa/mm, on the fluid only
  double driving = 0;
  for (int k = 0; k < 16; ++k) {
    for (int j = 0; j < 16; ++j) {
      for (int i = 0; i < 16; ++i) {
        if (flow.solids().owner(2, i, j, k) != 0) continue;
        flow.force()[2](i, j, k) = gradient;
        driving += gradient * std::pow(grid.h, 3);
      }
    }
  }
  for (int step = 0; step < 1500; ++step) flow.step(4e-3);
  EXPECT_NEAR(flow.solids().force_on(Solids::wall)[2] / driving, 1, 1e-3);
}

}  // namespace
