// Generalised-alpha: order, energy of a free rotating body, agreement with the explicit integrator.
#include <gtest/gtest.h>

#include <cstdio>

#include "scenes.hpp"
#include "solve/implicit.hpp"
#include "structure/beam.hpp"
#include "structure/integrator.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

// A rubber bar 4 x 1 x 1 mm (mu 1e5 Pa, 1e-3 g/mm3): its first axial vibration takes 0.46 ms, the fastest one
// of the mesh about 0.04 ms.
SolidScene bar(Shape shape, std::array<int, 3> cells) {
  return {solid_box(shape, cells, [](const Vec3& u) { return Vec3(4 * u.x(), u.y(), u.z()); }),
          neo_hookean(1e5, 5e5), Formulation::displacement};
}

// About its own centre, about an axis that is no principal one; stretched a little, so that it vibrates too.
void spin(SolidScene& scene, const Vec3& rate, double stretch) {
  const Vec3 centre(2, 0.5, 0.5);
  for (std::size_t a = 0; a < scene.system.nodes(); ++a) {
    Vec3& x = scene.system.state.x[a];
    x.x() = centre.x() + stretch * (x.x() - centre.x());
    scene.system.state.v[a] = rate.cross(x - centre);
  }
}

struct Flight {
  double worst_gain = -1, last = 0;  ///< of the energy, relative to the kinetic energy at the start
  double momentum = 0, spin = 0;     ///< largest relative change of the angular momentum
  Points x;
};

Flight fly(double step, double radius, double end) {
  SolidScene scene = bar(Shape::hex8, {4, 2, 2});
  spin(scene, Vec3(20, 30, 200), 1.001);
  solve::ImplicitSettings settings;
  settings.step_s = step;
  settings.spectral_radius = radius;
  solve::ImplicitIntegrator integrator(scene.system, scene.terms, scene.supports, settings);
  Points unused(scene.system.nodes(), Vec3::Zero());
  const double kinetic = integrator.kinetic_energy();
  const double start = kinetic + scene.solid->add_forces(scene.system.state.x, unused);
  const Vec3 spin_at_start = integrator.angular_momentum();
  Flight flight;
  while (integrator.steps() * step < end * (1 - 1e-9)) {
    integrator.step();
    flight.last = (integrator.kinetic_energy() + integrator.stored_energy() - start) / kinetic;
    flight.worst_gain = std::max(flight.worst_gain, flight.last);
    flight.spin =
        std::max(flight.spin, (integrator.angular_momentum() - spin_at_start).norm() / spin_at_start.norm());
  }
  flight.momentum = integrator.momentum().norm();
  flight.x = scene.system.state.x;
  return flight;
}

double distance(const Points& a, const Points& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

}  // namespace

TEST(GeneralisedAlpha, SecondOrderInTime) {
  // The start excites all modes of the mesh, so steps must resolve the fastest: with 1e-5 to 4e-5 s to 2 ms,
  // as this test had it first, their phase is lost and no order shows (docs/verification/solids.md).
  for (double radius : {1.0, 0.8}) {
    const double end = 1e-4;
    const Flight a = fly(1e-6, radius, end), b = fly(5e-7, radius, end), c = fly(2.5e-7, radius, end);
    const double order = std::log2(distance(a.x, b.x) / distance(b.x, c.x));
    std::printf("| spectral radius %.1f | order %.2f |\n", radius, order);
    EXPECT_GT(order, 1.75);
    EXPECT_LT(order, 2.35);
  }
}

TEST(GeneralisedAlpha, FreeRotatingBody) {
  // Half a turn and more, five and ten steps to the first axial vibration. Mass times velocity is conserved
  // to the solver's tolerance; energy and angular momentum to second order, and the energy never grows by
  // more than that.
  std::printf(
      "| spectral radius | step s | largest energy gain | energy change at the end | change of angular "
      "momentum |\n|---|---|---|---|---|\n");
  for (double radius : {1.0, 0.8, 0.5}) {
    Flight flight[2];
    for (int i = 0; i < 2; ++i) {
      const double step = i == 0 ? 1e-4 : 5e-5;
      flight[i] = fly(step, radius, 0.02);
      std::printf("| %.1f | %.0e | %.2e | %.2e | %.2e |\n", radius, step, flight[i].worst_gain,
                  flight[i].last, flight[i].spin);
      EXPECT_LT(flight[i].momentum, 1e-5);  // of 1.6 g mm/s in each half
      EXPECT_LT(flight[i].worst_gain, 0.02);
    }
    EXPECT_GT(flight[0].spin / flight[1].spin, 3) << radius;
  }
}

TEST(GeneralisedAlpha, AgreesWithExplicit) {
  // A cantilever bar, let go under its own (large) weight, at its lowest (at 4 ms it is back at its start).
  const double end = 2e-3;
  Points fine;
  {
    SolidScene scene = bar(Shape::hex8, {4, 2, 2});
    for (std::size_t a = 0; a < scene.system.nodes(); ++a)
      if (scene.system.state.x[a].x() < 1e-9) scene.system.hold(int(a));
    scene.terms.push_back(
        std::make_shared<DeadLoadTerm>("weight", weight_of(scene.system, scene.body, Vec3(0, 0, -3e6)),
                                       Points{}, [](double) { return 1.0; }));
    IntegratorSettings settings;
    settings.step_s = 2e-6;
    for (std::size_t a = 0; a < scene.system.nodes(); ++a)  // velocities stand half a step earlier
      if (!scene.system.held(int(a))) scene.system.state.v[a] = Vec3(0, 0, 3e6 * 1e-6);
    settings.mass_scaling = false;
    Integrator integrator(scene.system, scene.terms, settings);
    while (integrator.steps() * settings.step_s < end * (1 - 1e-9)) integrator.step();
    fine = scene.system.state.x;
  }
  double error[2], moved = 0;
  for (int i = 0; i < 2; ++i) {
    SolidScene scene = bar(Shape::hex8, {4, 2, 2});
    for (std::size_t a = 0; a < scene.system.nodes(); ++a)
      if (scene.system.state.x[a].x() < 1e-9) scene.system.hold(int(a));
    scene.terms.push_back(
        std::make_shared<DeadLoadTerm>("weight", weight_of(scene.system, scene.body, Vec3(0, 0, -3e6)),
                                       Points{}, [](double) { return 1.0; }));
    solve::ImplicitSettings settings;
    settings.step_s = i == 0 ? 5e-5 : 2.5e-5;
    settings.spectral_radius = 0.9;
    solve::ImplicitIntegrator integrator(scene.system, scene.terms, scene.supports, settings);
    while (integrator.steps() * settings.step_s < end * (1 - 1e-9)) integrator.step();
    error[i] = distance(scene.system.state.x, fine);
    moved = distance(scene.system.state.x, scene.solid->mesh().reference);
  }
  std::printf("| implicit step 5e-5 s | %.2e mm | 2.5e-5 s | %.2e mm | moved %.3f mm |\n", error[0], error[1],
              moved);
  EXPECT_GT(moved, 0.3);
  EXPECT_LT(error[1], 0.01 * moved);
  EXPECT_GT(error[0] / error[1], 3);
}

TEST(GeneralisedAlpha, StaticLimitAndRestart) {
  // Damped to rest, it stands where statics puts it; and a run that is interrupted gives the same bits.
  const auto make = [] {
    SolidScene scene = bar(Shape::hex8, {4, 1, 1});
    for (std::size_t a = 0; a < scene.system.nodes(); ++a)
      if (scene.system.state.x[a].x() < 1e-9) scene.system.hold(int(a));
    scene.terms.push_back(
        std::make_shared<DeadLoadTerm>("weight", weight_of(scene.system, scene.body, Vec3(0, 0, -1e6)),
                                       Points{}, [](double) { return 1.0; }));
    return scene;
  };
  SolidScene rest = make();
  rest.system.state.time_s = 0;
  solve::Statics(rest.system, rest.terms, rest.supports).settle();

  solve::ImplicitSettings settings;
  settings.step_s = 1e-3;
  settings.spectral_radius = 0.5;
  settings.damping_per_s = 1000;
  SolidScene whole = make();
  solve::ImplicitIntegrator one(whole.system, whole.terms, whole.supports, settings);
  Snapshot half;
  for (int i = 0; i < 60; ++i) {
    if (i == 5) half = one.save();
    one.step();
  }
  EXPECT_LT(distance(whole.system.state.x, rest.system.state.x), 1e-5);
  SolidScene again = make();
  solve::ImplicitIntegrator two(again.system, again.terms, again.supports, settings);
  two.restore(half);
  while (two.steps() < 60) two.step();
  EXPECT_EQ(distance(whole.system.state.x, again.system.state.x), 0);
}

TEST(GeneralisedAlpha, SpinningBeam) {
  // A beam spinning about its middle, thousand times the explicit step: rotations and positions stay
  // together.
  BeamMesh mesh;
  for (int i = 0; i <= 8; ++i) mesh.reference.emplace_back(i - 4.0, 0, 0);
  for (int i = 0; i < 8; ++i) mesh.elements.push_back({i, i + 1});
  mesh.width_mm.assign(8, 0.3);
  mesh.depth_mm.assign(8, 0.3);
  mesh.depth_axis.assign(8, Vec3::UnitZ());
  const auto network = std::make_shared<BeamNetwork>(mesh, BeamMaterial{5e8, 0.3, 6.45e-3});
  System system;
  const Body body = system.add_rotational_body(
      "beam", mesh.reference, network->lumped_mass(),
      std::vector<Eigen::Quaterniond>(9, Eigen::Quaterniond::Identity()), network->lumped_inertia());
  const double rate = 300;
  for (int a = 0; a < 9; ++a) {
    system.state.v[a] = Vec3(0, rate * mesh.reference[a].x(), 0);
    system.state.angular_velocity[a] = Vec3(0, 0, rate);
  }
  solve::ImplicitSettings settings;
  settings.step_s = 2e-4;
  settings.spectral_radius = 0.8;
  solve::ImplicitIntegrator integrator(system, {std::make_shared<BeamTerm>(network, body)}, {}, settings);
  const double energy = integrator.kinetic_energy();
  const Vec3 spin = integrator.angular_momentum();
  for (int i = 0; i < 100; ++i) integrator.step();
  std::printf("| beam, 100 steps, %.2f turns | energy change %.2e | angular momentum change %.2e |\n",
              rate * 0.02 / (2 * M_PI), integrator.kinetic_energy() / energy - 1,
              (integrator.angular_momentum() - spin).norm() / spin.norm());
  EXPECT_NEAR(integrator.kinetic_energy(), energy, 0.02 * energy);
  EXPECT_LT((integrator.angular_momentum() - spin).norm(), 0.01 * spin.norm());
  const Vec3 along = (system.state.x[8] - system.state.x[0]).normalized();
  EXPECT_LT((system.state.rotation[4] * Vec3::UnitX() - along).norm(), 0.01);
}
