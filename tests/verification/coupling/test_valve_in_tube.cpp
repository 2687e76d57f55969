// A trileaflet valve in a straight tube closes under a rising aortic pressure: the coupled solver on a coarse
// grid, a few milliseconds.
#include <gtest/gtest.h>

#include <cmath>

#include "mpi_for_all.hpp"
#include "valve_rig.hpp"

namespace {

using namespace valsalva;
using units::pa_per_mmHg;

// The valve and its checks of every step.
struct Rig : test::ValveRig {
  void run_to(double end_s) {
    ValveRig::run_to(end_s, [](const coupling::ImmersedStep& step) {
      EXPECT_LT(step.dt_s, step.critical_s);
      EXPECT_LE(step.fluid.cfl, coupling::StepLimits{}.cfl);
    });
  }
};

TEST(ValveInTube, ClosesHoldsPressureAndRestartsBitwise) {
  Rig rig;
  rig.run_to(0.010);
  state::State saved;
  saved.restart = rig.system->save();
  rig.run_to(0.016);

  // Holds: pressure above the valve follows the aorta, below it stays low; the leaflets carry the difference.
  const double above = rig.flow->mean_pressure(26) / pa_per_mmHg,
               below = rig.flow->mean_pressure(3) / pa_per_mmHg;
  EXPECT_GT(above, 20);
  EXPECT_GT(above - below, 0.6 * above);
  EXPECT_LT(rig.system->shell()->pull_on_clamps().z(), 0);
  // Without compliance the closed valve rings; it lets nothing through for long.
  EXPECT_LT(std::abs(rig.flow->flow_through(fluid::End::high)) / 1e3, 250);
  EXPECT_LT(rig.system->shell()->edge_stretch(rig.system->shell()->x()).largest, 1.4);
  EXPECT_LT(rig.flow->divergence(), 1e-6);

  Rig again;
  again.time_s = 0.010;
  again.system->load(saved);
  again.run_to(0.016);
  ASSERT_EQ(again.system->steps(), rig.system->steps());
  const Points &x = rig.system->shell()->x(), &y = again.system->shell()->x();
  for (std::size_t a = 0; a < x.size(); ++a) ASSERT_EQ(x[a], y[a]) << "node " << a;
  EXPECT_EQ(rig.flow->velocity()[2].data(), again.flow->velocity()[2].data());
}

TEST(ValveInTube, StabilityOperatorIsSymmetricAndPositive) {
  Rig rig;
  rig.run_to(0.004);
  coupling::ImmersedShell& shell = *rig.system->shell();
  shell.update_tangent();
  coupling::Transfer transfer(rig.flow->slab(), coupling::kernel_from("ib4"));
  transfer.locate(shell.x());
  fluid::FaceField scratch(rig.flow->slab());
  const auto mobility = [&](const Points& f) {
    Points v;
    scratch.fill(0);
    transfer.spread(f, scratch);
    transfer.interpolate(scratch, v);
    return v;
  };
  const auto stiffness = [&](const Points& y) {
    Points f;
    shell.tangent_product(y, f);
    return f;
  };
  const auto dot = [](const Points& a, const Points& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
  };
  for (int trial = 0; trial < 3; ++trial) {
    Points y = shell.x(), z = shell.x();
    for (std::size_t a = 0; a < y.size(); ++a) {
      y[a] = Vec3(std::sin(1.7 * a + trial), std::cos(2.3 * a), std::sin(0.9 * a + 2.0 * trial));
      z[a] = Vec3(std::cos(0.7 * a), std::sin(3.1 * a + trial), std::cos(1.9 * a));
    }
    const Points ky = stiffness(y), kz = stiffness(z), my = mobility(y), mz = mobility(z);
    EXPECT_NEAR(dot(z, ky), dot(y, kz), 1e-9 * std::sqrt(dot(y, ky) * dot(z, kz)));
    EXPECT_NEAR(dot(z, my), dot(y, mz), 1e-9 * std::sqrt(dot(y, my) * dot(z, mz)));
    EXPECT_GT(dot(y, ky), 0);
    EXPECT_GT(dot(y, my), 0);
    // The product that limits the step: K M K is symmetric and positive, too.
    EXPECT_NEAR(dot(kz, mobility(ky)), dot(ky, mobility(kz)),
                1e-9 * std::sqrt(dot(ky, mobility(ky)) * dot(kz, mobility(kz))));
  }
}

}  // namespace
