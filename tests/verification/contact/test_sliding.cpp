// A block on a floor with Coulomb friction: it stays below the angle of friction, and above it slides with
// the exact acceleration; thrown, it stops after the exact way.
#include <gtest/gtest.h>

#include "scenes.hpp"

namespace valsalva::contact {
namespace {

constexpr double mu = 0.3, g = 9810;  // mm/s2

constexpr double reach = 4;
constexpr int cells = 31;  // of the floor

BlockScene resting_block() {
  return BlockScene(2, 1, {4, 4, 2}, 1e6, 0.045, mu, 50, false, reach, cells);
}

structure::IntegratorSettings settings() {
  structure::IntegratorSettings s;
  s.step_s = 7.5e-6;
  s.mass_scaling = false;
  s.scaling_interval = 1;
  return s;
}

/// Lets the block come to rest on the floor under gravity's normal part.
void settle(structure::Integrator& integrator) {
  integrator.set_damping(1000);
  for (int i = 0; i < 2000; ++i) integrator.step();
  integrator.set_damping(0);
}

}  // namespace

TEST(SlidingBlock, StaysBelowTheAngleOfFriction) {
  for (double part : {0.5, 0.9}) {
    BlockScene scene = resting_block();
    const double angle = std::atan(part * mu);
    scene.gravity(g * Vec3(std::sin(angle), 0, -std::cos(angle)));
    structure::Integrator integrator(scene.system, scene.terms, settings());
    settle(integrator);
    const double start = scene.centre().x();
    double most = 0;
    for (int i = 0; i < 2700; ++i) {
      integrator.step();
      most = std::max(most, std::abs(scene.centre().x() - start));
    }
    std::printf("tan of the angle %.2f mu: moved %.1e mm in 20 ms (range of stick %.1e mm)\n", part, most,
                0.05 * BlockScene::h);
    EXPECT_LT(most, 1e-4);
  }
}

// Over whole cells of the floor: in between, the block rides over bumps of the normal forces.
TEST(SlidingBlock, SlidesAboveItWithTheExactAcceleration) {
  std::printf(
      "| tan of the angle / mu | acceleration mm/s2 | g (sin - mu cos) | off, of mu g "
      "|\n|---|---|---|---|\n");
  for (double part : {1.2, 1.5, 3.0}) {
    BlockScene scene = resting_block();
    const double angle = std::atan(part * mu);
    scene.gravity(g * Vec3(std::sin(angle), 0, -std::cos(angle)));
    structure::Integrator integrator(scene.system, scene.terms, settings());
    settle(integrator);
    scene.set_velocity(Vec3(100, 0, 0));
    const auto slide_to = [&](double x) {
      while (scene.centre().x() < x) integrator.step();
    };
    slide_to(0.05);  // beyond the range of stick
    const double before = scene.velocity().x(), time = scene.system.state.time_s;
    slide_to(0.05 + 4 * 2 * reach / cells);
    const double rate = (scene.velocity().x() - before) / (scene.system.state.time_s - time);
    const double exact = g * (std::sin(angle) - mu * std::cos(angle));
    std::printf("| %.1f | %.1f | %.1f | %.4f |\n", part, rate, exact, (rate - exact) / (mu * g));
    EXPECT_NEAR(rate, exact, 0.01 * mu * g);
  }
}

TEST(SlidingBlock, StopsAfterTheExactWayAndThenRests) {
  BlockScene scene = resting_block();
  scene.gravity(Vec3(0, 0, -g));
  structure::Integrator integrator(scene.system, scene.terms, settings());
  settle(integrator);
  const double speed = 100, work_before = scene.contact->friction_work_nJ();
  const Vec3 start = scene.centre();
  const double sinking = scene.velocity().z();
  scene.add_velocity(Vec3(0.8 * speed, 0.6 * speed, 0));
  const double way = speed * speed / (2 * mu * g), duration = speed / (mu * g);
  double time = scene.system.state.time_s;
  while (scene.system.state.time_s < time + 0.5 * duration) integrator.step();
  // Bumps set it bouncing a little: the normal impulse is m (g t + v_z).
  const double half = scene.velocity().head<2>().norm(), upwards = scene.velocity().z() - sinking;
  while (scene.system.state.time_s < time + 1.2 * duration) integrator.step();
  const Vec3 stopped = scene.centre();
  const double moved = (stopped - start).norm(), energy = 0.5 * scene.mass() * speed * speed;
  const double lost = scene.contact->friction_work_nJ() - work_before;
  double creep = 0;
  for (int i = 0; i < 2700; ++i) {
    integrator.step();
    creep = std::max(creep, (scene.centre() - stopped).norm());
  }
  std::printf(
      "half time: %.3f mm/s, %.3f with the vertical one (exact %.3f); way %.4f mm (exact %.4f); friction "
      "%.3f nJ of %.3f; then %.1e mm "
      "in 20 ms\n",
      half, half + mu * upwards, 0.5 * speed, moved, way, lost, energy, creep);
  EXPECT_NEAR(half + mu * upwards, 0.5 * speed, 0.01 * speed);
  EXPECT_NEAR(moved, way, 0.01 * way);
  EXPECT_NEAR(lost, energy, 0.02 * energy);
  EXPECT_LT(creep, 2 * 0.05 * BlockScene::h);
  EXPECT_LT(std::abs((stopped - start).x() * 0.6 - (stopped - start).y() * 0.8), 0.01 * way);
}

}  // namespace valsalva::contact
