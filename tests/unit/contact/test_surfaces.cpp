#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "contact/tool_contact.hpp"
#include "contact/wall_contact.hpp"
#include "core/errors.hpp"
#include "scenes.hpp"

namespace valsalva::contact {
namespace {

using test::at;
using test::forces_for;

/// The half space z > 0 is the lumen: phi = -z.
geometry::GridSdf floor_level_set() {
  return geometry::sample(Vec3(-2, -2, -2), Vec3(10, 2, 2), 0.25, [](const Vec3& x) { return -x[2]; });
}
geometry::GridSdf pipe_level_set(double spacing) {
  return geometry::sample(Vec3(-3, -3, -1), Vec3(3, 3, 1), spacing,
                          [](const Vec3& x) { return std::hypot(x[0], x[1]) - 2; });
}

TEST(WallContact, KnownOverlapOnAPlane) {
  WallContact wall("wall", floor_level_set(), {{0, 0.2, 0.5}}, {1e6, 0, 0});
  auto now = at({{0.1, 0.2, 0.15}});
  auto f = forces_for(now);
  wall.begin_step(now, 1e-6);
  const double energy = wall.add_forces(now, f);
  EXPECT_NEAR(f.force[0][2], 1e6 * 0.5 * 0.05, 1);  // the level set is stored in single precision
  EXPECT_NEAR(energy, 0.5 * 1e6 * 0.5 * 0.05 * 0.05, 0.1);
  EXPECT_NEAR(wall.penetration_mm(now), 0.05, 1e-6);
  EXPECT_EQ(wall.penetration_mm(at({{0.1, 0.2, 0.25}})), 0);
}

TEST(WallContact, ForceOnACurvedWallConvergesToSecondOrderInTheGrid) {
  double error[2];
  for (int level = 0; level < 2; ++level) {
    WallContact wall("wall", pipe_level_set(level == 0 ? 0.2 : 0.1), {{0, 0.1, 1}}, {1e6, 0, 0});
    error[level] = 0;
    for (int k = 0; k < 40; ++k) {
      const double angle = 0.157 * k;
      auto now = at({{1.95 * std::cos(angle), 1.95 * std::sin(angle), 0.03}});
      auto f = forces_for(now);
      wall.add_forces(now, f);
      const Vec3 exact = -1e6 * 0.05 * Vec3(std::cos(angle), std::sin(angle), 0);
      error[level] = std::max(error[level], (f.force[0] - exact).norm() / 5e4);
    }
  }
  EXPECT_LT(error[1], 0.03);
  EXPECT_GT(error[0] / error[1], 3);
}

/// A point mass on a plane tilted by an angle: gravity is turned instead of the plane.
double slide(double angle, double friction, double duration, double tangent_Pa_per_mm) {
  const double g = 9810, mass = 1e-3, dt = 1e-6;
  WallContact wall("wall", floor_level_set(), {{0, 0.1, 1}}, {1e4, friction, tangent_Pa_per_mm});
  auto now = at({{0, 0, 0.1 - mass * g * std::cos(angle) / 1e4}});  // at rest on the floor
  const double start = now.x[0][0];
  for (double t = 0; t < duration; t += dt) {
    auto f = forces_for(now);
    wall.begin_step(now, dt);
    wall.add_forces(now, f);
    const Vec3 gravity(g * std::sin(angle), 0, -g * std::cos(angle));
    now.v[0] += dt * (f.force[0] / mass + gravity);
    now.x[0] += dt * now.v[0];
  }
  return now.x[0][0] - start;
}

TEST(Friction, SticksBelowTheFrictionAngle) {
  // Only the tether's elastic stretch is left, m g sin(angle) / (K_t A), twice that in the first swing.
  const double angle = std::atan(0.25), stretch = 1e-3 * 9810 * std::sin(angle) / 1e4;
  for (double duration : {0.01, 0.04}) {
    const double moved = slide(angle, 0.5, duration, 1e4);
    EXPECT_GE(moved, -1e-9);
    EXPECT_LE(moved, 2.01 * stretch);
  }
}

TEST(Friction, SlidesWithTheClosedFormAbove) {
  const double angle = 0.6, mu = 0.3, t = 0.04;
  const double exact = 0.5 * 9810 * (std::sin(angle) - mu * std::cos(angle)) * t * t;
  // While the tether stretches to mu N, over sqrt(2 mu N / (K_t A a)) s, friction is not yet full.
  const double soft = slide(angle, mu, t, 1e4), stiff = slide(angle, mu, t, 1e6);
  EXPECT_NEAR(stiff, exact, 2e-3 * exact);
  EXPECT_NEAR((soft - exact) / (stiff - exact), 10, 2);  // the error falls as K_t^-1/2
}

TEST(Friction, SlidingBlockStopsAfterTheClosedFormDistance) {
  const double mu = 0.4, g = 9810, mass = 1e-3, dt = 1e-6, v0 = 100;
  WallContact wall("wall", floor_level_set(), {{0, 0.1, 1}}, {1e4, mu, 1e6});
  auto now = at({{0, 0, 0.1 - mass * g / 1e4}});
  now.v[0] = Vec3(v0, 0, 0);
  double farthest = 0;
  for (int step = 0; step < 60000; ++step) {
    auto f = forces_for(now);
    wall.begin_step(now, dt);
    wall.add_forces(now, f);
    now.v[0] += dt * (f.force[0] / mass + Vec3(0, 0, -g));
    now.x[0] += dt * now.v[0];
    farthest = std::max(farthest, now.x[0][0]);
  }
  const double exact = v0 * v0 / (2 * mu * g);
  EXPECT_NEAR(farthest, exact, 5e-3 * exact);
  EXPECT_LT(std::abs(now.x[0][0] - farthest),
            2 * mu * mass * g / 1e6 + 1e-9);  // springs back at most the tether
}

TEST(Friction, AnchorsSurviveSaveAndRestore) {
  const SurfaceParameters parameters{1e4, 0.5, 1e4};
  WallContact wall("wall", floor_level_set(), {{0, 0.1, 1}}, parameters);
  auto now = at({{0, 0, 0.09}});
  wall.begin_step(now, 1e-6);
  now.x[0][0] = 0.003;
  auto f = forces_for(now);
  wall.add_forces(now, f);
  WallContact copy("wall", floor_level_set(), {{0, 0.1, 1}}, parameters);
  copy.restore(wall.save());
  auto g = forces_for(now);
  copy.add_forces(now, g);
  EXPECT_LT(f.force[0][0], 0);
  EXPECT_EQ(f.force[0], g.force[0]);
  EXPECT_THROW(copy.restore({}), InputError);
}

TEST(ToolContact, RadialForceOfAKnownOverlap) {
  std::vector<SurfaceNode> nodes;
  Points x;
  for (int k = 0; k < 12; ++k) {
    x.emplace_back(3 * std::cos(0.5 * k), 3 * std::sin(0.5 * k), 0.1 * k);
    nodes.push_back({k, 0.2, 0.3});
  }
  ToolContact tool("crimper", [](double) { return ToolPosition{3.15, -10, 10, 0}; }, 1, nodes, {1e6, 0, 0});
  auto now = at(x);
  EXPECT_NEAR(tool.radial_force_uN(now), 12 * 1e6 * 0.3 * 0.05, 1e-3);
  EXPECT_NEAR(tool.penetration_mm(now), 0.05, 1e-12);
  auto f = forces_for(now);
  tool.add_forces(now, f);
  for (int k = 0; k < 12; ++k)
    EXPECT_NEAR((f.force[k] + 1e6 * 0.3 * 0.05 / 3 * Vec3(x[k][0], x[k][1], 0)).norm(), 0, 1e-3);
}

TEST(ToolContact, ForceIsTheGradientToSecondOrderAtTheRimToo) {
  ToolContact tool("sheath",
                   [](double) {
                     return ToolPosition{1.0, 0, 5, 0};
                   },
                   1, {{0, 0.2, 0.3}}, {1e6, 0, 0});
  for (double z : {0.3, 2.5, 4.4}) {
    auto now = at({{0.6, 0.7, z}});
    auto f = forces_for(now), ignored = forces_for(now);
    tool.add_forces(now, f);
    for (int d = 0; d < 3; ++d) {
      double error[2];
      for (int level = 0; level < 2; ++level) {
        const double h = level == 0 ? 4e-3 : 2e-3;
        auto high = now, low = now;
        high.x[0][d] += h;
        low.x[0][d] -= h;
        error[level] = std::abs((tool.add_forces(low, ignored) - tool.add_forces(high, ignored)) / (2 * h) -
                                f.force[0][d]);
      }
      EXPECT_LT(error[1], 1e-4 * f.force[0].norm());
      if (error[1] > 1e-6 * f.force[0].norm()) EXPECT_NEAR(error[0] / error[1], 4, 0.2);
    }
  }
}

TEST(ToolContact, NothingBeyondTheEnds) {
  ToolContact tool("sheath",
                   [](double) {
                     return ToolPosition{1.0, 0, 5, 0};
                   },
                   1, {{0, 0.2, 0.3}}, {1e6, 0, 0});
  for (double z : {-0.1, 5.1}) EXPECT_EQ(tool.radial_force_uN(at({{1, 0, z}})), 0);
}

TEST(ToolContact, ADrawnSheathDragsWithItsFrictionForce) {
  const SurfaceParameters parameters{1e6, 0.2, 1e6};
  ToolContact tool(
      "sheath",
      [](double t) {
        return ToolPosition{1.0, -50, 50, 30 * t};
      },
      1, {{0, 0.1, 1}}, parameters);
  auto now = at({{0.95, 0, 0}});
  for (int step = 0; step <= 100; ++step) {  // the sheath moves 3 mm past a held node
    now.time_s = 1e-3 * step;
    tool.begin_step(now, 1e-3);
  }
  auto f = forces_for(now);
  tool.add_forces(now, f);
  EXPECT_NEAR(f.force[0][2], 0.2 * 1e6 * 0.05, 1e-6 * 1e6);
}

}  // namespace
}  // namespace valsalva::contact
