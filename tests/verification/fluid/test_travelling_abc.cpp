// Fourth-order operators and Runge-Kutta steps on the travelling Arnold-Beltrami-Childress flow, an exact
// solution in the unit periodic box (rho = 1, nu = 1e-3):
//   u = 1 + a (cos 2pi(y-t) + sin 2pi(z-t)), v = 1 + a (sin 2pi(x-t) + cos 2pi(z-t)),
//   w = 1 + a (cos 2pi(x-t) + sin 2pi(y-t)), a = e^(-4 pi^2 nu t)
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "fluid/flow.hpp"
#include "travelling_abc.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

constexpr double pi = std::numbers::pi, nu = 1e-3;

double exact(int d, const Vec3& x, double t) {
  return test::travelling_abc(d, x, t, nu);
}

std::unique_ptr<Flow> make(int n, Convection convection, int order = 4, double viscosity = nu) {
  Grid grid;
  grid.cells = {n, n, n};
  grid.h = 1.0 / n;
  Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
  FlowParameters parameters;
  parameters.density = 1;
  parameters.viscosity = viscosity;
  parameters.convection = convection;
  parameters.order = order;
  auto flow = std::make_unique<Flow>(MPI_COMM_SELF, grid, boundaries, parameters);
  flow->set_velocity([](int d, const Vec3& x) { return exact(d, x, 0); });
  return flow;
}

template <class Value>
double difference(const Flow& flow, const Value& value) {
  const int n = flow.grid().cells[0];
  double sum = 0;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) sum += std::pow(flow.velocity()[0](i, j, k) - value(i, j, k), 2);
    }
  }
  return std::sqrt(sum / std::pow(n, 3));
}

double error(int n, Convection convection, double end, int steps, int order = 4) {
  auto flow = make(n, convection, order);
  for (int step = 0; step < steps; ++step) flow->step_rk3(end / steps);
  return difference(*flow,
                    [&](int i, int j, int k) { return exact(0, flow->grid().position(0, i, j, k), end); });
}

TEST(TravellingAbc, FourthOrderInSpace) {
  for (const Convection convection : {Convection::centred4, Convection::conserving4}) {
    double before = 0;
    for (int n : {12, 18, 27}) {
      const double now = error(n, convection, 0.05, n / 3);
      const double order = std::log(before / now) / std::log(1.5);
      std::printf("n = %d: error %.3e, order %.2f\n", n, now, order);
      if (before > 0) {
        EXPECT_GT(order, 3.8);
        // The interpolated form's fourth-order terms almost cancel, so that it converges faster here.
        EXPECT_LT(order, convection == Convection::centred4 ? 5.5 : 4.2);
      }
      before = now;
    }
  }
}

TEST(TravellingAbc, RungeKuttaIsOfThirdOrderInTime) {
  const int n = 12;
  const double end = 0.3;
  for (int order : {2, 4}) {
    auto reference = make(n, Convection::centred4, order);
    for (int step = 0; step < 320; ++step) reference->step_rk3(end / 320);
    std::vector<double> errors;
    for (int steps : {10, 20, 40}) {
      auto flow = make(n, Convection::centred4, order);
      for (int step = 0; step < steps; ++step) flow->step_rk3(end / steps);
      errors.push_back(
          difference(*flow, [&](int i, int j, int k) { return reference->velocity()[0](i, j, k); }));
    }
    for (std::size_t i = 1; i < errors.size(); ++i) {
      const double observed = std::log2(errors[i - 1] / errors[i]);
      std::printf("order %d in space: error of time %.2e, order %.2f\n", order, errors[i], observed);
      EXPECT_GT(observed, 2.8);
      EXPECT_LT(observed, 3.4);
    }
  }
}

TEST(TravellingAbc, SmallerErrorsThanIbamrOnTwentyCellsASide) {
  // IBAMR 0.19: 1.24e-5 at t = 0.05 on 64^3, 2.95e-5 at t = 0.1 on 32^3.
  EXPECT_LT(error(20, Convection::centred4, 0.05, 6), 1.24e-5);
  EXPECT_LT(error(20, Convection::centred4, 0.1, 12), 2.95e-5);
}

TEST(TravellingAbc, StableAtHalfTheCourantNumber) {
  // CFL = dt max(|u|, |v|, |w|) / h; dt (|u| + |v| + |w|) / h is up to 1.2.
  for (const Convection convection : {Convection::centred4, Convection::conserving4, Convection::upwind3}) {
    const int n = 24, order = convection == Convection::upwind3 ? 2 : 4;
    auto flow = make(n, convection, order);
    double time = 0;
    while (time < 1) {
      double fastest = 0;
      for (int d = 0; d < 3; ++d) {
        for (double u : flow->velocity()[d].data()) fastest = std::max(fastest, std::abs(u));
      }
      const double dt = 0.5 * flow->grid().h / fastest;
      flow->step_rk3(dt);
      time += dt;
    }
    const double off = difference(
        *flow, [&](int i, int j, int k) { return exact(0, flow->grid().position(0, i, j, k), time); });
    std::printf("t = %.3f: error %.2e\n", time, off);
    EXPECT_LT(off, convection == Convection::centred4 ? 1e-4 : 0.05);
  }
}

TEST(TravellingAbc, ConservingFormKeepsEnergyAndBothKeepMomentum) {
  const auto rough = [](int d, const Vec3& x) {
    return std::sin(2 * pi * (2 * x[(d + 1) % 3] + x[d])) +
           0.5 * std::cos(2 * pi * (3 * x[(d + 2) % 3] - x[d])) + 0.3;
  };
  double loss[2];
  for (const int which : {0, 1}) {
    const auto convection = which == 0 ? Convection::conserving4 : Convection::centred4;
    auto flow = make(16, convection, 4, 0);
    flow->set_velocity(rough);
    flow->step_rk3(1e-9);
    const double before = flow->kinetic_energy();
    const Vec3 momentum = flow->momentum();
    for (int step = 0; step < 100; ++step) flow->step_rk3(2e-3);
    loss[which] = std::abs(before - flow->kinetic_energy()) / before;
    EXPECT_LT((flow->momentum() - momentum).norm(), 1e-12);
    EXPECT_LT(flow->divergence(), 1e-11);
  }
  std::printf("energy changed by %.1e (conserving), %.1e (interpolated)\n", loss[0], loss[1]);
  EXPECT_LT(loss[0], 1e-4);
  EXPECT_GT(loss[1], 3 * loss[0]);
}

TEST(TravellingAbc, OrderFourIsRefusedWhereItDoesNotHold) {
  FlowParameters parameters;
  parameters.order = 4;
  parameters.convection = Convection::centred4;
  Grid grid;
  grid.cells = {8, 8, 8};
  EXPECT_THROW(Flow(MPI_COMM_SELF, grid, Boundaries{}, parameters), InputError);
  EXPECT_THROW(make(8, Convection::upwind3, 4), InputError);
  EXPECT_THROW(make(8, Convection::conserving4, 2), InputError);
}

}  // namespace
