// Tubes cut open on oblique planes: developed flow, reversals, and a plane on faces against a side of the
// box.
#include <gtest/gtest.h>

#include "tube.hpp"

using namespace valsalva;
using namespace valsalva::fluid;
using test::Tube;

namespace {

constexpr double pi = std::numbers::pi;

// The largest |u| in the fluid's cells.
double largest_magnitude(const Flow& flow) {
  double largest = 0;
  const auto& n = flow.grid().cells;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        if (flow.solids().owner(3, i, j, k) != 0) continue;
        double squares = 0;
        for (int d = 0; d < 3; ++d) {
          const Field& u = flow.velocity()[d];
          squares += std::pow(0.5 * (u(i, j, k) + u(i + (d == 0), j + (d == 1), k + (d == 2))), 2);
        }
        largest = std::max(largest, squares);
      }
    }
  }
  return std::sqrt(largest);
}

struct Developed {
  double drop, flow, profile;  ///< over what they should be, less 1; profile: rms error of the largest speed
};

// From developed flow of the mean speed on, until the grid's own steady flow stands.
Developed developed(double h, bool flow_driven, double mean) {
  Tube tube;
  tube.h = h;
  tube.flow_at_low = flow_driven;
  auto flow = tube.flow();
  const double area = pi * tube.radius * tube.radius;
  const double slope = 8 * tube.viscosity * mean / (tube.radius * tube.radius);
  if (flow_driven) {
    flow->openings().set_flow(0, -mean * area);
  } else {
    flow->openings().set_pressure(0, slope * tube.length);
  }
  flow->set_velocity([&](int d, const Vec3& x) { return 2 * mean * tube.profile(x) * tube.axis[d]; });
  flow->set_pressure([&](const Vec3& x) { return slope * (0.5 * tube.length - tube.along(x)); });
  const double dt = 0.07 * h * h * tube.density / tube.viscosity;
  for (double t = 0; t < 1.2; t += dt) flow->step(dt);
  const auto p = flow->pressure_at(Points{-0.25 * tube.length * tube.axis, 0.25 * tube.length * tube.axis});
  double squares = 0, count = 0;
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < flow->grid().cells[2]; ++k) {
      for (int j = 0; j < flow->grid().cells[1]; ++j) {
        for (int i = 0; i < flow->grid().cells[0]; ++i) {
          if (flow->solids().owner(d, i, j, k) != 0) continue;
          const Vec3 x = flow->grid().position(d, i, j, k);
          squares += std::pow(flow->velocity()[d](i, j, k) / (2 * mean) - tube.profile(x) * tube.axis[d], 2);
          count += 1. / 3;
        }
      }
    }
  }
  const Developed out{(p[0] - p[1]) / (0.5 * tube.length * slope) - 1,
                      flow->opening_flow(1) / (mean * area) - 1, std::sqrt(squares / count)};
  std::printf(
      "%s, R/h = %.0f: pressure drop %+.4f, flow %+.6f, profile %.4f, %d iterations, %.0f of %zu cells\n",
      flow_driven ? "flow" : "pressure", tube.radius / h, out.drop, out.flow, out.profile,
      flow->pressure_iterations(), flow->pressure_unknowns(), flow->grid().all_cells());
  EXPECT_NEAR(flow->opening_flow(0) + flow->opening_flow(1), 0, 1e-6 * mean * area);
  return out;
}

}  // namespace

TEST(ObliqueTube, CarriesAGivenFlow) {
  const Developed coarse = developed(0.75, true, 4), fine = developed(0.375, true, 4);
  EXPECT_LT(std::abs(fine.drop), 0.02);
  EXPECT_LT(fine.profile, 0.02);
  EXPECT_GT(std::log2(std::abs(coarse.drop) / std::abs(fine.drop)), 1.6);
}

TEST(ObliqueTube, CarriesTheFlowOfItsPressure) {
  const Developed coarse = developed(0.75, false, 0.01), fine = developed(0.375, false, 0.01);
  EXPECT_LT(std::abs(fine.flow), 0.02);
  EXPECT_GT(std::log2(std::abs(coarse.flow) / std::abs(fine.flow)), 1.6);
}

TEST(ObliqueTube, StaysTameWhenThePressureReverses) {
  for (const auto& [widening, bulge, wall] :
       {std::tuple{0.0, 0.0, Wall::staircase}, std::tuple{0.1, 0.0, Wall::staircase},
        std::tuple{0.0, 2.0, Wall::staircase}, std::tuple{0.0, 0.0, Wall::interpolated}}) {
    Tube tube;
    tube.axis = Vec3(0.3, 0.18, 1).normalized();
    tube.radius = 6;
    tube.length = 20;
    tube.h = 1;
    tube.widening = widening;
    tube.bulge = bulge;
    tube.wall = wall;
    tube.tolerance = 1e-6;
    auto flow = tube.flow();
    const double amplitude = 12000, period = 0.05, scale = std::sqrt(2 * amplitude / tube.density);
    flow->set_velocity([](int d, const Vec3& x) {
      return 60 * std::sin(1.3 * x[(d + 1) % 3] + d) * std::cos(0.7 * x[d] - 0.4 * d);
    });
    double dt = 1e-5, time = 0, fastest = 0, sum = 0, forward = 0, backward = 0, iterations = 0;
    int steps = 0;
    while (time < 1.5 * period) {
      flow->openings().set_pressure(0, amplitude * std::sin(2 * pi * time / period));
      const StepReport report = flow->step(dt);
      time += dt;
      ++steps;
      iterations += flow->pressure_iterations();
      fastest = std::max(fastest, largest_magnitude(*flow));
      sum = std::max(sum, report.max_speed);
      forward = std::max(forward, flow->opening_flow(1));
      backward = std::min(backward, flow->opening_flow(1));
      ASSERT_LT(fastest, 2 * scale) << "t = " << time;
      dt = std::min({1e-4, 1.3 * dt, 0.35 * tube.h / report.max_speed});
    }
    std::printf(
        "widening %.1f, bulge %.0f, %s: largest speed %.2f, |u|+|v|+|w| %.2f of sqrt(2 p / rho), flow %.0f "
        "to %.0f mL/s, "
        "%.1f iterations in %d steps\n",
        widening, bulge, wall == Wall::staircase ? "staircase" : "interpolated", fastest / scale, sum / scale,
        backward / 1000, forward / 1000, iterations / steps, steps);
    EXPECT_GT(forward, 0.1 * scale * flow->openings().area(1));
    EXPECT_LT(backward, -0.1 * scale * flow->openings().area(1));
  }
}

// The opening's plane on faces is the side of a shorter box.
TEST(Opening, OnFacesIsASideOfTheBox) {
  for (const bool entering : {false, true}) {
    const auto make = [&](bool opening, bool krylov) {
      Grid grid;
      grid.cells = {7, 6, opening ? 18 : 12};
      grid.h = 0.5;
      Boundaries boundaries;
      const Side across = entering ? Side::slip : Side::wall;
      boundaries.side = {
          {{across, across}, {across, across}, {Side::inflow, opening ? Side::slip : Side::open}}};
      if (entering) boundaries.side[2][0] = Side::open;
      FlowParameters parameters;
      if (opening || krylov) parameters.krylov = KrylovSettings{.tolerance = 1e-13};
      auto flow = std::make_unique<Flow>(MPI_COMM_SELF, grid, boundaries, parameters);
      if (opening)
        flow->add_opening({.name = "end", .centre = Vec3(1, 1, 6), .normal = Vec3::UnitZ(), .profile = {}});
      flow->set_velocity([](int, const Vec3&) { return 0.0; });
      return flow;
    };
    const auto side = make(false, false), cells = make(false, true), cut = make(true, true);
    for (int step = 0; step < 60; ++step) {
      for (Flow* flow : {side.get(), cells.get(), cut.get()}) {
        const bool opening = flow == cut.get();
        const double pressure = 4 + 0.2 * step;
        if (!entering)
          flow->set_inflow(End::low, [&](const Vec3& x) { return 20 + 12 * std::sin(0.1 * step + x[0]); });
        if (opening) {
          flow->openings().set_pressure(0, pressure);
        } else {
          flow->set_end_pressure(End::high, pressure);
        }
        flow->step(2e-3);
      }
    }
    double largest = 0, by_cells = 0, by_cut = 0;
    for (int d = 0; d < 3; ++d) {
      for (int k = 0; k < 12; ++k) {
        for (int j = 0; j < 6; ++j) {
          for (int i = 0; i < 7; ++i) {
            const double u = side->velocity()[d](i, j, k);
            largest = std::max(largest, std::abs(u));
            by_cells = std::max(by_cells, std::abs(u - cells->velocity()[d](i, j, k)));
            by_cut = std::max(by_cut, std::abs(u - cut->velocity()[d](i, j, k)));
          }
        }
      }
    }
    EXPECT_GT(largest, 5);
    EXPECT_LT(by_cells, 1e-9 * largest) << entering;
    EXPECT_LT(by_cut, 1e-9 * largest) << entering;
    EXPECT_NEAR(cut->opening_flow(0), side->outflow(2, 1), 1e-8 * largest);
    EXPECT_NEAR(cut->openings().area(0), 7 * 6 * 0.25, 1e-12);
  }
}
