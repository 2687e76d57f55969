// An elastic block bouncing between floor and ceiling: energy and momentum over 1e5 steps.
#include <gtest/gtest.h>

#include "scenes.hpp"

namespace valsalva::contact {

TEST(Bounce, EnergyAndMomentumOver100000Steps) {
  BlockScene scene(2, 1, {2, 2, 1}, 1e6, 0.2, 0, 2e4, true, 4);
  scene.set_velocity(Vec3(20, -10, -300));
  structure::IntegratorSettings settings;
  settings.step_s = 2e-6;
  settings.mass_scaling = false;
  settings.scaling_interval = 1;
  structure::Integrator integrator(scene.system, scene.terms, settings);
  Vec3 first = Vec3::Zero(), impulse = Vec3::Zero(), last = Vec3::Zero();
  double start = 0, worst = 0, worst_momentum = 0, early = 0, late = 0, passed = 0;
  int bounces = 0;
  bool touching = false;
  constexpr int steps = 100000;
  for (int i = 0; i < steps; ++i) {
    const Vec3 momentum = scene.mass() * scene.velocity();
    if (i == 0) first = momentum;
    const double stored_before = i > 0 ? integrator.energies().stored : 0;
    const double kinetic_before = integrator.energies().kinetic;
    integrator.step();
    // Energy at full steps: the kinetic energies of the half steps around it, averaged.
    const double energy =
        integrator.energies().stored + 0.5 * (kinetic_before + integrator.energies().kinetic);
    (void)stored_before;
    if (i == 1) start = energy;
    if (i > 1) worst = std::max(worst, std::abs(energy - start) / start);
    if (i > 1 && i < steps / 10) early += (energy - start) / start / (steps / 10 - 2);
    if (i >= steps - steps / 10) late += (energy - start) / start / (steps / 10);
    // What the floors push is what the block's momentum changes.
    Vec3 on_floors = Vec3::Zero();
    for (const auto& floor : scene.floors)
      for (int a = floor.begin(); a < floor.end(); ++a) on_floors += integrator.forces().force[a];
    impulse -= settings.step_s * on_floors;
    last = scene.mass() * scene.velocity();
    worst_momentum = std::max(worst_momentum, (last - first - impulse).norm());
    passed += settings.step_s * on_floors.norm();
    const bool now = scene.contact->report().active > 0;
    bounces += now && !touching;
    touching = now;
  }
  std::printf(
      "%d bounces; energy within %.1e, mean of the first tenth %.1e, of the last %.1e; momentum within "
      "%.1e of the impulses passed\n",
      bounces, worst, early, late, worst_momentum / passed);
  EXPECT_GT(bounces, 100);
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(std::abs(late - early), 0.005);
  EXPECT_LT(worst_momentum, 1e-10 * passed);
}

}  // namespace valsalva::contact
