// Taylor-Green vortices in a periodic plane, an exact solution that decays and travels:
//   u = U + cos(kx') sin(ky') e^(-2 nu k^2 t),  v = V - sin(kx') cos(ky') e^(-2 nu k^2 t),  x' = x - U t, y'
//   = y - V t
// The travelling form makes convection act in time; orders are asserted, not errors.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double nu = 0.01, drift = 0.7;

double exact(int d, const Vec3& x, double t) {
  const double k = 2 * pi, a = k * (x[0] - drift * t), b = k * (x[1] - 0.5 * drift * t);
  const double decay = std::exp(-2 * nu * k * k * t);
  if (d == 0) return drift + std::cos(a) * std::sin(b) * decay;
  if (d == 1) return 0.5 * drift - std::sin(a) * std::cos(b) * decay;
  return 0;
}

std::unique_ptr<Flow> run(int n, double end, int steps, Convection scheme, bool variable_steps = false) {
  Grid grid;
  grid.cells = {n, n, 4};
  grid.h = 1.0 / n;
  Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
  FlowParameters parameters;
  parameters.density = 1;
  parameters.viscosity = nu;
  parameters.convection = scheme;
  auto flow = std::make_unique<Flow>(MPI_COMM_SELF, grid, boundaries, parameters);
  flow->set_velocity([](int d, const Vec3& x) { return exact(d, x, 0); });
  const double base = end / steps;
  for (int step = 0; step < steps; ++step) {
    const double dt = variable_steps ? base * (step % 2 == 0 ? 1.4 : 0.6) : base;
    flow->step(dt);
  }
  return flow;
}

template <class Value>
double difference(const Flow& flow, const Value& value) {
  double sum = 0;
  const Grid& grid = flow.grid();
  for (int d = 0; d < 2; ++d) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        sum += std::pow(flow.velocity()[d](i, j, 1) - value(d, i, j), 2) * grid.h * grid.h;
      }
    }
  }
  return std::sqrt(sum);
}

double error(const Flow& flow, double t) {
  return difference(flow, [&](int d, int i, int j) { return exact(d, flow.grid().position(d, i, j, 1), t); });
}

class TaylorGreen : public testing::TestWithParam<const char*> {};

TEST_P(TaylorGreen, SecondOrderInSpaceAndTimeTogether) {
  const double end = 0.2;
  std::vector<double> errors;
  // The upwind scheme's third-order dissipation and its second-order error have opposite signs here and cross
  // near n = 100, so its order is bounded from below over the whole range instead of pair by pair.
  const Convection scheme = convection_from(GetParam());
  const bool upwind = scheme == Convection::upwind3;
  std::vector<int> sizes{16, 32, 64};
  if (upwind) sizes.push_back(128);
  for (int n : sizes) errors.push_back(error(*run(n, end, n * 4, scheme), end));
  for (std::size_t i = 1; i < errors.size(); ++i) {
    const double order = std::log(errors[i - 1] / errors[i]) / std::log(double(sizes[i]) / sizes[i - 1]);
    std::printf("n = %d: error %.3e, order %.2f\n", sizes[i], errors[i], order);
    if (upwind) {
      EXPECT_LT(errors[i], errors[0] * std::pow(double(sizes[0]) / sizes[i], 1.8));
    } else {
      EXPECT_GT(order, 1.8);
      EXPECT_LT(order, 2.3);
    }
  }
}

TEST_P(TaylorGreen, SecondOrderInTime) {
  // Against a run of the same grid with a 16 times smaller step: the error of time alone.
  const Convection scheme = convection_from(GetParam());
  const double end = 0.2;
  const int n = 24;
  for (bool variable : {false, true}) {
    const auto reference = run(n, end, 1024, scheme);
    const auto same = [&](int d, int i, int j) { return reference->velocity()[d](i, j, 1); };
    std::vector<double> errors;
    for (int steps : {32, 64, 128}) errors.push_back(difference(*run(n, end, steps, scheme, variable), same));
    for (std::size_t i = 1; i < errors.size(); ++i) {
      const double order = std::log2(errors[i - 1] / errors[i]);
      std::printf("%s steps: error %.3e, order %.2f\n", variable ? "alternating" : "equal", errors[i], order);
      EXPECT_GT(order, 1.8);
      EXPECT_LT(order, 2.3);
    }
  }
}

TEST_P(TaylorGreen, DivergenceStaysAtRoundOff) {
  EXPECT_LT(run(32, 0.1, 40, convection_from(GetParam()))->divergence(), 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Schemes, TaylorGreen, testing::Values("upwind3", "centred4", "centred2", "weno5"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Energy, CentredSecondOrderConvectionConservesIt) {
  // Inviscid and periodic: what the scheme loses in one time unit comes from time stepping alone.
  const auto loss = [](Convection scheme, int steps) {
    Grid grid;
    grid.cells = {24, 24, 4};
    grid.h = 1.0 / 24;
    Boundaries boundaries;
    for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
    FlowParameters parameters;
    parameters.density = 1;
    parameters.viscosity = 0;
    parameters.convection = scheme;
    Flow flow(MPI_COMM_SELF, grid, boundaries, parameters);
    flow.set_velocity([](int d, const Vec3& x) {
      return exact(d, x, 0) + (d == 0   ? 0.3 * std::sin(6 * pi * x[1])
                               : d == 1 ? 0.3 * std::sin(4 * pi * x[0])
                                        : 0);
    });
    flow.step(1e-9);
    const double before = flow.kinetic_energy();
    for (int step = 0; step < steps; ++step) flow.step(0.2 / steps);
    return (before - flow.kinetic_energy()) / before;
  };
  const double coarse = std::abs(loss(Convection::centred2, 40)),
               fine = std::abs(loss(Convection::centred2, 80));
  std::printf("relative loss: centred2 %.2e and %.2e, upwind3 %.2e\n", coarse, fine,
              loss(Convection::upwind3, 80));
  EXPECT_LT(fine, 1e-4);
  EXPECT_LT(fine, 0.5 * coarse);
  EXPECT_GT(loss(Convection::upwind3, 80), 10 * fine);
}

}  // namespace
