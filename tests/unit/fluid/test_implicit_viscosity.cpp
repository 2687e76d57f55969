// Crank-Nicolson viscosity: decay of one mode, agreement with the explicit form, order, stability, forces.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

constexpr double pi = std::numbers::pi;

std::unique_ptr<Flow> make(const Grid& grid, const Boundaries& boundaries, double viscosity, bool implicit) {
  FlowParameters parameters;
  parameters.density = 1;
  parameters.viscosity = viscosity;
  parameters.convection = Convection::centred4;
  parameters.implicit_viscosity = implicit;
  return std::make_unique<Flow>(MPI_COMM_SELF, grid, boundaries, parameters);
}

Boundaries periodic() {
  Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
  return boundaries;
}

double vortex(int d, const Vec3& x, double t, double nu) {  // Taylor and Green's, at rest
  const double decay = std::exp(-8 * pi * pi * nu * t), a = 2 * pi * x[0], b = 2 * pi * x[1];
  return d == 0 ? std::cos(a) * std::sin(b) * decay : d == 1 ? -std::sin(a) * std::cos(b) * decay : 0;
}

double difference(const Flow& a, const Flow& b) {
  const auto& n = a.grid().cells;
  double sum = 0;
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < n[2]; ++k) {
      for (int j = 0; j < n[1]; ++j) {
        for (int i = 0; i < n[0]; ++i)
          sum += std::pow(a.velocity()[d](i, j, k) - b.velocity()[d](i, j, k), 2);
      }
    }
  }
  return std::sqrt(sum / a.grid().all_cells());
}

TEST(ImplicitViscosity, SecondOrderInTimeFarAboveTheExplicitLimit) {
  Grid grid;
  grid.cells = {32, 32, 3};
  grid.h = 1.0 / 32;
  const double nu = 0.25, end = 0.05;
  const auto run = [&](int steps) {
    auto flow = make(grid, periodic(), nu, true);
    flow->set_velocity([&](int d, const Vec3& x) { return vortex(d, x, 0, nu); });
    for (int step = 0; step < steps; ++step) flow->step(end / steps);
    return flow;
  };
  const auto reference = run(640);
  std::vector<double> errors;
  for (int steps : {10, 20, 40}) {
    const auto flow = run(steps);
    errors.push_back(difference(*flow, *reference));
    std::printf("nu dt/h^2 = %.2f: error of time %.2e, %d iterations\n", nu * end / steps / (grid.h * grid.h),
                errors.back(), flow->viscous_iterations());
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.8);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.8);
}

TEST(ImplicitViscosity, StableAtAHundredTimesTheExplicitLimit) {
  // A lid drives a closed box of a very viscous fluid to its steady state.
  Grid grid;
  grid.cells = {16, 16, 5};
  grid.h = 1.0 / 16;
  Boundaries boundaries;
  boundaries.side = {{{Side::wall, Side::wall}, {Side::wall, Side::wall}, {Side::slip, Side::slip}}};
  boundaries.velocity[1][1] = Vec3(1, 0, 0);
  const double nu = 10, limit = grid.h * grid.h / (12 * nu);
  auto slow = make(grid, boundaries, nu, false), fast = make(grid, boundaries, nu, true);
  for (double t = 0; t < 0.15; t += 0.5 * limit) slow->step(0.5 * limit);
  for (int step = 0; step < 400; ++step) fast->step(100 * limit);
  std::printf("nu dt/h^2 = %.1f: difference of the steady states %.2e, %d iterations\n", 100.0 / 12,
              difference(*slow, *fast), fast->viscous_iterations());
  EXPECT_LT(difference(*slow, *fast), 1e-6);
  EXPECT_LT(fast->divergence(), 1e-9);
}

TEST(ImplicitViscosity, SmallStepsAgreeWithTheExplicitForm) {
  // Every kind of side, a tube, a body that moves: the two forms differ by the error of time alone.
  Grid grid;
  grid.cells = {12, 14, 24};
  grid.h = 0.5;
  grid.origin = Vec3(-3, -3.5, -6);
  for (Side low : {Side::open, Side::inflow, Side::wall}) {
    Boundaries boundaries;
    boundaries.side = {{{Side::slip, Side::slip},
                        {Side::wall, Side::wall},
                        {low, low == Side::wall ? Side::wall : Side::open}}};
    boundaries.velocity[1][0] = Vec3(3, 0, 1);
    const auto run = [&](bool implicit, int parts) {
      auto flow = make(grid, boundaries, 2, implicit);
      flow->solids().set_lumen([](const Vec3& x) { return std::abs(x[0]) - 2.4; });
      const int body = flow->solids().add_body("ball");
      flow->solids().mark_inside(
          body, [](const Vec3& x) { return x.norm() - 1; }, Vec3::Constant(-1), Vec3::Constant(1));
      flow->solids().set_motion(body, {Vec3(0, 2, 1), Vec3(1, 0, 0), Vec3::Zero()});
      flow->set_velocity(
          [](int d, const Vec3& x) { return std::sin(x[(d + 1) % 3] + d) * std::cos(0.7 * x[d]); });
      if (low == Side::inflow) {
        flow->set_inflow(End::low, [](const Vec3& x) { return 2 + x[1] * 0.1; });
      }
      flow->set_end_pressure(End::high, -3);
      for (int step = 0; step < 6 * parts; ++step) flow->step(2e-3 / parts);
      return flow;
    };
    const auto coarse_a = run(true, 1), coarse_b = run(false, 1), a = run(true, 4), b = run(false, 4);
    const double coarse = difference(*coarse_a, *coarse_b), fine = difference(*a, *b);
    std::printf("difference %.2e, a quarter of the step %.2e\n", coarse, fine);
    EXPECT_LT(fine, 0.4 * coarse);
    EXPECT_LT(fine, 5e-3);
    const Vec3 force_a = a->solids().force_on(1), force_b = b->solids().force_on(1);
    EXPECT_LT((force_a - force_b).norm(), 0.02 * force_b.norm());
  }
}

}  // namespace
