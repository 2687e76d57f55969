#include <cmath>

#include "run_case.hpp"

using namespace valsalva;
using test::CaseRun;

namespace {

Vec3 momentum_of(const CaseRun& run) {
  Vec3 sum = Vec3::Zero();
  const structure::System& system = *run.scene.system;
  for (std::size_t a = 0; a < system.nodes(); ++a)
    sum += system.mass(static_cast<int>(a)) * system.state.v[a];
  return sum;
}

}  // namespace

TEST(DryContact, BlockSlidesWithTheAnalyticAcceleration) {
  CaseRun run("sliding_block.toml");
  run.to_end();
  const double expected = 9810 * (std::sin(M_PI / 6) - 0.3 * std::cos(M_PI / 6));
  EXPECT_NEAR(run.probe("speed_mm_per_s") / 0.1, expected, 0.01 * expected);
}

TEST(DryContact, BlockSticksBelowTheAngleOfFriction) {
  // tan 30 = 0.577
  CaseRun sticks("sliding_block.toml",
                 {{"friction = 0.3", "friction = 0.7"}, {"damping_per_s = 0", "damping_per_s = 2000"}});
  sticks.to_end();
  const double weight = 4e-3 * 9810 * 1e-6;  // N
  EXPECT_LT(std::abs(sticks.probe("slide_mm")), 0.01);
  EXPECT_LT(std::abs(sticks.probe("speed_mm_per_s")), 0.05);
  EXPECT_NEAR(sticks.probe("friction_N"), -weight * 0.5, 0.01 * weight);
  EXPECT_NEAR(sticks.probe("normal_N"), weight * std::cos(M_PI / 6), 0.01 * weight);
}

TEST(DryContact, BouncingBoxKeepsItsEnergy) {
  CaseRun run("bouncing_box.toml");
  double most = 0, least = 1e300, hits = 0, sideways = 0;
  bool falling = true;
  for (long step = 0; !run.march->finished(); ++step) {
    const double before = run.march->kinetic_nJ();
    run.march->step();
    if (step % 50 || step == 0) continue;
    // Velocities stand half a step before and after the positions.
    const double energy = 0.5 * (before + run.march->kinetic_nJ()) + run.march->stored_nJ();
    most = std::max(most, energy);
    least = std::min(least, energy);
    const Vec3 momentum = momentum_of(run);
    sideways = std::max(sideways, momentum.head<2>().norm());
    if ((momentum.z() < 0) != falling) {
      falling = !falling;
      ++hits;
    }
  }
  EXPECT_EQ(run.march->steps(), 100000);
  EXPECT_GT(hits, 10);
  const double start = 0.5 * 1e-3 * 500 * 500;
  std::printf("energy from %.5f to %.5f of the start, %.0f bounces\n", least / start, most / start, hits);
  EXPECT_GT(least, 0.98 * start);
  EXPECT_LT(most, 1.02 * start);
  EXPECT_LT(sideways, 1e-9 * 1e-3 * 500);
}
