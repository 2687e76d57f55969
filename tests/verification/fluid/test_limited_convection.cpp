// Convection of what the grid does not resolve: a jump of the transverse velocity carried through a periodic
// box (exact: it only moves), and a thin shear layer at Re 20,000 rolling up (Brown and Minion 1995 show what
// centred and unlimited schemes make of it).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "fluid/flow.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::fluid;

constexpr double pi = std::numbers::pi;

Flow box(std::array<int, 3> cells, double h, double viscosity, Convection convection) {
  Grid grid;
  grid.cells = cells;
  grid.h = h;
  Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
  FlowParameters parameters;
  parameters.density = 1;
  parameters.viscosity = viscosity;
  parameters.convection = convection;
  return Flow(MPI_COMM_SELF, grid, boundaries, parameters);
}

struct Jump {
  double beyond = 0;  ///< how far the velocity leaves [0, 1]
  double l1 = 0;      ///< mean error
};

// u = 1 for a < y < b, 0 elsewhere, carried once around along y by v = 1.
Jump carried_jump(int n, Convection convection) {
  Flow flow = box({4, n, 4}, 1.0 / n, 0, convection);
  const auto inside = [](double y) { return y > 0.25 && y < 0.75 ? 1.0 : 0.0; };
  flow.set_velocity([&](int d, const Vec3& x) { return d == 0 ? inside(x[1]) : d == 1 ? 1.0 : 0.0; });
  const int steps = 8 * n;  // small steps: the error of space alone
  for (int step = 0; step < steps; ++step) flow.step(1.0 / steps);
  Jump jump;
  for (int j = 0; j < n; ++j) {
    const double u = flow.velocity()[0](1, j, 1);
    jump.beyond = std::max({jump.beyond, u - 1, -u});
    jump.l1 += std::abs(u - inside((j + 0.5) / n)) / n;
  }
  return jump;
}

TEST(LimitedConvection, CarriesAJumpWithoutNewExtremes) {
  const Jump weno = carried_jump(64, Convection::weno5), upwind = carried_jump(64, Convection::upwind3),
             centred = carried_jump(64, Convection::centred4);
  std::printf("beyond [0, 1]: weno5 %.1e, upwind3 %.3f, centred4 %.3f; mean error %.4f, %.4f, %.4f\n",
              weno.beyond, upwind.beyond, centred.beyond, weno.l1, upwind.l1, centred.l1);
  EXPECT_LT(weno.beyond, 2e-3);
  EXPECT_GT(upwind.beyond, 0.03);
  EXPECT_GT(centred.beyond, 0.2);
  EXPECT_LT(weno.l1, upwind.l1);
  // A jump converges with h^(p/(p+1)), p = 5.
  const double order = std::log2(weno.l1 / carried_jump(128, Convection::weno5).l1);
  std::printf("order of the mean error %.2f\n", order);
  EXPECT_GT(order, 0.75);
}

struct Layer {
  double energy = 0;     ///< at the end, of the first
  double vorticity = 0;  ///< largest at the end, of the first
};

// Two layers of thickness 1/80, Re = U L / nu = 20,000, until they have rolled up.
Layer shear_layer(int n, Convection convection) {
  Flow flow = box({n, n, 4}, 1.0 / n, 1.0 / 20000, convection);
  flow.set_velocity([](int d, const Vec3& x) {
    if (d == 0) return std::tanh(80 * (x[1] < 0.5 ? x[1] - 0.25 : 0.75 - x[1]));
    return d == 1 ? 0.05 * std::sin(2 * pi * (x[0] + 0.25)) : 0.0;
  });
  const auto vorticity = [&] {
    double largest = 0;
    const FaceField& u = flow.velocity();
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i)
        largest = std::max(
            largest, std::abs(u[1](i, j, 1) - u[1](i - 1, j, 1) - u[0](i, j, 1) + u[0](i, j - 1, 1)) * n);
    }
    return largest;
  };
  flow.step(1e-9);
  const double energy = flow.kinetic_energy(), first = vorticity();
  const int steps = 5 * n;
  for (int step = 0; step < steps; ++step) flow.step(1.0 / steps);
  return {flow.kinetic_energy() / energy, vorticity() / first};
}

TEST(LimitedConvection, ThinShearLayerAtReynolds20000StaysBounded) {
  // Vorticity of a plane flow obeys a maximum principle: it may not exceed what it was.
  const Layer weno = shear_layer(96, Convection::weno5), centred = shear_layer(96, Convection::centred4),
              upwind = shear_layer(96, Convection::upwind3);
  std::printf("energy: weno5 %.4f, upwind3 %.4f, centred4 %.4f; vorticity %.2f, %.2f, %.2f\n", weno.energy,
              upwind.energy, centred.energy, weno.vorticity, upwind.vorticity, centred.vorticity);
  EXPECT_LT(weno.energy, 1);
  EXPECT_GT(weno.energy, 0.95);
  EXPECT_LT(weno.vorticity, 1.05);
  EXPECT_GT(centred.vorticity, 1.2);  // what the test is there to see
}

}  // namespace
