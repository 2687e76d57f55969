// First-order upwinding beside walls: who feels it, how much, and that it keeps momentum.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fluid/wall_upwind.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

constexpr double h = 0.5, weight = 0.3;

struct Scene {
  Boundaries boundaries;
  Slab slab;
  Solids solids;
  FaceField velocity, rate, next;
  WallUpwind upwind;

  static Boundaries along_z(Side across) {
    Boundaries boundaries;
    boundaries.side = {
        {{across, across}, {Side::periodic, Side::periodic}, {Side::periodic, Side::periodic}}};
    return boundaries;
  }
  explicit Scene(Side across)
      : boundaries(along_z(across)),
        slab(MPI_COMM_SELF, {{8, 6, 10}, Vec3::Zero(), h}, true),
        solids(slab, 1e-3),
        velocity(slab),
        rate(slab),
        next(slab),
        upwind(slab, boundaries) {}

  template <class Value>
  void set(const Value& value) {
    for (int d = 0; d < 3; ++d) {
      for (int k = 0; k < 10; ++k) {
        for (int j = 0; j < 6; ++j) {
          for (int i = 0; i < 8; ++i)
            velocity[d](i, j, k) = solids.owner(d, i, j, k) == 0 ? value(d, i, j, k) : 0;
        }
      }
    }
    fill_velocity_ghosts(slab, boundaries, velocity);
  }
  void add() {
    upwind.update(solids);
    upwind.add(velocity, weight, rate, next);
  }
};

}  // namespace

TEST(WallUpwind, IsNotThereWithoutWalls) {
  Scene scene(Side::slip);
  scene.upwind.update(scene.solids);
  EXPECT_EQ(scene.upwind.faces(), 0U);
}

TEST(WallUpwind, AFlowThatDoesNotChangeAlongItsOwnDirectionDoesNotFeelIt) {
  Scene scene(Side::wall);
  scene.set([](int d, int i, int, int) { return d == 2 ? 10.0 * (i + 0.5) * (7.5 - i) : 0.0; });
  scene.add();
  EXPECT_GT(scene.upwind.faces(), 0U);
  for (int d = 0; d < 3; ++d) {
    for (const double value : scene.rate[d].data()) EXPECT_EQ(value, 0);
  }
}

// w = c + sin(z) between walls in x: in the two layers of cells beside each of them, and there only,
// |a| / 2 h times the second difference, with a the mean in the cell.
TEST(WallUpwind, AddsHalfTheSpeedTimesTheSecondDifference) {
  Scene scene(Side::wall);
  const auto wave = [](int k) { return 40 + std::sin(0.2 * M_PI * k); };
  scene.set([&](int d, int, int, int k) { return d == 2 ? wave(k) : 0; });
  scene.add();
  for (int k = 0; k < 10; ++k) {
    const double low = 0.5 * (wave(k - 1) + wave(k)), high = 0.5 * (wave(k) + wave(k + 1)),
                 expected = 0.5 / h * (high * (wave(k + 1) - wave(k)) - low * (wave(k) - wave(k - 1)));
    EXPECT_NEAR(scene.rate[2](0, 2, k), expected, 1e-12);
    EXPECT_NEAR(scene.rate[2](7, 2, k), expected, 1e-12);
    EXPECT_NEAR(scene.next[2](7, 2, k), weight * expected, 1e-12);
    for (const int i : {1, 2, 3, 4, 5, 6}) EXPECT_EQ(scene.rate[2](i, 2, k), 0) << i;
  }
}

TEST(WallUpwind, KeepsMomentumAndTakesEnergyBesideABody) {
  Scene scene(Side::periodic);
  scene.solids.mark_inside(
      scene.solids.add_body("ball"), [](const Vec3& x) { return (x - Vec3(2, 1.5, 2.5)).norm() - 0.8; },
      Vec3::Zero(), Vec3(4, 3, 5));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-50, 50);
  scene.set([&](int, int, int, int) { return uniform(random); });
  scene.add();
  for (int d = 0; d < 3; ++d) {
    double sum = 0, size = 0, power = 0;
    for (int k = 0; k < 10; ++k) {
      for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < 8; ++i) {
          sum += scene.rate[d](i, j, k);
          size += std::abs(scene.rate[d](i, j, k));
          power += scene.velocity[d](i, j, k) * scene.rate[d](i, j, k);
          if (scene.solids.owner(d, i, j, k) != 0) {
            EXPECT_EQ(scene.rate[d](i, j, k), 0);
          }
        }
      }
    }
    EXPECT_GT(size, 0);
    EXPECT_LT(std::abs(sum), 1e-12 * size);
    EXPECT_LT(power, 0);
  }
}

TEST(WallUpwind, FollowsTheSolids) {
  Scene scene(Side::periodic);
  const int body = scene.solids.add_body("strut");
  scene.upwind.update(scene.solids);
  EXPECT_EQ(scene.upwind.faces(), 0U);
  scene.solids.mark_segments(body, {Vec3(1, 1, 1), Vec3(3, 1, 1)}, {{0, 1}}, 0.4);
  scene.upwind.update(scene.solids);
  EXPECT_GT(scene.upwind.faces(), 0U);
  scene.solids.clear_body(body);
  scene.upwind.update(scene.solids);
  EXPECT_EQ(scene.upwind.faces(), 0U);
}
