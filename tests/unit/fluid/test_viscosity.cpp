// Shear-thinning blood and the subgrid model: values for known gradients, stresses, a channel.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "core/errors.hpp"
#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

Grid box(int n, double h) {
  Grid grid;
  grid.cells = {n, n, n};
  grid.h = h;
  return grid;
}

// nu_x in the middle of a box where d u_j / d x_i = gradient(i, j), ghosts included.
double value_for(const Eigen::Matrix3d& gradient, const ExtraViscosityParameters& parameters,
                 double h = 0.5) {
  const Boundaries boundaries;
  const Slab slab(MPI_COMM_SELF, box(6, h), false);
  FaceField velocity(slab);
  for (int d = 0; d < 3; ++d) {
    for (int k = -2; k < 8; ++k) {
      for (int j = -2; j < 8; ++j) {
        for (int i = -2; i < 8; ++i)
          velocity[d](i, j, k) = (gradient.transpose() * slab.grid.position(d, i, j, k))[d];
      }
    }
  }
  ExtraViscosity extra(slab, boundaries, parameters, 3.45e-3, 1e-3);
  extra.update(velocity);
  return extra.value()(3, 2, 3);
}

TEST(Vreman, IsZeroInPlaneShear) {
  const ExtraViscosityParameters model{.carreau_yasuda = {}, .vreman = 0.07};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      Eigen::Matrix3d shear = Eigen::Matrix3d::Zero();
      shear(i, j) = 37;
      EXPECT_EQ(value_for(shear, model), 0);
    }
  }
  EXPECT_EQ(value_for(Eigen::Matrix3d::Zero(), model), 0);
}

TEST(Vreman, HasTheValueOfItsFormula) {
  const double c = 0.07, h = 0.5, s = 12;
  // Plane strain diag(s, -s, 0): beta = h^2 s^2 diag(1, 1, 0), B = h^4 s^4, alpha:alpha = 2 s^2.
  Eigen::Matrix3d strain = Eigen::Matrix3d::Zero();
  strain(0, 0) = s;
  strain(1, 1) = -s;
  EXPECT_NEAR(value_for(strain, {.carreau_yasuda = {}, .vreman = c}, h), c * h * h * s / std::sqrt(2.0),
              1e-10);
  // In general B is half of (tr beta)^2 - tr beta^2.
  Eigen::Matrix3d any;
  any << 1, 7, -3, 2, -4, 5, -6, 8, 3;
  const Eigen::Matrix3d beta = h * h * any.transpose() * any;
  const double minors = 0.5 * (std::pow(beta.trace(), 2) - (beta * beta).trace());
  EXPECT_NEAR(value_for(any, {.carreau_yasuda = {}, .vreman = c}, h),
              c * std::sqrt(minors / any.squaredNorm()), 1e-10);
}

double carreau_yasuda(double gamma, const CarreauYasuda& law, double mu_inf) {
  return mu_inf + (law.zero_shear - mu_inf) * std::pow(1 + std::pow(law.time_s * gamma, law.transition),
                                                       (law.exponent - 1) / law.transition);
}

TEST(CarreauYasuda, TakesTheShearRateOfTheWholeGradient) {
  const CarreauYasuda law;
  Eigen::Matrix3d any;
  any << 1, 7, -3, 2, -4, 5, -6, 8, 3;
  const Eigen::Matrix3d strain = 0.5 * (any + any.transpose());
  const double gamma = std::sqrt(2 * strain.squaredNorm());
  EXPECT_NEAR(value_for(any, {.carreau_yasuda = law}) * 1e-3, carreau_yasuda(gamma, law, 3.45e-3) - 3.45e-3,
              1e-12);
  EXPECT_NEAR(value_for(Eigen::Matrix3d::Zero(), {.carreau_yasuda = law}) * 1e-3, law.zero_shear - 3.45e-3,
              1e-14);
}

TEST(CarreauYasuda, WithoutThinningIsTheConstantViscosity) {
  // n = 1: mu_0 everywhere, though through the stresses of the extra part.
  const auto run = [](double mu, double extra) {
    Boundaries boundaries;
    boundaries.side[0] = {Side::wall, Side::wall};
    boundaries.velocity[0][1] = Vec3(0, 20, 0);
    boundaries.side[2] = {Side::periodic, Side::periodic};
    FlowParameters parameters;
    parameters.viscosity = mu;
    if (extra > 0)
      parameters.extra_viscosity.carreau_yasuda = CarreauYasuda{.zero_shear = extra, .exponent = 1};
    auto flow = std::make_unique<Flow>(MPI_COMM_SELF, box(12, 0.5), boundaries, parameters);
    flow->set_velocity([](int d, const Vec3& x) {
      return 40 * std::sin(1.3 * x[(d + 1) % 3] + d) * std::cos(0.7 * x[d] - 0.4 * d);
    });
    flow->step(1e-4);
    for (int step = 0; step < 10; ++step) flow->step(1e-4);
    return flow;
  };
  const auto constant = run(0.03, 0), split = run(0.01, 0.03);
  double off = 0, size = 0;
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < 12; ++k) {
      for (int j = 0; j < 12; ++j) {
        for (int i = 0; i < 12; ++i) {
          const double u = constant->velocity()[d](i, j, k);
          off = std::max(off, std::abs(u - split->velocity()[d](i, j, k)));
          size = std::max(size, std::abs(u));
        }
      }
    }
  }
  // The two differ in the first step alone, whose velocity was not yet free of divergence.
  EXPECT_LT(off, 2e-3 * size);
}

// Steady flow between plates at x = 0 and x = width under a gradient: mu(|w'|) |w'| = gradient |x - width/2|,
// integrated from the wall (midpoint rule, fine).
double channel(double x, double width, double gradient, const CarreauYasuda& law, double mu_inf) {
  const double from = std::min(x, width - x);
  constexpr int steps = 2000;
  double w = 0;
  for (int s = 0; s < steps; ++s) {
    const double stress = gradient * (0.5 * width - from * (s + 0.5) / steps);
    double low = 0, high = stress / mu_inf;
    for (int bisect = 0; bisect < 60; ++bisect) {
      const double middle = 0.5 * (low + high);
      (carreau_yasuda(middle, law, mu_inf) * middle < stress ? low : high) = middle;
    }
    w += 0.5 * (low + high) * from / steps;
  }
  return w;
}

TEST(CarreauYasuda, ChannelFlowConvergesToTheIntegratedProfile) {
  const double width = 2, gradient = 0.3, mu_inf = 3.45e-3;
  const CarreauYasuda law;
  std::vector<double> errors;
  for (int n : {8, 16, 32}) {
    Grid grid;
    grid.cells = {n, 3, 3};
    grid.h = width / n;
    Boundaries boundaries;
    boundaries.side = {
        {{Side::wall, Side::wall}, {Side::periodic, Side::periodic}, {Side::periodic, Side::periodic}}};
    FlowParameters parameters;
    parameters.viscosity = mu_inf;
    parameters.extra_viscosity.carreau_yasuda = law;
    Flow flow(MPI_COMM_SELF, grid, boundaries, parameters);
    std::vector<double> exact(n);
    for (int i = 0; i < n; ++i)
      exact[i] = channel(grid.position(2, i, 0, 0)[0], width, gradient, law, mu_inf);
    flow.set_velocity(
        [&](int d, const Vec3& x) { return d == 2 ? exact[static_cast<int>(x[0] / grid.h)] : 0; });
    flow.force()[2].fill(gradient);
    const double dt = 0.08 * grid.h * grid.h * 1e-3 / law.zero_shear;
    for (double t = 0; t < 0.06; t += dt) flow.step(dt);
    double off = 0, size = 0;
    for (int i = 0; i < n; ++i) {
      off += std::pow(flow.velocity()[2](i, 1, 1) - exact[i], 2);
      size += exact[i] * exact[i];
    }
    errors.push_back(std::sqrt(off / size));
    const double newtonian = gradient * width * width / (8 * mu_inf);
    std::printf("n = %d: error %.3e; centre %.1f mm/s, Newtonian %.1f\n", n, errors.back(), exact[n / 2],
                newtonian);
    EXPECT_LT(exact[n / 2], 0.9 * newtonian);
  }
  EXPECT_GT(std::log2(errors[0] / errors[1]), 1.8);
  EXPECT_GT(std::log2(errors[1] / errors[2]), 1.8);
}

TEST(CarreauYasuda, ThickeningFluidsAreRefused) {
  FlowParameters parameters;
  parameters.viscosity = 0.1;
  parameters.extra_viscosity.carreau_yasuda = CarreauYasuda{};
  EXPECT_THROW(Flow(MPI_COMM_SELF, box(6, 1), Boundaries{}, parameters), InputError);
}

}  // namespace
