// The step controller: the CFL limit holds for every step, however suddenly the flow is driven.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "coupling/immersed_flow.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::coupling;

struct Tube {
  fluid::Flow flow{MPI_COMM_SELF, {{14, 14, 20}, Vec3(-7, -7, -10), 1.0}, {}, {}};
  std::unique_ptr<ImmersedFlow> system;
  double time_s = 0;
  int repeats = 0;
  double largest_cfl = 0, largest_speed = 0;

  explicit Tube(const ImmersedFlowSettings& settings = {}) {
    flow.solids().set_lumen([](const Vec3& x) { return std::hypot(x[0] - 0.2 * x[2], x[1]) - 5; });
    system = std::make_unique<ImmersedFlow>(flow, nullptr, settings);
  }

  // From rest under 80 mmHg at once, then blows of half the pressure either way every millisecond.
  void run(int steps) {
    for (int n = 0; n < steps; ++n) {
      const ImmersedStep step = system->step(1, [&](double dt) {
        const double at = time_s + dt;
        flow.set_end_pressure(fluid::End::low, 10000 * (std::fmod(at, 2e-3) < 1e-3 ? 1.0 : -0.5));
      });
      time_s += step.dt_s;
      repeats += step.repeats;
      largest_cfl = std::max(largest_cfl, step.fluid.cfl);
      largest_speed = std::max(largest_speed, step.fluid.max_speed);
    }
  }
};

TEST(ImmersedFlow, KeepsTheCflLimitInEveryStep) {
  ImmersedFlowSettings settings;
  settings.limits.largest_s = 2e-3;
  settings.limits.cfl = 0.3;
  Tube tube(settings);
  tube.run(150);
  EXPECT_LE(tube.largest_cfl, 0.3);
  EXPECT_GT(tube.largest_cfl, 0.25);
  EXPECT_GT(tube.repeats, 0);
  EXPECT_GT(tube.largest_speed, 1000);
}

TEST(ImmersedFlow, ContinuesBitwiseAroundRepeatedSteps) {
  ImmersedFlowSettings settings;
  settings.limits.largest_s = 2e-3;
  Tube whole(settings), resumed(settings);
  whole.run(3);
  state::State stored;
  stored.restart = whole.system->save();
  resumed.time_s = whole.time_s;
  const int before = whole.repeats;
  whole.run(60);
  EXPECT_GT(whole.repeats, before);
  resumed.system->load(stored);
  resumed.run(60);
  const auto a = whole.system->save(), b = resumed.system->save();
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, array] : a) EXPECT_EQ(array.data, b.at(name).data) << name;
}

TEST(ImmersedFlow, FailsWhenNoStepIsSmallEnough) {
  ImmersedFlowSettings settings;
  settings.limits.smallest_s = 1e-4;
  settings.limits.largest_s = 1e-3;
  Tube tube(settings);
  EXPECT_THROW(tube.run(100), NumericalFailure);
}

}  // namespace
