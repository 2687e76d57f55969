// Corotational beams against published and closed-form large-rotation results.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "statics.hpp"
#include "structure/beam.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

struct Cantilever {
  System system;
  std::shared_ptr<BeamNetwork> network;
  std::shared_ptr<DeadLoad> load;
  std::unique_ptr<Integrator> integrator;
  int tip;

  Cantilever(const Points& line, double width, double depth, const std::vector<Vec3>& depth_axis,
             double young, double poisson, Vec3 force, Vec3 moment) {
    BeamMesh mesh;
    mesh.reference = line;
    tip = static_cast<int>(line.size()) - 1;
    for (int i = 0; i < tip; ++i) mesh.elements.push_back({i, i + 1});
    mesh.width_mm.assign(tip, width);
    mesh.depth_mm.assign(tip, depth);
    mesh.depth_axis = depth_axis;
    network = std::make_shared<BeamNetwork>(mesh, BeamMaterial{young, poisson, 1e-12});
    const Body body = system.add_rotational_body(
        "beam", line, network->lumped_mass(),
        std::vector<Eigen::Quaterniond>(line.size(), Eigen::Quaterniond::Identity()),
        network->lumped_inertia());
    system.hold(0);
    load = std::make_shared<DeadLoad>(tip, force, tip, moment);
    IntegratorSettings settings;
    settings.step_s = 1;
    integrator = std::make_unique<Integrator>(
        system, std::vector<std::shared_ptr<ForceTerm>>{std::make_shared<BeamTerm>(network, body), load},
        settings);
  }

  Vec3 tip_displacement(double fraction) {
    load->scale = fraction;
    const int most = 400000;
    EXPECT_LT(settle(system, *integrator, 1e-7, most), most) << "not at rest";
    return system.state.x[tip] - network->mesh().reference[tip];
  }
};

Points straight(double length, int elements) {
  Points line;
  for (int i = 0; i <= elements; ++i) line.emplace_back(length * i / elements, 0, 0);
  return line;
}

}  // namespace

TEST(BeamBenchmark, CantileverUnderEndShear) {
  // Sze, Liu and Lo 2004, section 3.1: L = 10, b = 1, h = 0.1, E = 1.2e6, nu = 0, P = 4.
  const int n = 40;
  Cantilever beam(straight(10, n), 1, 0.1, std::vector<Vec3>(n, Vec3::UnitZ()), 1.2e6, 0, Vec3(0, 0, 4),
                  Vec3::Zero());
  const double table[][3] = {{0.25, 0.563, 3.015}, {0.5, 1.604, 4.933}, {1.0, 3.286, 6.698}};
  for (const auto& [fraction, shortening, deflection] : table) {
    const Vec3 u = beam.tip_displacement(fraction);
    EXPECT_NEAR(-u.x(), shortening, 0.01 * deflection) << fraction;
    EXPECT_NEAR(u.z(), deflection, 0.005 * deflection) << fraction;
  }
}

TEST(BeamBenchmark, RollUp) {
  // Sze, Liu and Lo 2004, section 3.2: L = 12, M = 50 pi/3 rolls the beam into a full circle; half of it
  // here, where the tip stands at (0, 2 L/pi). Exact for the polygon with n sides up to its inscribed chords.
  const int n = 24;
  const double length = 12, moment = 25 * M_PI / 3;
  Cantilever beam(straight(length, n), 1, 0.1, std::vector<Vec3>(n, Vec3::UnitZ()), 1.2e6, 0, Vec3::Zero(),
                  Vec3(0, -moment, 0));
  const Vec3 u = beam.tip_displacement(1);
  EXPECT_NEAR(u.x() + length, 0, 0.02);
  EXPECT_NEAR(u.z(), 2 * length / M_PI, 0.005 * 2 * length / M_PI);
}

TEST(BeamBenchmark, FortyFiveDegreeBend) {
  // Bathe and Bolourchi 1979: arc of radius 100 over 45 degrees, square section 1, E = 1e7, nu = 0,
  // out-of-plane tip load 600. Published tip displacements (-13.4, -23.5, 53.4) to (-13.6, -23.5, 53.4).
  const int n = 16;
  Points line;
  std::vector<Vec3> axes(n, Vec3::UnitZ());
  for (int i = 0; i <= n; ++i) {
    const double angle = M_PI / 4 * i / n;
    line.emplace_back(100 * std::sin(angle), 100 * (1 - std::cos(angle)), 0);
  }
  Cantilever beam(line, 1, 1, axes, 1e7, 0, Vec3(0, 0, 600), Vec3::Zero());
  const Vec3 u = beam.tip_displacement(1);
  // In these axes the arc starts along x and turns towards y.
  EXPECT_NEAR(u.z(), 53.4, 0.01 * 53.4);
  EXPECT_NEAR(u.x(), -23.5, 0.02 * 23.5);
  EXPECT_NEAR(u.y(), -13.5, 0.02 * 13.5);
}
