// A block on a floor with Coulomb friction: it stays below the angle of friction, and above it slides with
// the exact acceleration; thrown, it stops after the exact way.
#include <gtest/gtest.h>

#include "scenes.hpp"

namespace valsalva::contact {
namespace {

constexpr double mu = 0.3, g = 9810;  // mm/s2

BlockScene resting_block() {
  return BlockScene(2, 1, {2, 2, 1}, 1e6, 0.045, mu, 50, false, 4);
}

structure::IntegratorSettings settings() {
  structure::IntegratorSettings s;
  s.step_s = 2e-6;
  s.mass_scaling = false;
  s.scaling_interval = 1;
  return s;
}

/// Lets the block come to rest on the floor under gravity's normal part.
void settle(structure::Integrator& integrator) {
  integrator.set_damping(1000);
  for (int i = 0; i < 4000; ++i) integrator.step();
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
    for (int i = 0; i < 5000; ++i) {
      integrator.step();
      most = std::max(most, std::abs(scene.centre().x() - start));
    }
    std::printf("tan of the angle %.2f mu: moved %.1e mm in 20 ms (range of stick %.1e mm)\n", part, most,
                0.05 * BlockScene::h);
    EXPECT_LT(most, 1e-4);
  }
}

// Open: docs/verification/contact.md.
TEST(SlidingBlock, DISABLED_SlidesAboveItWithTheExactAcceleration) {
  std::printf("| tan of the angle / mu | acceleration mm/s2 | g (sin - mu cos) |\n|---|---|---|\n");
  for (double part : {1.2, 1.5, 3.0}) {
    BlockScene scene = resting_block();
    const double angle = std::atan(part * mu);
    scene.gravity(g * Vec3(std::sin(angle), 0, -std::cos(angle)));
    structure::Integrator integrator(scene.system, scene.terms, settings());
    settle(integrator);
    scene.set_velocity(Vec3::Zero());
    for (int i = 0; i < 500; ++i) integrator.step();  // beyond the range of stick
    const double before = scene.velocity().x(), time = scene.system.state.time_s;
    for (int i = 0; i < 3000; ++i) integrator.step();
    const double rate = (scene.velocity().x() - before) / (scene.system.state.time_s - time);
    const double exact = g * (std::sin(angle) - mu * std::cos(angle));
    std::printf("| %.1f | %.1f | %.1f |\n", part, rate, exact);
    EXPECT_NEAR(rate, exact, 0.01 * mu * g);
  }
}

// Open: docs/verification/contact.md.
TEST(SlidingBlock, DISABLED_StopsAfterTheExactWayAndThenRests) {
  BlockScene scene = resting_block();
  scene.gravity(Vec3(0, 0, -g));
  structure::Integrator integrator(scene.system, scene.terms, settings());
  settle(integrator);
  const double speed = 100, work_before = scene.contact->friction_work_nJ();
  const Vec3 start = scene.centre();
  scene.add_velocity(Vec3(0.8 * speed, 0.6 * speed, 0));
  const double way = speed * speed / (2 * mu * g), duration = speed / (mu * g);
  double time = scene.system.state.time_s;
  while (scene.system.state.time_s < time + 0.5 * duration) integrator.step();
  const double half = scene.velocity().head<2>().norm();
  while (scene.system.state.time_s < time + 1.2 * duration) integrator.step();
  const Vec3 stopped = scene.centre();
  const double moved = (stopped - start).norm(), energy = 0.5 * scene.mass() * speed * speed;
  const double lost = scene.contact->friction_work_nJ() - work_before;
  double creep = 0;
  for (int i = 0; i < 5000; ++i) {
    integrator.step();
    creep = std::max(creep, (scene.centre() - stopped).norm());
  }
  std::printf(
      "half time: %.3f mm/s (exact %.3f); way %.4f mm (exact %.4f); friction %.3f nJ of %.3f; then %.1e mm "
      "in 20 ms\n",
      half, 0.5 * speed, moved, way, lost, energy, creep);
  EXPECT_NEAR(half, 0.5 * speed, 0.01 * speed);
  EXPECT_NEAR(moved, way, 0.01 * way);
  EXPECT_NEAR(lost, energy, 0.02 * energy);
  EXPECT_LT(creep, 2 * 0.05 * BlockScene::h);
  EXPECT_LT(std::abs((stopped - start).x() * 0.6 - (stopped - start).y() * 0.8), 0.01 * way);
}

}  // namespace valsalva::contact
