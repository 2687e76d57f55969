// Contact in motion: a free plate hits a held one; a point is pressed against a plate.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/body_contact.hpp"
#include "structure/integrator.hpp"

namespace valsalva::contact {
namespace {

constexpr double K = 2e5, radius = 0.05;

/// A held triangle in the plane z = 0 and a smaller one above its middle, moving down.
struct Plates {
  structure::System system;
  std::shared_ptr<BodyContact> contact;
  double mass = 1e-3;

  Plates(Law law, double gap, double speed) {
    const Points x{{-3, -3, 0}, {3, -3, 0}, {0, 4, 0}, {-0.3, -0.2, gap}, {0.3, -0.2, gap}, {0, 0.4, gap}};
    system.add_body("both", x, std::vector<double>(6, mass));
    for (int i = 0; i < 3; ++i) system.hold(i);
    for (int i = 3; i < 6; ++i) system.state.v[i] = Vec3(0, 0, -speed);
    CollisionMesh mesh(x);
    mesh.add_shell({"floor", 0}, 0, {{0, 1, 2}}, std::vector<double>(3, radius));
    mesh.add_shell({"plate", 1}, 3, {{0, 1, 2}}, std::vector<double>(3, radius));
    contact = std::make_shared<BodyContact>(Candidates(std::move(mesh), {K, 0.9, 0.3, 0.05}), law);
  }
};

TEST(Impact, ElasticBounceReturnsTheSpeedToSecondOrderInTheStep) {
  const double speed = 100;
  double error[2];
  for (int level = 0; level < 2; ++level) {
    Plates plates(Law::barrier, 0.15, speed);
    structure::IntegratorSettings settings;
    settings.step_s = level == 0 ? 4e-6 : 2e-6;
    settings.mass_scaling = false;
    structure::Integrator integrator(plates.system, {plates.contact}, settings);
    double worst = 0;
    const double at_start = 1.5 * plates.mass * speed * speed;
    while (plates.system.state.time_s < 4e-3) {
      integrator.step();
      // the energy at the half step: kinetic there, stored as the mean of the two sides
      const auto& now = plates.system.state;
      structure::Forces ignored;
      ignored.reset(now.x.size(), 0);
      const double stored = 0.5 * (integrator.energies().stored + plates.contact->add_forces(now, ignored));
      worst = std::max(worst, std::abs(integrator.energies().kinetic + stored - at_start) / at_start);
    }
    error[level] = worst;
    EXPECT_NEAR(plates.system.state.v[3][2], speed, 0.01 * speed);
  }
  EXPECT_LT(error[1], 0.01);
  EXPECT_NEAR(error[0] / error[1], 4, 1.2);
}

/// Steady load F on each node of the plate, critical damping; the height at which it rests, or below 0.
double pressed_height(Law law, double force_uN) {
  Plates plates(law, 0.09, 0);
  struct Load : structure::ForceTerm {
    double force;
    explicit Load(double f) : force(f) {}
    std::string name() const override { return "load"; }
    double add_forces(const structure::Configuration&, structure::Forces& out) const override {
      for (int i = 3; i < 6; ++i) out.force[i][2] -= force;
      return 0;
    }
    void add_stiffness_bound(const structure::Configuration&, structure::StiffnessBound&) const override {}
  };
  structure::IntegratorSettings settings;
  settings.step_s = 1e-6;
  settings.damping_per_s = 2e4;
  structure::Integrator integrator(plates.system, {plates.contact, std::make_shared<Load>(force_uN)},
                                   settings);
  for (int step = 0; step < 4000 && plates.system.state.x[3][2] > -0.2; ++step) {
    integrator.step();
    plates.contact->limit_velocities(plates.system, settings.step_s);
  }
  return plates.system.state.x[3][2];
}

TEST(Pressed, BarrierRestsAtTheClosedFormHeightUnderAnyLoad) {
  const double area = 0.5 * 0.6 * 0.6 / 3;
  for (double s : {0.7, 0.4, 0.2, 0.1}) {
    const double pressure = K * (2 * (s - 1) * std::log(s) + (s - 1) * (s - 1) / s);
    EXPECT_NEAR(pressed_height(Law::barrier, pressure * area), 2 * radius * s, 2e-4) << s;
  }
}

TEST(Pressed, PenaltyIsPushedThroughWhereTheBarrierHolds) {
  const double area = 0.5 * 0.6 * 0.6 / 3, load = 3 * K * area;
  EXPECT_LT(pressed_height(Law::penalty, load), 0);
  EXPECT_GT(pressed_height(Law::barrier, load), 0.02);
}

}  // namespace
}  // namespace valsalva::contact
