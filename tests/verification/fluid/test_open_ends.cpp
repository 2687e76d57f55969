// Open ends: stable along a staircase wall through any reversal, and right for the flow in a pipe between
// them.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <ostream>

#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double density = 1e-3, viscosity = 3.5e-3;  // g/mm3, Pa s

double rough(int d, const Vec3& x) {
  return 40 * std::sin(1.3 * x[(d + 1) % 3] + d) * std::cos(0.7 * x[d] - 0.4 * d);
}

// A vessel along z whose wall cuts the cells everywhere in another way.
struct Shape {
  const char* name;
  double tilt, widening, bulge;  // mm a mm, mm a mm, mm
  Wall wall = Wall::staircase;
  double distance(const Vec3& x) const {
    const double radius = 6 + widening * x[2] + bulge * std::exp(-x[2] * x[2] / 12);
    return std::hypot(x[0] - tilt * x[2], x[1] - 0.6 * tilt * x[2]) - radius;
  }
};

void PrintTo(const Shape& shape, std::ostream* out) {
  *out << shape.name;
}

// Kinetic energy of the open faces: what an interpolated wall carries on beyond itself is no fluid.
double open_energy(const Flow& flow) {
  const Grid& grid = flow.grid();
  double sum = 0;
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < grid.cells[2] + (d == 2); ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          if (flow.solids().owner(d, i, j, k) == 0) sum += std::pow(flow.velocity()[d](i, j, k), 2);
        }
      }
    }
  }
  return 0.5 * density * std::pow(grid.h, 3) * sum;
}

class OpenEnds : public testing::TestWithParam<Shape> {};

TEST_P(OpenEnds, GiveNoMoreEnergyThanPressureTimesFlow) {
  Grid grid;
  grid.h = 0.8;
  grid.cells = {27, 27, 26};
  grid.origin = 0.5 * grid.h * Vec3(-27 + 0.54, -27 + 0.82, -26);
  FlowParameters parameters;
  parameters.wall = GetParam().wall;
  Flow flow(MPI_COMM_SELF, grid, {}, parameters);
  flow.solids().set_lumen([&](const Vec3& x) { return GetParam().distance(x); });
  flow.set_velocity(rough);
  const double amplitude = 4000, period = 0.05;
  double dt = 1e-5, time = 0, given = flow.kinetic_energy(), most = 0, fastest = 0;
  double forward = 0, backward = 0;
  while (time < 0.2) {
    const double pressure = amplitude * std::sin(2 * pi * time / period);
    flow.set_end_pressure(End::low, pressure);
    const double before = flow.flow_through(End::low);
    const StepReport report = flow.step(dt);
    time += dt;
    const double rate = flow.flow_through(End::low);
    given += 0.5 * (before + rate) * pressure * dt;
    const double energy = parameters.wall == Wall::interpolated ? open_energy(flow) : report.kinetic_energy;
    most = std::max(most, energy);
    fastest = std::max(fastest, report.max_speed);
    forward = std::max(forward, rate);
    backward = std::min(backward, rate);
    ASSERT_LT(energy, given + 0.01 * most) << "t = " << time;
    dt = std::min({5e-5, 1.3 * dt, 0.35 * grid.h / report.max_speed});
  }
  const double scale = std::sqrt(2 * amplitude / density);  // all pressure turned into speed
  EXPECT_LT(fastest, 2 * scale);
  EXPECT_GT(forward, 0.1 * scale * flow.open_area(0));
  EXPECT_LT(backward, -0.1 * scale * flow.open_area(0));
  std::printf("%s: largest |u|+|v|+|w| %.2f of sqrt(2 p / rho), flow %.0f to %.0f mL/s\n", GetParam().name,
              fastest / scale, forward / 1000, backward / 1000);
}

INSTANTIATE_TEST_SUITE_P(Vessels, OpenEnds,
                         testing::Values(Shape{"straight", 0, 0, 0}, Shape{"tilted", 0.3, 0, 0},
                                         Shape{"widening", 0, 0.1, 0}, Shape{"narrowing", 0, -0.1, 0},
                                         Shape{"bulge", 0, 0, 2},
                                         Shape{"tilted_interpolated", 0.3, 0, 0, Wall::interpolated},
                                         Shape{"widening_interpolated", 0, 0.1, 0, Wall::interpolated},
                                         Shape{"bulge_interpolated", 0, 0, 2, Wall::interpolated}),
                         [](const auto& info) { return std::string(info.param.name); });

// A straight pipe of radius 5 mm on a grid of cells h; periodic in z, or open at both ends.
constexpr double radius = 5;

std::unique_ptr<Flow> pipe(double h, int planes, bool open) {
  Grid grid;
  grid.h = h;
  const int across = static_cast<int>(std::ceil(2.4 * radius / h));
  grid.cells = {across, across, planes};
  grid.origin = 0.5 * h * Vec3(-across + 0.54, -across + 0.82, 0);
  Boundaries boundaries;
  if (!open) boundaries.side[2] = {Side::periodic, Side::periodic};
  auto flow = std::make_unique<Flow>(MPI_COMM_SELF, grid, boundaries, FlowParameters{});
  flow->solids().set_lumen([](const Vec3& x) { return std::hypot(x[0], x[1]) - radius; });
  return flow;
}

// Flow per pressure gradient of the same staircase pipe without ends, mm3/s / (Pa/mm).
double conductance(double h) {
  auto flow = pipe(h, 4, false);
  flow->force()[2].fill(1e-3);
  const double dt = 0.06 * h * h * density / viscosity;
  for (double t = 0; t < 8; t += dt) flow->step(dt);
  return flow->flow_through(1) / 1e-3;
}

TEST(OpenPipe, TakesThePressureOfFrictionAndEntrance) {
  // From a reservoir p = 8 mu U L / R^2 + (1 + K) rho U^2 / 2; K = 1.31 far downstream of a flat entrance
  // (Hagenbach's factor; theories and experiments give 1.2 to 1.35). Friction is that of the staircase pipe,
  // and U the mean speed in the smooth pipe of that friction.
  const double length = 40;
  for (double h : {1.0, 0.5}) {
    const double of_pipe = conductance(h), area = pi * std::sqrt(8 * viscosity * of_pipe / pi);
    for (double gradient : {0.002, 0.02}) {  // Pa/mm
      auto flow = pipe(h, static_cast<int>(length / h), true);
      flow->set_end_pressure(End::low, gradient * length);
      const double dt = 0.06 * h * h * density / viscosity;
      for (double t = 0; t < 8; t += dt) flow->step(dt);
      const int planes = flow->grid().cells[2], from = planes * 3 / 4, to = planes - 3;
      const double rate = flow->flow_through(planes / 2);
      const double mean = rate / area;
      const double here = (flow->mean_pressure(from) - flow->mean_pressure(to)) / ((to - from) * h);
      const double friction = rate / of_pipe;
      const double entrance = (gradient - friction) * length / (0.5 * density * mean * mean);
      std::printf(
          "h = %.1f mm, Re %.0f: gradient over friction %.4f, 1 + K = %.2f, flow over that of friction "
          "%.3f\n",
          h, 2 * radius * mean * density / viscosity, here / friction, entrance, rate / (gradient * of_pipe));
      EXPECT_NEAR(here / friction, 1, gradient > 0.01 ? 0.04 : 0.005);
      // At the lower speed the entrance is a small difference of large numbers.
      if (gradient > 0.01) {
        EXPECT_NEAR(entrance, 2.31, 0.3);
      }
    }
  }
}

TEST(OpenPipe, OscillatesLikeThePipeWithoutEnds) {
  // Womersley flow at alpha = 6, so slow that no head counts: the ends themselves must change nothing.
  const double alpha = 6, h = 0.8, gradient = 1e-3;
  const double period = 2 * pi * radius * radius * density / (alpha * alpha * viscosity),
               omega = 2 * pi / period;
  const int planes = 30, steps = 300;
  const double dt = period / steps;
  const std::complex<double> i(0, 1);
  std::complex<double> amplitude[2];
  for (bool open : {false, true}) {
    auto flow = pipe(h, open ? planes : 4, open);
    for (int step = 0; step < 3 * steps; ++step) {
      const double now = gradient * std::cos(omega * (step + 0.5) * dt);
      if (open) {
        flow->set_end_pressure(End::low, now * planes * h);
      } else {
        flow->force()[2].fill(now);
      }
      flow->step(dt);
      if (step >= 2 * steps)
        amplitude[open] += 2.0 / steps * flow->flow_through(1) * std::exp(-i * omega * ((step + 1) * dt));
    }
  }
  const std::complex<double> ratio = amplitude[1] / amplitude[0];
  std::printf("open over periodic: amplitude %.5f, phase %.5f rad\n", std::abs(ratio), std::arg(ratio));
  EXPECT_NEAR(std::abs(ratio), 1, 0.02);
  EXPECT_NEAR(std::arg(ratio), 0, 0.02);
}

}  // namespace
