// The step: projection at round-off, balances, boundaries, restart.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

constexpr double pi = std::numbers::pi;

Boundaries boundaries_of(Side x, Side y, Side z) {
  Boundaries boundaries;
  boundaries.side = {{{x, x}, {y, y}, {z, z}}};
  return boundaries;
}

double tube(const Vec3& x) {
  return std::hypot(x[0], x[1]) - 4.2;
}

Grid tube_grid(int n) {
  Grid grid;
  grid.h = 10.0 / n;
  grid.cells = {n, n, 2 * n};
  grid.origin = Vec3(-5, -5, -10);
  return grid;
}

// A field that is neither divergence-free nor symmetric.
double rough(int d, const Vec3& x) {
  return 40 * std::sin(1.3 * x[(d + 1) % 3] + d) * std::cos(0.7 * x[d] - 0.4 * d);
}

TEST(Flow, ProjectionLeavesNoDivergence) {
  for (Side z : {Side::open, Side::wall, Side::periodic}) {
    for (Side x : {Side::slip, Side::wall, Side::periodic}) {
      Flow flow(MPI_COMM_SELF, tube_grid(10), boundaries_of(x, Side::slip, z), {});
      flow.set_velocity(rough);
      const StepReport report = flow.step(1e-4);
      EXPECT_LT(flow.divergence(), 1e-11 * report.max_speed / flow.grid().h);
    }
  }
}

TEST(Flow, ConstrainLeavesWhatSolidsAndIncompressibilityAllow) {
  for (const bool with_walls : {false, true}) {
    Flow flow(MPI_COMM_WORLD, tube_grid(12),
              with_walls ? Boundaries{} : boundaries_of(Side::periodic, Side::periodic, Side::periodic), {});
    if (with_walls) flow.solids().set_lumen(tube);
    flow.set_velocity(rough);
    const FaceField before = flow.velocity();
    const auto dot = [](const FaceField& a, const FaceField& b) {
      double sum = 0;
      for (int d = 0; d < 3; ++d)
        for (int k = 0; k < 24; ++k)
          for (int j = 0; j < 12; ++j)
            for (int i = 0; i < 12; ++i) sum += a[d](i, j, k) * b[d](i, j, k);
      return sum;
    };
    FaceField once = before;
    flow.constrain(once);
    for (int d = 0; d < 3; ++d) EXPECT_EQ(flow.velocity()[d].data(), before[d].data());
    EXPECT_LT(dot(once, once), 0.9 * dot(before, before));  // it only adds mass
    flow.velocity() = once;
    flow.fill_ghosts();
    EXPECT_LT(flow.divergence(), 1e-11 * 40 / flow.grid().h * 100);
    if (with_walls) continue;
    FaceField twice = once;
    flow.constrain(twice);
    EXPECT_NEAR(dot(twice, twice), dot(once, once), 1e-12 * dot(once, once));
    EXPECT_NEAR(dot(once, before), dot(once, once), 1e-12 * dot(once, once));  // a projection, and symmetric
  }
}

TEST(Flow, ConstrainWithinSomePlanesDoesTheSameThere) {
  Flow flow(MPI_COMM_WORLD, tube_grid(12), Boundaries{}, {});
  flow.solids().set_lumen(tube);
  const Planes some{7, 15};
  FaceField whole(flow.slab());
  for (int d = 0; d < 3; ++d)
    for (int k = some.from; k < some.to; ++k)
      for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i) whole[d](i, j, k) = rough(d, flow.grid().position(d, i, j, k));
  FaceField within = whole;
  flow.constrain(whole);
  flow.constrain(within, some);
  for (int d = 0; d < 3; ++d)
    for (int k = 0; k < 24; ++k)
      for (int j = 0; j < 12; ++j)
        for (int i = 0; i < 12; ++i)
          ASSERT_EQ(within[d](i, j, k), some.has(k) ? whole[d](i, j, k) : 0) << d << " " << k;
}

TEST(Flow, ReportAgreesWithMeasures) {
  Flow flow(MPI_COMM_SELF, tube_grid(10), boundaries_of(Side::slip, Side::wall, Side::open), {});
  flow.set_velocity(rough);
  const StepReport report = flow.step(1e-4);
  EXPECT_NEAR(report.kinetic_energy, flow.kinetic_energy(), 1e-12 * report.kinetic_energy);
  EXPECT_NEAR(report.cfl, 1e-4 * report.max_speed / flow.grid().h, 1e-15);
}

TEST(Flow, HydrostaticPressureKeepsAClosedTubeAtRest) {
  // A pressure difference across a solid plug: the incremental form holds it without leak.
  Flow flow(MPI_COMM_SELF, tube_grid(12), boundaries_of(Side::slip, Side::slip, Side::open), {});
  flow.solids().set_lumen(tube);
  const int plug = flow.solids().add_body("plug");
  flow.solids().mark_inside(plug, [](const Vec3& x) { return std::abs(x[2]) - 2; }, {-5, -5, -3}, {5, 5, 3});
  const double pressure = 80 * 133.322;
  flow.set_end_pressure(End::high, pressure);
  for (int step = 0; step < 300; ++step) flow.step(2e-5);
  const double area = flow.open_area(2);
  EXPECT_NEAR(area, pi * 4.2 * 4.2, 0.05 * area);
  EXPECT_NEAR(flow.mean_pressure(2), 0, 1e-3 * pressure);
  EXPECT_NEAR(flow.mean_pressure(21), pressure, 1e-3 * pressure);
  // What is left is the Darcy flow of the penalised plug, eta/rho grad p: 1.5 mm3/s under 80 mmHg.
  const double darcy = flow.parameters().penalisation_s / flow.parameters().density * pressure / 4 * area;
  EXPECT_LT(std::abs(flow.flow_through(2)), 2 * darcy);
  EXPECT_NEAR(flow.solids().force_on(plug)[2] / (-pressure * area), 1, 2e-3);
}

TEST(Flow, MomentumOfAPeriodicBoxChangesByTheForceAlone) {
  Flow flow(MPI_COMM_SELF, tube_grid(8), boundaries_of(Side::periodic, Side::periodic, Side::periodic), {});
  flow.set_velocity(rough);
  const Grid& grid = flow.grid();
  Vec3 total = Vec3::Zero();
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < grid.cells[2]; ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          const double f = 1 + d + std::sin(i + 2.0 * j + 3.0 * k);
          flow.force()[d](i, j, k) = f;
          total[d] += f * std::pow(grid.h, 3);
        }
      }
    }
  }
  flow.step(1e-4);
  const Vec3 before = flow.momentum();
  for (int step = 0; step < 5; ++step) flow.step(1e-4);
  const Vec3 change = flow.momentum() - before;
  for (int d = 0; d < 3; ++d) EXPECT_NEAR(change[d], 5e-4 * total[d], 1e-9 * std::abs(5e-4 * total[d]));
}

// A slip tube that opens from a reservoir: rho L dw/dt = p - rho w^2 / 2, so w = w_end tanh(t w_end / (2 L)).
double column_error(double step_s) {
  Flow flow(MPI_COMM_SELF, tube_grid(8), boundaries_of(Side::slip, Side::slip, Side::open), {});
  const double pressure = 100, length = 20, density = flow.parameters().density;
  flow.set_end_pressure(End::low, pressure);
  double time = 0, largest = 0;
  const double w_end = std::sqrt(2 * pressure / density);
  for (int step = 0; time < 0.12; ++step) {
    const double dt = step == 0 ? 0.1 * step_s : step % 2 ? 1.4 * step_s : 0.6 * step_s;
    flow.step(dt);
    time += dt;
    const double expected = w_end * std::tanh(0.5 * time * w_end / length);
    largest = std::max(largest, std::abs(flow.flow_through(End::low) / 100 - expected) / w_end);
    EXPECT_NEAR(flow.mean_pressure(15) / (pressure / 32), 1 - std::pow(expected / w_end, 2), 0.05);
  }
  return largest;
}

TEST(Flow, ColumnFromAReservoirFollowsNewton) {
  const double coarse = column_error(2e-3), fine = column_error(1e-3);
  EXPECT_LT(coarse, 3e-4);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
}

TEST(Flow, ColumnThatStartsFromRestFollowsNewton) {
  // So slow that no head counts: exact for the scheme.
  Flow flow(MPI_COMM_SELF, tube_grid(8), boundaries_of(Side::slip, Side::slip, Side::open), {});
  const double pressure = 1e-7;
  flow.set_end_pressure(End::low, pressure);
  double time = 0;
  for (double dt : {1e-4, 2e-4, 1e-4, 3e-4}) {
    flow.step(dt);
    time += dt;
  }
  const double expected = pressure / (1e-3 * 20) * time;
  EXPECT_NEAR(flow.flow_through(End::low) / 100, expected, 1e-9 * expected);
  EXPECT_NEAR(flow.mean_pressure(0), pressure * (1 - 0.5 / 16), 1e-9 * pressure);
}

TEST(Flow, InflowRateIsCarriedThrough) {
  Boundaries boundaries = boundaries_of(Side::slip, Side::slip, Side::open);
  boundaries.side[2][0] = Side::inflow;
  Flow flow(MPI_COMM_SELF, tube_grid(10), boundaries, {});
  flow.solids().set_lumen(tube);
  flow.set_inflow_rate(
      End::low, [](const Vec3&) { return 1.0; }, 5000);
  for (int step = 0; step < 20; ++step) flow.step(1e-4);
  EXPECT_NEAR(flow.flow_through(End::low), 5000, 1e-8);
  EXPECT_NEAR(flow.flow_through(10), 5000, 5);  // what is not in the lumen's faces has leaked into the wall's
  EXPECT_THROW(flow.set_inflow(End::high, [](const Vec3&) { return 1.0; }), InputError);
}

TEST(Flow, SavedStateContinuesBitForBit) {
  const auto make = [] {
    auto flow = std::make_unique<Flow>(MPI_COMM_SELF, tube_grid(10),
                                       boundaries_of(Side::slip, Side::slip, Side::open), FlowParameters{});
    flow->solids().set_lumen(tube);
    return flow;
  };
  const auto run = [](Flow& flow, int from, int to) {
    for (int step = from; step < to; ++step) {
      flow.set_end_pressure(End::low, 500 * std::sin(0.3 * step));
      flow.step(1e-4 * (1 + 0.3 * std::sin(step)));
    }
  };
  auto whole = make();
  whole->set_velocity(rough);
  run(*whole, 0, 12);
  state::State stored;
  stored.restart = whole->save();
  run(*whole, 12, 25);
  auto resumed = make();
  resumed->load(stored);
  run(*resumed, 12, 25);
  const auto a = whole->save(), b = resumed->save();
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, array] : a) EXPECT_EQ(array.data, b.at(name).data) << name;
}

TEST(Flow, AStepTakenBackLeavesVelocityAndPressureAsTheyWere) {
  Flow flow(MPI_COMM_SELF, tube_grid(10), boundaries_of(Side::slip, Side::slip, Side::open), {});
  flow.solids().set_lumen(tube);
  flow.set_velocity(rough);
  flow.set_end_pressure(End::low, 500);
  for (int step = 0; step < 3; ++step) flow.step(1e-4);
  const auto before = flow.save();
  flow.step(3e-4);
  flow.undo();
  const auto after = flow.save();
  for (const char* name : {"fluid/velocity_x", "fluid/velocity_y", "fluid/velocity_z", "fluid/pressure"})
    EXPECT_EQ(before.at(name).data, after.at(name).data) << name;
  EXPECT_LT(flow.step(1e-4).cfl, 0.1);
}

TEST(Flow, StateOfAnotherGridIsRefused) {
  Flow small(MPI_COMM_SELF, tube_grid(8), boundaries_of(Side::slip, Side::slip, Side::open), {});
  Flow large(MPI_COMM_SELF, tube_grid(10), boundaries_of(Side::slip, Side::slip, Side::open), {});
  state::State stored;
  stored.restart = small.save();
  EXPECT_THROW(large.load(stored), InputError);
}

TEST(Flow, NotANumberIsFoundAndPlaced) {
  Flow flow(MPI_COMM_SELF, tube_grid(8), boundaries_of(Side::slip, Side::slip, Side::open), {});
  flow.force()[1](3, 4, 5) = std::nan("");
  EXPECT_THROW(flow.step(1e-4), NumericalFailure);
}

TEST(Flow, PressureAndVelocityProbesInterpolateLinearly) {
  Flow flow(MPI_COMM_SELF, tube_grid(8), boundaries_of(Side::slip, Side::slip, Side::open), {});
  flow.set_velocity([](int d, const Vec3& x) { return d == 2 ? 3 + 0.5 * x[0] - 0.2 * x[1] : 0; });
  flow.set_pressure([](const Vec3& x) { return 7 * x[2]; });
  flow.set_end_pressure(End::low, -70);
  flow.set_end_pressure(End::high, 70);
  EXPECT_NEAR(flow.velocity_at({1.1, -0.7, 2.3})[2], 3 + 0.55 + 0.14, 1e-12);
  EXPECT_NEAR(flow.pressure_at({1.1, -0.7, 2.3}), 16.1, 1e-12);
  EXPECT_NEAR(flow.pressure_at({1.1, -0.7, 9.9}), 69.3, 1e-12);
}

TEST(Grid, TooManyRanksOrOneSidedPeriodicityAreRefused) {
  Grid grid;
  grid.cells = {8, 8, 2};
  Boundaries boundaries;
  EXPECT_THROW(Flow(MPI_COMM_SELF, grid, boundaries, {}), InputError);  // walls
  grid.cells = {8, 8, 0};
  EXPECT_THROW(Slab(MPI_COMM_SELF, grid, true), InputError);
  boundaries.side[0][0] = Side::periodic;
  EXPECT_THROW(boundaries.check(), InputError);
  boundaries.side[0] = {Side::open, Side::open};
  EXPECT_THROW(boundaries.check(), InputError);
}

}  // namespace
