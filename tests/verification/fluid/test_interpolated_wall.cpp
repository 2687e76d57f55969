// The interpolated wall: second order in a straight pipe, a tilted channel and oscillating flow; wall shear
// stress; what it takes from the fluid; tightness.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double radius = 5, density = 1e-3, viscosity = 3.5e-3;  // mm, g/mm3, Pa s

std::unique_ptr<Flow> pipe(double cells_per_radius, const Vec3& shift, Wall wall, bool implicit = false) {
  Grid grid;
  grid.h = radius / cells_per_radius;
  const int across = static_cast<int>(std::ceil(2.3 * cells_per_radius)) + 2;
  grid.cells = {across, across, 4};
  grid.origin = -0.5 * grid.h * Vec3(across, across, 0) + grid.h * shift;
  Boundaries boundaries;
  boundaries.side = {{{Side::slip, Side::slip}, {Side::slip, Side::slip}, {Side::periodic, Side::periodic}}};
  FlowParameters parameters;
  parameters.density = density;
  parameters.viscosity = viscosity;
  parameters.wall = wall;
  parameters.implicit_viscosity = implicit;
  auto flow = std::make_unique<Flow>(MPI_COMM_SELF, grid, boundaries, parameters);
  flow->solids().set_lumen([](const Vec3& x) { return std::hypot(x[0], x[1]) - radius; });
  return flow;
}

// Relative L2 error over the open faces of the section against w(r).
template <class Profile>
double profile_error(const Flow& flow, const Profile& w) {
  const Grid& grid = flow.grid();
  double error = 0, size = 0;
  for (int j = 0; j < grid.cells[1]; ++j) {
    for (int i = 0; i < grid.cells[0]; ++i) {
      const Vec3 x = grid.position(2, i, j, 1);
      const double r = std::hypot(x[0], x[1]);
      if (r >= radius) continue;
      error += std::pow(flow.velocity()[2](i, j, 1) - w(r), 2);
      size += w(r) * w(r);
    }
  }
  return std::sqrt(error / size);
}

struct Errors {
  double profile = 0, flow = 0, shear = 0;
};

// Mean over positions of the pipe on the grid; shear: root mean square over 16 places of the wall.
Errors poiseuille(double n, Wall wall) {
  const double gradient = 2;  // Pa/mm
  const auto exact = [&](double r) { return gradient / (4 * viscosity) * (radius * radius - r * r); };
  const double exact_flow = pi * gradient * std::pow(radius, 4) / (8 * viscosity);
  Errors mean;
  for (const Vec3& shift : {Vec3(0, 0, 0), Vec3(0.5, 0.5, 0), Vec3(0.27, 0.41, 0), Vec3(0.13, 0.34, 0)}) {
    auto flow = pipe(n, shift, wall);
    flow->set_velocity(
        [&](int d, const Vec3& x) { return d == 2 ? std::max(0.0, exact(std::hypot(x[0], x[1]))) : 0; });
    flow->force()[2].fill(gradient);
    const double h = flow->grid().h, dt = 0.12 * h * h / (viscosity / density) / 1.5;
    const int steps = static_cast<int>(std::ceil(2.0 / dt));
    for (int step = 0; step < steps; ++step) flow->step(dt);
    mean.profile += 0.25 * profile_error(*flow, exact);
    mean.flow += 0.25 * std::abs(flow->flow_through(1) / exact_flow - 1);
    double square = 0;
    for (int a = 0; a < 16; ++a) {
      const Vec3 normal(-std::cos(2 * pi * a / 16), -std::sin(2 * pi * a / 16), 0);
      const double stress = flow->wall_shear_stress(Vec3(0, 0, 1.5 * h) - radius * normal, normal)[2];
      square += std::pow(stress / (0.5 * gradient * radius) - 1, 2) / 16;
    }
    mean.shear += 0.25 * std::sqrt(square);
  }
  std::printf("R/h = %g, %s: profile %.2e, flow %.2e, wall shear stress %.2e\n", n,
              wall == Wall::staircase ? "staircase" : "interpolated", mean.profile, mean.flow, mean.shear);
  return mean;
}

TEST(InterpolatedWall, PoiseuilleConvergesAtSecondOrderWithItsShearStress) {
  const Errors coarse = poiseuille(5, Wall::interpolated), middle = poiseuille(10, Wall::interpolated),
               fine = poiseuille(20, Wall::interpolated);
  std::printf("orders: profile %.2f %.2f, flow %.2f, shear %.2f %.2f\n",
              std::log2(coarse.profile / middle.profile), std::log2(middle.profile / fine.profile),
              0.5 * std::log2(coarse.flow / fine.flow), std::log2(coarse.shear / middle.shear),
              std::log2(middle.shear / fine.shear));
  EXPECT_GT(0.5 * std::log2(coarse.profile / fine.profile), 1.8);
  EXPECT_GT(0.5 * std::log2(coarse.flow / fine.flow), 1.5);
  EXPECT_GT(0.5 * std::log2(coarse.shear / fine.shear), 0.9);
  const Errors staircase = poiseuille(10, Wall::staircase);
  EXPECT_LT(middle.profile, 0.2 * staircase.profile);
  EXPECT_LT(middle.shear, 0.2 * staircase.shear);
}

// A plane channel, tilted by 1 : 2 against the grid, so that every wall cell is cut in another way and no
// face lies on the wall: periodic in x and z, where the channel leaves on one side and enters on the other.
double tilted_channel(int n, Wall wall, bool upwind = false) {
  const double length = 20, half = 3, gradient = 0.5;
  Grid grid;
  grid.h = 0.5 * length / n;
  grid.cells = {n, 3, 2 * n};
  Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
  FlowParameters parameters;
  parameters.density = density;
  parameters.viscosity = 5 * viscosity;
  parameters.wall = wall;
  parameters.wall_upwind = upwind;
  Flow flow(MPI_COMM_SELF, grid, boundaries, parameters);
  const Vec3 along = Vec3(1, 0, 2).normalized(), across = Vec3(2, 0, -1).normalized();
  const double pitch = 0.5 * length * across[0];
  const auto offset = [&](const Vec3& x) {  // from the middle of the nearest channel
    const double s = x.dot(across) - 0.37;
    return s - pitch * std::round(s / pitch);
  };
  flow.solids().set_lumen([&](const Vec3& x) { return std::abs(offset(x)) - half; });
  const auto exact = [&](const Vec3& x) {
    const double s = offset(x);
    return std::abs(s) < half ? gradient / (2 * parameters.viscosity) * (half * half - s * s) : 0.0;
  };
  flow.set_velocity([&](int d, const Vec3& x) { return exact(x) * along[d]; });
  for (int d = 0; d < 3; ++d) flow.force()[d].fill(gradient * along[d]);
  const double top = gradient / (2 * parameters.viscosity) * half * half;
  const double dt = std::min(0.08 * grid.h * grid.h * density / parameters.viscosity, 0.25 * grid.h / top);
  for (double t = 0; t < 0.3; t += dt) flow.step(dt);
  double error = 0, size = 0;
  for (int d : {0, 2}) {
    for (int k = 0; k < grid.cells[2]; ++k) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        const double value = exact(grid.position(d, i, 1, k)) * along[d];
        if (value == 0) continue;
        error += std::pow(flow.velocity()[d](i, 1, k) - value, 2);
        size += value * value;
      }
    }
  }
  std::printf("tilted, %d cells, %s%s: %.3e\n", n, wall == Wall::staircase ? "staircase" : "interpolated",
              upwind ? ", upwind1 beside it" : "", std::sqrt(error / size));
  return std::sqrt(error / size);
}

TEST(InterpolatedWall, TiltedChannelConvergesAtSecondOrder) {
  const double coarse = tilted_channel(16, Wall::interpolated),
               middle = tilted_channel(32, Wall::interpolated), fine = tilted_channel(64, Wall::interpolated);
  std::printf("orders %.2f %.2f\n", std::log2(coarse / middle), std::log2(middle / fine));
  EXPECT_GT(0.5 * std::log2(coarse / fine), 1.7);
  EXPECT_LT(middle, 0.3 * tilted_channel(32, Wall::staircase));
}

// Of first order in a layer of one cell: it takes nothing from the order of the whole.
TEST(InterpolatedWall, TiltedChannelStaysOfSecondOrderWithUpwindingBesideIt) {
  const double coarse = tilted_channel(16, Wall::interpolated, true),
               middle = tilted_channel(32, Wall::interpolated, true),
               fine = tilted_channel(64, Wall::interpolated, true);
  std::printf("orders %.2f %.2f\n", std::log2(coarse / middle), std::log2(middle / fine));
  EXPECT_GT(0.5 * std::log2(coarse / fine), 1.7);
}

std::complex<double> bessel(int order, std::complex<double> z) {
  std::complex<double> term = order == 0 ? 1.0 : z / 2.0, sum = term;
  for (int m = 1; m < 80; ++m) {
    term *= -(z * z) / (4.0 * m * (m + order));
    sum += term;
  }
  return sum;
}

TEST(InterpolatedWall, WomersleyConvergesAtSecondOrder) {
  const double alpha = 6, period = 2 * pi * radius * radius * density / (alpha * alpha * viscosity);
  const double omega = 2 * pi / period, gradient = 3;
  const std::complex<double> i(0, 1), root = std::pow(i, 1.5) * alpha;
  const auto exact = [&](double r, double t) {
    return std::real(gradient / (i * density * omega) *
                     (1.0 - bessel(0, root * (r / radius)) / bessel(0, root)) * std::exp(i * omega * t));
  };
  const std::complex<double> flow_exact = pi * radius * radius * gradient / (i * density * omega) *
                                          (1.0 - 2.0 * bessel(1, root) / (root * bessel(0, root)));
  std::vector<double> errors;
  for (double n : {6.0, 12.0, 24.0}) {
    auto flow = pipe(n, Vec3(0.27, 0.41, 0), Wall::interpolated);
    flow->set_velocity([&](int d, const Vec3& x) {
      const double r = std::hypot(x[0], x[1]);
      return d == 2 && r < radius ? exact(r, 0) : 0;
    });
    const int steps = static_cast<int>(
        std::ceil(std::max(200.0, period / (0.08 * std::pow(flow->grid().h, 2) * density / viscosity))));
    const double dt = period / steps;
    std::complex<double> measured = 0;
    for (int step = 0; step < 2 * steps; ++step) {
      flow->force()[2].fill(gradient * std::cos(omega * (step + 0.5) * dt));
      flow->step(dt);
      if (step >= steps)
        measured += 2.0 / steps * flow->flow_through(1) * std::exp(-i * omega * ((step + 1) * dt));
    }
    errors.push_back(profile_error(*flow, [&](double r) { return exact(r, 0); }));
    std::printf("R/h = %g: profile error %.2e, flow amplitude ratio %.4f, phase error %.4f rad\n", n,
                errors.back(), std::abs(measured) / std::abs(flow_exact), std::arg(measured / flow_exact));
  }
  EXPECT_GT(0.5 * std::log2(errors[0] / errors[2]), 1.7);
}

}  // namespace
