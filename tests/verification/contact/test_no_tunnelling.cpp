// Thin sheets thrown at each other, in steps in which they move many times their contact distance: they never
// cross.
#include <gtest/gtest.h>

#include <random>

#include "core/errors.hpp"
#include "materials/neo_hookean.hpp"
#include "scenes.hpp"
#include "solve/implicit.hpp"
#include "structure/shell_term.hpp"

namespace valsalva::contact {
namespace {

constexpr double h = 0.04, thickness = 0.1, gap = 0.5;

/// Two sheets, crooked, one above the other; the lower one is held at its rim or free.
struct Sheets {
  structure::System system;
  std::shared_ptr<BodyContact> contact;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms;
  structure::Body lower, upper;

  explicit Sheets(bool hold) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-0.04, 0.04);
    const auto sheet = [&](int n, double edge, const Vec3& corner) {
      structure::ShellMesh mesh;
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
          mesh.reference.push_back(
              corner + Vec3(i * edge + uniform(random), j * edge + uniform(random), uniform(random)));
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const int a = j * (n + 1) + i;
          mesh.triangles.push_back({a, a + 1, a + n + 2});
          mesh.triangles.push_back({a, a + n + 2, a + n + 1});
        }
      mesh.thickness_mm.assign(mesh.reference.size(), thickness);
      return mesh;
    };
    const structure::ShellMesh down = sheet(5, 0.4, Vec3::Zero()), up = sheet(4, 0.4, Vec3(0.21, 0.19, gap));
    const auto add = [&](const char* name, const structure::ShellMesh& mesh) {
      const auto shell = std::make_shared<structure::Shell>(
          mesh, std::make_shared<materials::NeoHookean>(2e5), structure::Bending{1e6, 0.5});
      const auto body = system.add_body(name, mesh.reference, shell->lumped_mass(1e-3));
      terms.push_back(std::make_shared<structure::ShellTerm>(shell, body));
      return body;
    };
    lower = add("lower", down);
    upper = add("upper", up);
    if (hold)
      for (int a = 0; a < lower.count; ++a)
        if (a % 6 == 0 || a % 6 == 5 || a / 6 == 0 || a / 6 == 5) system.hold(a);
    CollisionMesh mesh(system.state.x);
    mesh.add_shell({"lower", 0}, 0, down.triangles, std::vector<double>(lower.count, 0.5 * h));
    mesh.add_shell({"upper", 1}, lower.count, up.triangles, std::vector<double>(upper.count, 0.5 * h));
    contact = std::make_shared<BodyContact>(Candidates(std::move(mesh), {2e6, 0.9, 0.3, 0.05}), Law::barrier);
    terms.push_back(contact);
  }
  void throw_upper(double speed) {
    for (int a = upper.begin(); a < upper.end(); ++a)
      system.state.v[a] = Vec3(0.1, 0.05, -1 - 0.02 * (a % 3)) * speed;
  }
  bool crossed() const { return !crossings(contact->candidates().mesh(), system.state.x).empty(); }
  /// The step that the stiffness at the start allows.
  double stable_step() const {
    structure::StiffnessBound bound;
    bound.reset(system.nodes(), 0);
    for (const auto& term : terms) term->add_stiffness_bound(system.state, bound);
    double most = 0;
    for (std::size_t a = 0; a < system.nodes(); ++a)
      most = std::max(most, bound.translation[a] / system.mass(int(a)));
    return 2 / std::sqrt(most);
  }
  double kinetic() const {
    double sum = 0;
    for (std::size_t a = 0; a < system.nodes(); ++a)
      sum += 0.5 * system.mass(int(a)) * system.state.v[a].squaredNorm();
    return sum;
  }
  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t a = 0; a < system.nodes(); ++a) sum += system.mass(int(a)) * system.state.v[a];
    return sum;
  }
};

}  // namespace

TEST(NoTunnelling, ExplicitAtManyTimesTheSpeedOfOneContactDistanceAStep) {
  std::printf(
      "| speed, contact distances a stable step | end | steps | smallest d/h | kinetic, of the first | with "
      "what is stored |\n");
  std::printf("|---|---|---|---|---|---|\n");
  for (double factor : {1.0, 10.0, 100.0, 1000.0}) {
    Sheets sheets(false);
    structure::IntegratorSettings settings;
    settings.step_s = 0.8 * sheets.stable_step();
    settings.mass_scaling = false;
    settings.adaptive = true;
    settings.scaling_interval = 1;
    settings.speed_limit_mm_per_s = 1e12;
    const double speed = factor * h / settings.step_s;
    sheets.throw_upper(speed);
    const double start = sheets.kinetic();
    const Vec3 momentum = sheets.momentum();
    structure::Integrator integrator(sheets.system, sheets.terms, settings);
    std::string end = "apart";
    double smallest = 1;
    int step = 0;
    for (; step < 3000; ++step) {
      try {
        integrator.step();
      } catch (const NumericalFailure& failure) {
        end = "stopped: " + std::string(failure.what()).substr(0, 60);
        break;
      }
      smallest = std::min(smallest, sheets.contact->report().smallest_ratio);
      ASSERT_FALSE(sheets.crossed()) << factor << ", step " << step << ", smallest d/h " << smallest;
      if (sheets.system.state.time_s * speed > 6 * gap) break;
    }
    std::printf("| %g | %s | %d | %.1e | %.3f | %.3f |\n", factor, end.c_str(), step, smallest,
                sheets.kinetic() / start, (sheets.kinetic() + integrator.energies().stored) / start);
    EXPECT_FALSE(sheets.crossed());
    EXPECT_LT((sheets.momentum() - momentum).norm(), 1e-6 * momentum.norm());
    if (factor > 10) continue;
    EXPECT_EQ(end, "apart");
    EXPECT_NEAR((sheets.kinetic() + integrator.energies().stored) / start, 1, 0.02);
  }
}

TEST(NoTunnelling, ExplicitWithFixedStepsAndTheGuard) {
  for (double factor : {1.0, 10.0, 100.0}) {
    Sheets sheets(true);
    structure::IntegratorSettings settings;
    settings.step_s = 0.8 * sheets.stable_step();
    settings.speed_limit_mm_per_s = 1e12;
    sheets.throw_upper(factor * h / settings.step_s);
    structure::Integrator integrator(sheets.system, sheets.terms, settings);
    sheets.contact->begin_step(sheets.system.state, settings.step_s);
    long slowed = sheets.contact->limit_velocities(sheets.system, settings.step_s);
    for (int step = 0; step < 800; ++step) {
      integrator.step();
      slowed += sheets.contact->limit_velocities(sheets.system, settings.step_s);
      ASSERT_FALSE(sheets.crossed()) << factor << ", step " << step;
    }
    std::printf("guard at %g contact distances a step: %ld node-steps slowed\n", factor, slowed);
  }
}

TEST(NoTunnelling, ImplicitStepsOfManyStableOnes) {
  std::printf(
      "| step / stable step | way of a step / h | steps | refused | smallest d/h |\n|---|---|---|---|---|\n");
  for (double factor : {10.0, 100.0, 1000.0}) {
    Sheets sheets(true);
    const double stable = sheets.stable_step(), speed = 2000;
    sheets.throw_upper(speed);
    solve::ImplicitSettings settings;
    settings.step_s = factor * stable;
    settings.spectral_radius = 0.5;
    settings.newton.max_iterations = 60;
    int steps = 0, refused = 0;
    double smallest = 1;
    auto integrator =
        std::make_unique<solve::ImplicitIntegrator>(sheets.system, sheets.terms, solve::Supports{}, settings);
    while (sheets.system.state.time_s < 4 * gap / speed && steps < 300) {
      try {
        integrator->step();
        ++steps;
      } catch (const NumericalFailure& failure) {  // a shorter step from the last good state
        if (refused == 0) std::printf("first refusal: %s\n", failure.what());
        if (++refused > 20) break;
        settings.step_s *= 0.5;
        integrator = std::make_unique<solve::ImplicitIntegrator>(sheets.system, sheets.terms,
                                                                 solve::Supports{}, settings);
      }
      sheets.contact->forces(sheets.system.state.x);
      smallest = std::min(smallest, sheets.contact->report().smallest_ratio);
      ASSERT_FALSE(sheets.crossed()) << factor << ", step " << steps;
    }
    std::printf("| %g | %.1f | %d | %d | %.2e |\n", factor, factor * stable * speed / h, steps, refused,
                smallest);
    EXPECT_LE(refused, 20);
  }
}

}  // namespace valsalva::contact
