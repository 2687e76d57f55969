// 0D models solved together with the fluid: the small system of the ends, the flow's answer to its known
// pressures, and both together.
#include <gtest/gtest.h>

#include <cmath>

#include "core/errors.hpp"
#include "coupling/implicit_ends.hpp"

namespace valsalva::coupling {
namespace {

using fluid::End;
using fluid::Flow;

TEST(Meet, ResistancesThatActOnEachOther) {
  Eigen::MatrixXd taken(2, 2);
  taken << 3, -2, -2, 5;
  for (const double scale : {1e-6, 1.0, 1e9}) {
    const std::vector<Answer> answers{[&](double q) { return 7 + 2 * scale * q; },
                                      [&](double q) { return -1 + scale * q; }};
    const std::vector<double> p = meet(taken, {70, -20}, {10, 4}, answers);
    const double q0 = 70 - 3 * (p[0] - 10) + 2 * (p[1] - 4), q1 = -20 + 2 * (p[0] - 10) - 5 * (p[1] - 4);
    EXPECT_NEAR((p[0] - 7) / (2 * scale), q0, 1e-9 * 70);
    EXPECT_NEAR((p[1] + 1) / scale, q1, 1e-9 * 70);
  }
}

TEST(Meet, ADiodeOnEitherSideOfItsKink) {
  const auto diode = [](double q) { return q > 0 ? 100 + 1e3 * q : 100 + 1e-4 * q; };
  for (const double outflow : {-5e4, 799.0, 801.0, 5e4}) {
    const double p = meet(Eigen::MatrixXd::Constant(1, 1, 40), {outflow}, {80}, {diode})[0];
    const double q = outflow - 40 * (p - 80);
    EXPECT_NEAR(p, diode(q), 1e-8 * std::abs(diode(q))) << outflow;
  }
}

TEST(Meet, AModelWithoutAnAnswerIsAnAlarm) {
  const auto none = [](double) { return std::nan(""); };
  EXPECT_THROW(meet(Eigen::MatrixXd::Constant(1, 1, 40), {1e4}, {80}, {none}), NumericalFailure);
}

// A vessel with a ledge in it, so that nothing is uniform; pressure known at both ends of the box, or at one
// and in an oblique plane.
struct Vessel {
  std::unique_ptr<Flow> flow;
  fluid::PressurePlace far = End::high;

  explicit Vessel(bool cells) {
    fluid::FlowParameters p;
    if (cells) p.krylov = fluid::KrylovSettings{.tolerance = 1e-12};
    const fluid::Grid grid{{12, 8, 16}, Vec3::Zero(), 1};
    flow = std::make_unique<Flow>(MPI_COMM_WORLD, grid, fluid::Boundaries{}, p);
    const int wall = flow->solids().add_body("wall");
    const fluid::Slab& slab = flow->slab();
    for (int d = 0; d < 4; ++d)
      for (int k = 0; k < (d == 2 ? slab.w_planes() : slab.planes); ++k)
        for (int j = 0; j < 8; ++j)
          for (int i = 0; i < 12; ++i) {
            const Vec3 x = grid.position(d, i, j, k + slab.first);
            if (x[0] < 3 || x[0] > 10 || (x[0] > 6 && x[2] > 5 && x[2] < 9))
              flow->solids().claim(wall, d, i, j, k);
          }
    if (cells) far = flow->add_opening({"far", Vec3(6.5, 4, 13), Vec3(0.2, 0, 1).normalized(), 40, {}});
    flow->set_velocity([](int d, const Vec3& x) { return d == 2 ? 10 + x[0] : 0.3 * x[1]; });
    set(400, 100);
  }
  void set(double low, double high) {
    flow->set_end_pressure(End::low, low);
    if (const int* opening = std::get_if<int>(&far)) {
      flow->openings().set_pressure(*opening, high);
    } else {
      flow->set_end_pressure(End::high, high);
    }
  }
  double outflow() const {
    const int* opening = std::get_if<int>(&far);
    return opening ? flow->opening_flow(*opening) : flow->flow_through(End::high);
  }
};

class Raised : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Solvers, Raised, testing::Bool(),
                         [](const auto& cells) { return cells.param ? "FluidCells" : "WholeBox"; });

TEST_P(Raised, PressuresAreAsThoughKnownBefore) {
  Vessel before(GetParam()), after(GetParam());
  const double dt = 2e-4;
  for (Vessel* vessel : {&before, &after}) vessel->flow->step(dt);
  before.set(350, 190);
  // Penalised faces would answer to the gradient of the known pressure, but not to the rise.
  before.flow->predict(dt, {.penalise = GetParam()});
  const fluid::StepReport expected = before.flow->project(dt);
  after.flow->after_projection([&](double step_s, const fluid::StepReport&) {
    return after.flow->raise({{End::low, -50}, {after.far, 90}}, step_s);
  });
  after.flow->predict(dt, {.penalise = GetParam()});
  const fluid::StepReport report = after.flow->project(dt);
  EXPECT_EQ(after.flow->known_pressure(End::low), 350);
  EXPECT_EQ(after.flow->known_pressure(after.far), 190);
  EXPECT_NEAR(report.kinetic_energy / expected.kinetic_energy, 1, 1e-9);
  EXPECT_NEAR(report.cfl / expected.cfl, 1, 1e-9);
  const fluid::Slab& slab = after.flow->slab();
  double velocity = 0, pressure = 0;
  for (int k = 0; k < slab.planes; ++k)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 12; ++i) {
        for (int d = 0; d < 3; ++d)
          velocity = std::max(
              velocity, std::abs(after.flow->velocity()[d](i, j, k) - before.flow->velocity()[d](i, j, k)));
        if (after.flow->solids().owner(3, i, j, k) == 0)
          pressure = std::max(pressure,
                              std::abs(after.flow->pressure()(i, j, k) - before.flow->pressure()(i, j, k)));
      }
  EXPECT_LT(velocity, 1e-7 * report.max_speed);
  EXPECT_LT(pressure, 1e-7 * 400);
}

TEST_P(Raised, AResistanceOfAnySizeObeysOhm) {
  for (const double resistance : {1e-4, 1e-2, 1.0, 1e9}) {  // Pa s/mm3
    Vessel vessel(GetParam());
    ImplicitEnds ends(*vessel.flow);
    ends.add({vessel.far, [&] { return vessel.outflow(); }});
    const Answer answer = [&](double outflow) { return 100 + resistance * outflow; };
    vessel.flow->after_projection(
        [&](double dt, const fluid::StepReport& found) { return ends.settle(dt, found, {answer}); });
    double largest = 0;
    for (int n = 0; n < 300; ++n) {
      largest = std::max(largest, vessel.flow->step(1e-4).max_speed);
      const double outflow = ends.outflow(0);
      EXPECT_NEAR((vessel.flow->known_pressure(vessel.far) - 100) / resistance, outflow,
                  1e-6 * (1e3 + outflow));
    }
    if (resistance >= 1) {
      EXPECT_NEAR(ends.outflow(0), 300 / resistance, 0.02 * 300 / resistance + 1e-6);
    }
    EXPECT_LT(largest, 2500) << resistance;
  }
}

}  // namespace
}  // namespace valsalva::coupling
