#include <cmath>

#include "box_obj.hpp"
#include "run_case.hpp"

using namespace valsalva;
using test::CaseRun;

namespace {

// A box of 2 x 1 x 4 mm and 8 mg as a closed surface, in a file of its own.
const std::string box_file = test::box_obj({-1, -0.5, -2}, {1, 0.5, 2});

const std::string box = R"(
[[body]]
name = "box"
kind = "rigid"
motion = "free"
file = "box.obj"
density_g_per_mm3 = 1e-3
)";

}  // namespace

TEST(DryRigid, PropertiesOfABox) {
  const auto run = CaseRun::of_text(box + "[dynamics]\nend_s = 1e-3\n", {{"box.obj", box_file}});
  const auto& p = run->scene.rigid.at(0)->properties();
  EXPECT_NEAR(p.mass_g, 8e-3, 1e-15);
  EXPECT_LT(p.centre.norm(), 1e-14);
  const Vec3 exact(8e-3 / 12 * (1 + 16), 8e-3 / 12 * (4 + 16), 8e-3 / 12 * (4 + 1));
  EXPECT_LT((p.inertia - Mat3(exact.asDiagonal())).norm(), 1e-15);
}

// About the middle axis a free top tumbles.
TEST(DryRigid, TumblingTopKeepsMomentumAndEnergy) {
  const auto text = [](const char* step) {
    return box + "spin_rad_per_s = [100, 0.1, 0.2]\nvelocity_mm_per_s = [1, 2, 3]\n" + R"(
[[probe]]
name = "turning"
quantity = "angular_momentum"
component = "direction"
direction = [1, 0, 0]
[dynamics]
end_s = 1
step_s = )" +
           step + "\n";
  };
  const auto worst_energy = [&](const char* step) {
    const auto run = CaseRun::of_text(text(step), {{"box.obj", box_file}});
    const structure::RigidBody& body = *run->scene.rigid.at(0);
    const Vec3 turning = body.angular_momentum(), moving = body.momentum();
    const double energy = body.kinetic_energy();
    double worst = 0, least = 1;
    while (!run->march->finished()) {
      run->march->step();
      const Vec3 now = body.angular_momentum() - body.centre().cross(body.momentum());
      EXPECT_LT((now - turning).norm(), 1e-9 * turning.norm());
      EXPECT_LT((body.momentum() - moving).norm(), 1e-12 * moving.norm());
      worst = std::max(worst, std::abs(body.kinetic_energy() / energy - 1));
      least = std::min(least, body.rotation().toRotationMatrix()(0, 0));
    }
    EXPECT_LT(least, -0.9) << "it turned over";
    return worst;
  };
  const double coarse = worst_energy("1e-3"), fine = worst_energy("5e-4");
  std::printf("free top: energy off by %.2e, %.2e with half the step\n", coarse, fine);
  EXPECT_LT(fine, 1e-3);
  EXPECT_GT(coarse / fine, 3);
}

TEST(DryRigid, SphereBouncesToTheSameHeight) {
  const auto run = CaseRun::of_text(R"(
[[body]]
name = "ball"
kind = "rigid"
motion = "free"
shape = "sphere"
radius_mm = 2
divisions = [24, 12]
origin_mm = [0, 0, 5]
density_g_per_mm3 = 1e-3
[[load]]
name = "weight"
kind = "gravity"
acceleration_mm_per_s2 = [0, 0, -9810]
[[contact_pair]]
name = "floor"
body = "ball"
surface = "plane"
stiffness_kPa_per_mm = 1e3
[[nodes]]
name = "ball"
body = "ball"
[[probe]]
name = "z"
quantity = "position"
of = "ball"
component = "z"
[dynamics]
end_s = 0.5
)");
  double lowest = 1e300, highest_later = 0;
  int bounces = 0;
  double before = 0;
  while (!run->march->finished()) {
    run->march->step();
    const double z = run->scene.rigid[0]->centre().z(), v = run->scene.rigid[0]->velocity().z();
    lowest = std::min(lowest, z);
    if (before < 0 && v > 0) ++bounces;
    if (bounces >= 3) highest_later = std::max(highest_later, z);
    before = v;
  }
  EXPECT_GE(bounces, 5);
  EXPECT_LT(lowest, 2.0);
  EXPECT_GT(lowest, 1.7);
  EXPECT_NEAR(highest_later, 5, 0.01);
}

TEST(DryRigid, BlockSlidesDownARigidSlope) {
  const auto run = CaseRun::of_text(box + R"(
[[load]]
name = "weight"
kind = "gravity"
acceleration_mm_per_s2 = [4905, 0, -8495.7092]
[[contact_pair]]
name = "plane"
body = "box"
surface = "plane"
point_mm = [0, 0, -2]
stiffness_kPa_per_mm = 100
friction = 0.3
[dynamics]
end_s = 0.1
)",
                                    {{"box.obj", box_file}});
  run->to_end();
  const double expected = 0.1 * 9810 * (std::sin(M_PI / 6) - 0.3 * std::cos(M_PI / 6));
  EXPECT_NEAR(run->scene.rigid[0]->velocity().x(), expected, 0.01 * expected);
}

TEST(DryRigid, RelaxationFindsTheWeightOnTheFloor) {
  const auto run = CaseRun::of_text(box + R"(
[[load]]
name = "weight"
kind = "gravity"
acceleration_mm_per_s2 = [0, 0, -9810]
[[contact_pair]]
name = "floor"
body = "box"
surface = "plane"
point_mm = [0, 0, -2]
stiffness_kPa_per_mm = 10
[[nodes]]
name = "box"
body = "box"
[[support]]
name = "upright"
nodes = "box"
hold = ["x", "y", "rx", "ry", "rz"]
[[probe]]
name = "push"
quantity = "contact_force"
of = "floor"
component = "z"
[dynamics]
solver = "quasi_static"
load_steps = 2
)",
                                    {{"box.obj", box_file}});
  run->to_end();
  EXPECT_NEAR(run->probe("push_N"), 8e-3 * 9810e-6, 1e-3 * 8e-3 * 9810e-6);
}

TEST(DryRigid, NewtonRefusesFreeBodies) {
  EXPECT_THROW(CaseRun::of_text(box + "[dynamics]\nsolver = \"static\"\n", {{"box.obj", box_file}}),
               InputError);
}
