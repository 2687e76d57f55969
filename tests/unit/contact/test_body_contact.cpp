#include <gtest/gtest.h>
#include <omp.h>

#include <random>
#include <set>

#include "contact/body_contact.hpp"
#include "contact/distance.hpp"
#include "core/errors.hpp"
#include "scenes.hpp"

namespace valsalva::contact {
namespace {

using test::at;
using test::forces_for;
using test::TwoSheets;

constexpr double K = 2e5, h = 0.1;

/// The two sheets, the upper one tilted and shifted to a gap below the contact distance.
struct Pressed : TwoSheets {
  Points x = reference;
  explicit Pressed(double gap = 0.06, int n = 4) : TwoSheets(n) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> noise(-0.01, 0.01);
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += Vec3(noise(random), noise(random), noise(random));
      if (i >= lower.points.size()) x[i] += Vec3(0.13, 0.21, gap - 5);
    }
  }
  BodyContact term(Law law = Law::barrier) const {
    return BodyContact(Candidates(mesh, {K, 0.9, 0.3, 0.05}), law);
  }
};

TEST(BodyContact, OnePointAboveOneTriangle) {
  // Far edges are out of reach: force K A [2 (s-1) ln s + (s-1)^2/s] on the point, its opposite on the
  // triangle.
  Points x{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 1, 10}, {4, 1, 12}, {1, 4, 12}};
  CollisionMesh mesh(x);
  mesh.add_shell({"floor", 0}, 0, {{0, 1, 2}}, std::vector<double>(3, 0.05));
  mesh.add_shell({"tip", 0}, 3, {{0, 1, 2}}, std::vector<double>(3, 0.05));
  BodyContact contact(Candidates(mesh, {K, 0.9, 0.3, 0.05}), Law::barrier);
  for (int i = 3; i < 6; ++i) x[i][2] -= 10 - 0.04;
  auto now = at(x);
  auto f = forces_for(now);
  contact.begin_step(now, 1e-6);
  contact.add_forces(now, f);
  const double area = (x[4] - x[3]).cross(x[5] - x[3]).norm() / 6, s = 0.4;
  const double expected = K * area * (2 * (s - 1) * std::log(s) + (s - 1) * (s - 1) / s);
  EXPECT_NEAR(f.force[3][2], expected, 1e-9 * expected);
  EXPECT_NEAR(f.force[0][2] + f.force[1][2] + f.force[2][2], -expected, 1e-9 * expected);
  EXPECT_NEAR(f.force[0][2], -expected / 3, 1e-9 * expected);  // (1, 1) is the triangle's middle
  EXPECT_EQ(contact.report().active, 1);
  EXPECT_NEAR(contact.report().penetration_mm, 0.06, 1e-12);
}

TEST(BodyContact, CrossedStrutsPushWithTheirAreaAndRadii) {
  Points x{{-1, 0, 0}, {1, 0, 0}, {0, -1, 5}, {0, 1, 5}};
  CollisionMesh mesh(x);
  mesh.add_beams({"one", 0}, 0, {{0, 1}}, {0.1});
  mesh.add_beams({"two", 0}, 2, {{0, 1}}, {0.2});
  BodyContact contact(Candidates(mesh, {K, 0.9, 0.3, 0.05}), Law::penalty);
  x[2][2] = x[3][2] = 0.15;  // h = 0.3, so that p = K / 2 on the area 2 x 0.1 x 2
  auto now = at(x);
  auto f = forces_for(now);
  contact.begin_step(now, 1e-6);
  contact.add_forces(now, f);
  EXPECT_NEAR(f.force[2][2] + f.force[3][2], 0.5 * K * 0.4, 1e-6);
}

class BothLaws : public testing::TestWithParam<Law> {};

TEST_P(BothLaws, ForceIsTheGradientToSecondOrder) {
  Pressed scene;
  BodyContact contact = scene.term(GetParam());
  auto now = at(scene.x);
  auto f = forces_for(now), ignored = forces_for(now);
  contact.begin_step(now, 1e-6);
  contact.add_forces(now, f);
  ASSERT_GT(contact.report().active, 50);
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  Points direction(now.x.size());
  double slope = 0;
  for (std::size_t i = 0; i < now.x.size(); ++i) {
    direction[i] = Vec3(normal(random), normal(random), normal(random));
    slope -= direction[i].dot(f.force[i]);
  }
  double error[2];
  for (int level = 0; level < 2; ++level) {
    const double step = level == 0 ? 4e-5 : 2e-5;
    const auto energy = [&](double t) {
      auto moved = now;
      for (std::size_t i = 0; i < moved.x.size(); ++i) moved.x[i] += t * direction[i];
      return contact.add_forces(moved, ignored);
    };
    error[level] = std::abs((energy(step) - energy(-step)) / (2 * step) - slope) / std::abs(slope);
  }
  EXPECT_LT(error[1], 1e-5);
  EXPECT_NEAR(error[0] / error[1], 4, 0.6);
}

TEST_P(BothLaws, MomentumIsConservedToRoundOff) {
  Pressed scene;
  BodyContact contact = scene.term(GetParam());
  auto now = at(scene.x);
  auto f = forces_for(now);
  contact.begin_step(now, 1e-6);
  contact.add_forces(now, f);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  double scale = 0;
  for (std::size_t i = 0; i < now.x.size(); ++i) {
    force += f.force[i];
    moment += now.x[i].cross(f.force[i]);
    scale += f.force[i].norm();
  }
  EXPECT_LT(force.norm(), 1e-13 * scale);
  EXPECT_LT(moment.norm(), 1e-13 * scale);
}
INSTANTIATE_TEST_SUITE_P(Laws, BothLaws, testing::Values(Law::barrier, Law::penalty));

TEST(BodyContact, StiffnessBoundExceedsTheRealCurvature) {
  Pressed scene;
  BodyContact contact = scene.term();
  auto now = at(scene.x);
  contact.begin_step(now, 1e-6);
  structure::StiffnessBound bound;
  bound.reset(now.x.size(), 0);
  contact.add_stiffness_bound(now, bound);
  for (std::size_t i = 0; i < now.x.size(); ++i) {
    auto high = now, low = now;
    high.x[i][2] += 1e-6;
    low.x[i][2] -= 1e-6;
    auto up = forces_for(now), down = forces_for(now);
    contact.add_forces(high, up);
    contact.add_forces(low, down);
    double row = 0;
    for (std::size_t j = 0; j < now.x.size(); ++j) row += std::abs(up.force[j][2] - down.force[j][2]) / 2e-6;
    EXPECT_LE(row, bound.translation[i] * (1 + 1e-6) + 1e-3) << "node " << i;
  }
}

TEST(BodyContact, SameBitsWithAnyNumberOfThreadsAndAnyListAge) {
  Pressed scene(0.06, 40);
  auto now = at(scene.x);
  const auto run = [&](int threads, bool aged) {
    omp_set_num_threads(threads);
    BodyContact contact = scene.term();
    if (aged) {  // lists made 0.02 mm away stay in use
      auto before = now;
      for (auto& p : before.x) p += Vec3(0.01, 0.005, 0);
      contact.begin_step(before, 1e-6);
    }
    contact.begin_step(now, 1e-6);
    if (aged) EXPECT_EQ(std::as_const(contact).candidates().near_updates(), 1);
    auto f = forces_for(now);
    const double energy = contact.add_forces(now, f);
    return std::pair(energy, f.force);
  };
  const auto [energy, force] = run(1, false);
  for (const auto& [threads, aged] : {std::pair(2, false), std::pair(3, true), std::pair(1, true)}) {
    const auto [other_energy, other_force] = run(threads, aged);
    EXPECT_EQ(energy, other_energy);
    EXPECT_EQ(force, other_force);
  }
}

TEST(BodyContact, CandidatesHoldEveryPairInReach) {
  Pressed scene(0.09, 6);
  BodyContact contact = scene.term();
  contact.begin_step(at(scene.x), 1e-6);
  const auto& mesh = scene.mesh;
  std::set<std::pair<int, int>> listed;
  for (const auto& pair : contact.candidates().point_triangle()) listed.insert({pair.first, pair.second});
  int in_reach = 0;
  for (int v = 0; v < static_cast<int>(mesh.vertices().size()); ++v)
    for (int f = 0; f < static_cast<int>(mesh.faces().size()); ++f) {
      const auto& face = mesh.faces()[f].node;
      const int node = mesh.vertices()[v].node;
      if (node == face[0] || node == face[1] || node == face[2]) continue;
      if (point_triangle(scene.x[node], scene.x[face[0]], scene.x[face[1]], scene.x[face[2]]).distance >= h)
        continue;
      ++in_reach;
      EXPECT_TRUE(listed.count({v, f})) << v << " " << f;
    }
  EXPECT_GT(in_reach, 20);
}

TEST(BodyContact, NothingIsActiveInTheReferenceShape) {
  // Sheets nearer than the sum of their radii in the reference, and sewn at one node.
  auto lower = test::sheet(4, 0.5, 0), upper = test::sheet(4, 0.5, 0.04);
  const Points x = TwoSheets::join(lower, upper);
  CollisionMesh mesh(x);
  mesh.add_shell({"lower", 0}, 0, lower.triangles, std::vector<double>(25, 0.05));
  mesh.add_shell({"upper", 0}, 25, upper.triangles, std::vector<double>(25, 0.05));
  mesh.identify(3, 28);
  BodyContact contact(Candidates(mesh, {}), Law::barrier);
  auto now = at(x);
  contact.begin_step(now, 1e-6);
  auto f = forces_for(now);
  EXPECT_EQ(contact.add_forces(now, f), 0);
  EXPECT_FALSE(contact.candidates().point_triangle().empty());
  for (const auto& pair : contact.candidates().point_triangle())
    for (int k = 1; k < 4; ++k) EXPECT_FALSE(pair.node[0] == 28 && pair.node[k] == 3);
}

TEST(BodyContact, BodiesOfOtherGroupsKeepTheFullDistanceWhateverTheirReference) {
  auto lower = test::sheet(2, 0.5, 0), upper = test::sheet(2, 0.5, 0.04);
  const Points x = TwoSheets::join(lower, upper);
  CollisionMesh mesh(x);
  mesh.add_shell({"lower", 0}, 0, lower.triangles, std::vector<double>(9, 0.05));
  mesh.add_shell({"upper", 1}, 9, upper.triangles, std::vector<double>(9, 0.05));
  BodyContact contact(Candidates(mesh, {}), Law::barrier);
  auto now = at(x);
  contact.begin_step(now, 1e-6);
  auto f = forces_for(now);
  EXPECT_GT(contact.add_forces(now, f), 0);
  EXPECT_NEAR(contact.penetration_mm(x, "upper", "lower"), 0.06, 1e-12);
  EXPECT_EQ(contact.penetration_mm(x, "upper", "upper"), 0);
}

TEST(BodyContact, PairSettingsOverrideDistanceAndSwitchOff) {
  Pressed scene(0.15);
  auto now = at(scene.x);
  auto f = forces_for(now);
  BodyContact contact = scene.term();
  contact.begin_step(now, 1e-6);
  EXPECT_EQ(contact.add_forces(now, f), 0);
  contact.candidates().set_pair("lower", "upper", {true, 0.2, 0});
  contact.begin_step(now, 1e-6);
  EXPECT_GT(contact.add_forces(now, f), 0);
  contact.candidates().set_pair("lower", "upper", {false, 0.2, 0});
  contact.begin_step(now, 1e-6);
  EXPECT_EQ(contact.add_forces(now, f), 0);
  EXPECT_THROW(contact.candidates().set_pair("lower", "uper", {}), InputError);
}

TEST(BodyContact, GuardKeepsAFastPointFromPassing) {
  Points x{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {1, 1, 10}, {4, 1, 12}, {1, 4, 12}};
  CollisionMesh mesh(x);
  mesh.add_shell({"floor", 0}, 0, {{0, 1, 2}}, std::vector<double>(3, 0.05));
  mesh.add_shell({"tip", 0}, 3, {{0, 1, 2}}, std::vector<double>(3, 0.05));
  BodyContact contact(Candidates(mesh, {K, 0.9, 0.3, 0.05}), Law::barrier);
  structure::System system;
  system.add_body("all", x, std::vector<double>(6, 1e-4));
  for (int i = 3; i < 6; ++i) system.state.x[i][2] -= 10 - 0.12;
  const double dt = 1e-6;
  for (int step = 0; step < 200; ++step) {  // without forces: only the guard stands between
    for (int i = 3; i < 6; ++i) system.state.v[i] = Vec3(0, 0, -5e5);
    contact.begin_step(system.state, dt);
    auto f = forces_for(system.state);
    contact.add_forces(system.state, f);
    EXPECT_GT(contact.limit_velocities(system, dt), 0);
    for (int i = 3; i < 6; ++i) system.state.x[i] += dt * system.state.v[i];
    ASSERT_GT(system.state.x[3][2], 0) << "step " << step;
  }
}

TEST(CollisionMesh, BadInputIsNamed) {
  CollisionMesh mesh(Points(3, Vec3::Zero()));
  EXPECT_THROW(mesh.add_shell({"a", 0}, 0, {{0, 1, 3}}, std::vector<double>(3, 0.1)), InputError);
  EXPECT_THROW(mesh.add_shell({"a", 0}, 0, {{0, 1, 2}}, std::vector<double>(3, -0.1)), InputError);
  EXPECT_THROW(mesh.add_beams({"a", 0}, 0, {{0, 1}}, {}), InputError);
  EXPECT_THROW(mesh.identify(0, 7), InputError);
  EXPECT_THROW(mesh.body("none"), InputError);
}

}  // namespace
}  // namespace valsalva::contact
