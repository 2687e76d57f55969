#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "materials/neo_hookean.hpp"
#include "meshes.hpp"
#include "structure/beam.hpp"
#include "structure/integrator.hpp"
#include "structure/pressure.hpp"
#include "structure/shell_term.hpp"
#include "structure/tie.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

// One node on a spring to the origin: x = cos(omega t).
class Spring : public ForceTerm {
 public:
  explicit Spring(double k) : k_(k) {}
  std::string name() const override { return "spring"; }
  double add_forces(const Configuration& now, Forces& out) const override {
    out.force[0] -= k_ * now.x[0];
    return 0.5 * k_ * now.x[0].squaredNorm();
  }
  void add_stiffness_bound(const Configuration&, StiffnessBound& out) const override {
    out.translation[0] += k_;
  }

 private:
  double k_;
};

// One node that a cord stops: the stiffness grows like exp(x) once it is taut.
class Cord : public ForceTerm {
 public:
  std::string name() const override { return "cord"; }
  double add_forces(const Configuration& now, Forces& out) const override {
    const double x = now.x[0].x();
    if (x <= 0) return 0;
    out.force[0].x() -= k_ * (std::exp(b_ * x) - 1) / b_;
    return (k_ * (std::exp(b_ * x) - 1) / b_ - k_ * x) / b_;
  }
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override {
    out.translation[0] += k_ * std::exp(b_ * std::max(now.x[0].x(), 0.0));
  }
  /// Stored when it hangs at rest under a force.
  double energy_under(double force) const {
    const double x = std::log1p(b_ * force / k_) / b_;
    return (force - k_ * x) / b_;
  }

 private:
  static constexpr double k_ = 1, b_ = 8;
};

class Pull : public ForceTerm {
 public:
  static constexpr double rate = 20;
  std::string name() const override { return "pull"; }
  double add_forces(const Configuration& now, Forces& out) const override {
    out.force[0].x() += rate * now.time_s;
    return 0;
  }
  void add_stiffness_bound(const Configuration&, StiffnessBound&) const override {}
};

// A beam loop with a sheet sewn to it, thrown and spinning.
struct Scene {
  System system;
  std::vector<std::shared_ptr<ForceTerm>> terms;

  Scene() {
    BeamMesh beams;
    const int around = 12;
    for (int i = 0; i < around; ++i)
      beams.reference.emplace_back(2 * std::cos(2 * M_PI * i / around), 2 * std::sin(2 * M_PI * i / around),
                                   0);
    for (int i = 0; i < around; ++i) beams.elements.push_back({i, (i + 1) % around});
    beams.width_mm.assign(around, 0.3);
    beams.depth_mm.assign(around, 0.3);
    beams.depth_axis = radial_directions(beams.reference, beams.elements);
    const auto network = std::make_shared<BeamNetwork>(beams, BeamMaterial{1e8, 0.3, 6e-3});
    ShellMesh mesh = rectangle(2, 2, 4, 4, 0.3);
    for (Vec3& p : mesh.reference) p -= Vec3(1, 1, 0);
    const auto shell =
        std::make_shared<Shell>(mesh, std::make_shared<materials::NeoHookean>(2e5), Bending{1e6, 0.4});
    const Body ring = system.add_rotational_body(
        "frame", network->mesh().reference, network->lumped_mass(),
        std::vector<Eigen::Quaterniond>(around, Eigen::Quaterniond::Identity()), network->lumped_inertia());
    const Body sheet = system.add_body("leaflets", mesh.reference, shell->lumped_mass(1.1e-3));
    terms = {
        std::make_shared<BeamTerm>(network, ring), std::make_shared<ShellTerm>(shell, sheet),
        std::make_shared<TieTerm>("ties",
                                  ties_in_reference(mesh.reference, network->mesh().reference,
                                                    {{0, 7}, {4, 10}, {24, 1}, {20, 4}}, sheet, ring, 1e5),
                                  system)};
    for (std::size_t a = 0; a < system.nodes(); ++a)
      system.state.v[a] = Vec3(100, 30, -20) + Vec3(5, 20, 60).cross(system.state.x[a]) +
                          Vec3(0, 0, 100 * system.state.x[a].x() * system.state.x[a].y());
    for (Vec3& w : system.state.angular_velocity) w = Vec3(5, 20, 60);
  }
};

IntegratorSettings with_step(double step, bool scaling) {
  IntegratorSettings settings;
  settings.step_s = step;
  settings.mass_scaling = scaling;
  return settings;
}

}  // namespace

TEST(Integrator, OscillatorConvergesToSecondOrder) {
  const double k = 400, omega = 20, end = 0.3;
  const auto error = [&](int steps) {
    System system;
    system.add_body("bob", {{1, 0, 0}}, {1.0});
    const double dt = end / steps;
    system.state.v[0] = Vec3(omega * std::sin(omega * 0.5 * dt), 0, 0);  // exact, half a step back
    Integrator integrator(system, {std::make_shared<Spring>(k)}, with_step(dt, false));
    for (int i = 0; i < steps; ++i) integrator.step();
    return std::abs(system.state.x[0].x() - std::cos(omega * end));
  };
  const double coarse = error(200), fine = error(400);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
}

TEST(Integrator, EnergyAndMomentumOfAFreeAssemblyAreConserved) {
  const auto drift = [](double step, int steps) {
    Scene scene;
    Integrator integrator(scene.system, scene.terms, with_step(step, false));
    const Vec3 momentum = integrator.momentum();
    double worst = 0;
    for (int i = 0; i < steps; ++i) {
      integrator.step();
      worst = std::max(worst, std::abs(integrator.energies().load_work()));
    }
    EXPECT_LT((integrator.momentum() - momentum).norm(), 1e-10 * momentum.norm());
    EXPECT_GT(integrator.energies().stored, 1e-3 * integrator.energies().kinetic);
    return worst / integrator.energies().kinetic_at_start;
  };
  // Velocities stand half a step back, so that kinetic and stored energy are apart by half a step: first
  // order.
  const double coarse = drift(4e-7, 4000), fine = drift(2e-7, 8000);
  EXPECT_LT(fine, 0.02);
  EXPECT_LT(fine, 0.6 * coarse);
}

TEST(Integrator, AngularMomentumIsConserved) {
  Scene scene;
  const double step = 2e-7;
  Integrator integrator(scene.system, scene.terms, with_step(step, false));
  // The leapfrog conserves sum of x(n) x m v(n - 1/2) exactly for positions; rotations to the step's
  // accuracy.
  integrator.step();
  const Vec3 before = integrator.angular_momentum();
  for (int i = 0; i < 5000; ++i) integrator.step();
  EXPECT_LT((integrator.angular_momentum() - before).norm(), 1e-6 * before.norm());
}

TEST(Integrator, MassScalingHoldsALargeStepAndSaysSo) {
  Scene scene;
  EXPECT_THROW(
      {
        Integrator refused(scene.system, scene.terms, with_step(1e-4, false));
        refused.step();
      },
      InputError);
  Scene other;
  Integrator integrator(other.system, other.terms, with_step(1e-5, true));
  for (int i = 0; i < 3000; ++i) integrator.step();
  EXPECT_GT(integrator.mass_ratio(), 1.5);
  EXPECT_TRUE(std::isfinite(integrator.energies().kinetic));
  EXPECT_LT(std::abs(integrator.energies().load_work()), 0.05 * integrator.energies().kinetic_at_start);
}

TEST(Integrator, BoundsFollowWhatStiffensFast) {
  // Pulled slowly, against the step: the energy stays that of the cord at rest under the load.
  const auto energy_over_static = [](double growth_limit) {
    System system;
    system.add_body("node", {Vec3::Zero()}, {1e-9});
    IntegratorSettings settings = with_step(2.5e-4, true);
    settings.scaling_interval = 50;
    settings.growth_limit = growth_limit;
    const auto cord = std::make_shared<Cord>();
    Integrator integrator(system, {cord, std::make_shared<Pull>()}, settings);
    double most = 0;
    for (int i = 0; i < 400; ++i) {
      integrator.step();
      most = std::max(most, integrator.energies().kinetic + integrator.stored_of(0));
    }
    return most / cord->energy_under(Pull::rate * system.state.time_s);
  };
  EXPECT_THROW(energy_over_static(std::numeric_limits<double>::infinity()), NumericalFailure);
  EXPECT_NEAR(energy_over_static(1.1), 1, 0.1);
  EXPECT_THROW(energy_over_static(1), InputError);
}

TEST(Integrator, DampingTakesTheEnergyThatItReports) {
  Scene scene;
  Integrator integrator(scene.system, scene.terms, with_step(2e-7, false));
  integrator.set_damping(500);
  for (int i = 0; i < 20000; ++i) integrator.step();  // exp(-2 * 500 * 4 ms) of the energy stays
  const Energies& e = integrator.energies();
  EXPECT_LT(e.kinetic, 0.05 * e.kinetic_at_start);
  EXPECT_NEAR(e.damping_work + e.kinetic + e.stored, e.kinetic_at_start + e.stored_at_start,
              0.02 * e.kinetic_at_start);
}

TEST(Integrator, WorkOfAPressureIsPressureTimesVolume) {
  // A held rim, a slow load: the work of the load is found in stored, kinetic and damping energy.
  const ShellMesh mesh = rectangle(4, 4, 8, 8, 0.3);
  const auto shell = std::make_shared<Shell>(mesh, std::make_shared<materials::NeoHookean>(1e5), Bending{});
  System system;
  const Body sheet = system.add_body("sheet", mesh.reference, shell->lumped_mass(1e-3));
  for (int a = 0; a < sheet.count; ++a) {
    const Vec3& p = mesh.reference[a];
    if (p.x() < 1e-9 || p.x() > 4 - 1e-9 || p.y() < 1e-9 || p.y() > 4 - 1e-9) system.hold(a);
  }
  const auto pressure = [](double) { return 2000.0; };
  Integrator integrator(system,
                        {std::make_shared<ShellTerm>(shell, sheet),
                         std::make_shared<PressureTerm>("pressure", mesh.triangles, sheet, pressure)},
                        with_step(2e-6, true));
  integrator.set_damping(300);
  for (int i = 0; i < 4000; ++i) integrator.step();
  double volume = 0;  // under the sheet
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = system.state.x[t[0]], &b = system.state.x[t[1]], &c = system.state.x[t[2]];
    volume += a.dot(b.cross(c)) / 6;
  }
  EXPECT_GT(volume, 0.5);
  EXPECT_NEAR(integrator.energies().load_work(), 2000 * volume, 0.01 * 2000 * volume);
}

TEST(Integrator, PrescribedMotionDoesSupportWork) {
  BeamMesh beams;
  beams.reference = {{0, 0, 0}, {1, 0, 0}};
  beams.elements = {{0, 1}};
  beams.width_mm = {0.1};
  beams.depth_mm = {0.1};
  beams.depth_axis = {Vec3::UnitZ()};
  const auto network = std::make_shared<BeamNetwork>(beams, BeamMaterial{1e8, 0.3, 1e-3});
  System system;
  const Body body = system.add_rotational_body(
      "bar", beams.reference, network->lumped_mass(),
      std::vector<Eigen::Quaterniond>(2, Eigen::Quaterniond::Identity()), network->lumped_inertia());
  system.hold(0);
  system.hold(1);
  system.state.v[1] = Vec3(10, 0, 0);
  Integrator integrator(system, {std::make_shared<BeamTerm>(network, body)}, with_step(1e-6, true));
  for (int i = 0; i < 1001; ++i) integrator.step();  // forces are those before the last move: 10 mm/s * 1 ms
  const double strain = 0.01, exact = 0.5 * 1e8 * 0.01 * strain * strain;
  EXPECT_NEAR(integrator.energies().stored, exact, 1e-6 * exact);
  EXPECT_NEAR(integrator.energies().support_work, exact, 3e-3 * exact);
}

TEST(Integrator, RestartIsBitwise) {
  const auto settings = with_step(1e-5, true);
  Scene through;
  Integrator whole(through.system, through.terms, settings);
  whole.set_damping(20);
  for (int i = 0; i < 400; ++i) whole.step();

  Snapshot snapshot;
  {
    Scene first;
    Integrator half(first.system, first.terms, settings);
    half.set_damping(20);
    for (int i = 0; i < 173; ++i) half.step();
    snapshot = half.save();
  }
  Scene second;
  Integrator rest(second.system, second.terms, settings);
  rest.restore(snapshot);
  EXPECT_EQ(rest.steps(), 173);
  for (int i = 173; i < 400; ++i) rest.step();
  const Snapshot a = whole.save(), b = rest.save();
  EXPECT_EQ(a, b);
  snapshot["x"].pop_back();
  EXPECT_THROW(rest.restore(snapshot), InputError);
}

TEST(Integrator, BlowUpNamesBodyAndNode) {
  System system;
  system.add_body("leaflets", {{1, 0, 0}, {2, 0, 0}}, {1.0, 1.0});
  system.state.v[1] = Vec3(0, 0, 2e5);
  Integrator integrator(system, {std::make_shared<Spring>(1)}, with_step(1e-5, true));
  try {
    integrator.step();
    FAIL() << "expected a numerical failure";
  } catch (const NumericalFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("leaflets node 1"), std::string::npos);
  }
}

TEST(System, BodiesAreCheckedAndFoundByName) {
  System system;
  system.add_body("one", {{0, 0, 0}}, {1.0});
  EXPECT_THROW(system.add_body("one", {{0, 0, 0}}, {1.0}), InputError);
  EXPECT_THROW(system.add_body("two", {{0, 0, 0}}, {0.0}), InputError);
  EXPECT_THROW(system.body("three"), InputError);
  EXPECT_EQ(system.describe(0), "one node 0");
}
