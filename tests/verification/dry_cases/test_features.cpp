#include <cmath>

#include "box_obj.hpp"
#include "materials/superelastic.hpp"
#include "run_case.hpp"
#include "tables.hpp"

using namespace valsalva;
using test::CaseRun;

// Boundary nodes follow x -> x + G x: so do the inner ones, and the stress is uniform.
TEST(DryFeatures, PatchTestByAPrescribedGradient) {
  for (const char* element : {"tet4", "tet10", "hex8", "hex27"}) {
    const auto run = CaseRun::of_text(std::string(R"(
[[body]]
name = "block"
kind = "solid"
shape = "corners"
corners_mm = [0, 0, 0,  2, 0.2, 0,  2.2, 1.1, 0.1,  0.1, 1, 0,  0, 0.1, 1,  2, 0, 1.2,  2.1, 1, 1,  0, 1.2, 1.1]
divisions = [3, 3, 3]
law = "neo-hookean"
law_parameters = ["mu_Pa = 1000"]
volumetric = "j-ln-j"
bulk_modulus_kPa = 3
element = ")") + element + R"("
[[nodes]]
name = "rim"
body = "block"
select = "border"
[[nodes]]
name = "all"
body = "block"
[[nodes]]
name = "inside"
body = "block"
select = "difference"
sets = ["all", "rim"]
[[support]]
name = "rim"
nodes = "rim"
hold = ["x", "y", "z"]
gradient = [0.1, 0.05, 0, 0, -0.05, 0.02, 0.03, 0, 0.08]
[[probe]]
name = "low"
quantity = "stress"
component = "xx"
point_mm = [0.3, 0.3, 0.3]
of = "block"
[[probe]]
name = "high"
quantity = "stress"
component = "xx"
point_mm = [1.8, 0.8, 0.8]
of = "block"
[dynamics]
solver = "static"
load_steps = 2
)");
    run->to_end();
    Mat3 g;
    g << 0.1, 0.05, 0, 0, -0.05, 0.02, 0.03, 0, 0.08;
    const Points& start = run->scene.bodies[0].mesh.points;
    ASSERT_GT(run->scene.nodes.at("inside").size(), 7u);
    for (int a : run->scene.nodes.at("inside"))
      EXPECT_LT((run->scene.system->state.x[a] - start[a] - g * start[a]).norm(), 1e-8) << element;
    EXPECT_NEAR(run->probe("low_kPa"), run->probe("high_kPa"), 1e-7 * std::abs(run->probe("low_kPa")))
        << element;
  }
}

// A beam whose end is turned by half a turn and may move: half a circle, M = E I theta/L.
TEST(DryFeatures, BeamTurnedAtItsEnd) {
  for (const char* solver : {"static", "quasi_static"}) {
    const auto run = CaseRun::of_text(std::string(R"(
[[body]]
name = "beam"
kind = "beams"
shape = "line"
size_mm = [10]
divisions = [20]
width_mm = 1
depth_mm = 0.1
young_kPa = 1200
poisson = 0
)") + test::held("beam", "start1", "[\"all\"]") +
                                      test::held("beam", "end1", "[\"rx\", \"ry\", \"rz\"]") +
                                      R"(turn_axis = [0, -1, 0]
turn_deg = 180
[[probe]]
name = "tip"
quantity = "position"
of = "end1"
component = "z"
[[probe]]
name = "moment"
quantity = "reaction_moment"
of = "end1"
component = "y"
[dynamics]
load_steps = 10
solver = ")" + solver + "\"\n");
    run->to_end();
    EXPECT_NEAR(run->probe("tip_mm"), 2 * 10 / M_PI, 0.01 * 20 / M_PI) << solver;
    const double moment = 1.2e6 * 1e-3 / 12 * M_PI / 10 * 1e-6;  // N mm
    EXPECT_NEAR(run->probe("moment_N_mm") - 0, -moment, 0.01 * moment) << solver;
  }
}

TEST(DryFeatures, SuperelasticBarFollowsItsLoop) {
  const auto run = CaseRun::of_text(R"(
[[body]]
name = "bar"
kind = "beams"
shape = "line"
size_mm = [10]
divisions = [4]
width_mm = 0.5
depth_mm = 0.2
law = "superelastic"
law_parameters = ["austenite_Pa = 50e9", "martensite_Pa = 30e9", "poisson = 0.3", "transformation_strain = 0.05",
                  "loading_start_Pa = 400e6", "loading_finish_Pa = 450e6", "unloading_start_Pa = 250e6",
                  "unloading_finish_Pa = 200e6"]
)" + test::held("bar", "start1", "[\"all\"]") +
                                    test::held("bar", "end1", "[\"all\"]") +
                                    R"(displacement_mm = [0.4, 0, 0]
time_s = [0, 1, 2]
factor = [0, 1, 0]
[[probe]]
name = "pull"
quantity = "reaction"
of = "end1"
component = "x"
[dynamics]
solver = "static"
end_s = 2
load_steps = 20
)");
  materials::SuperelasticParameters p;
  p.austenite_Pa = 50e9;
  p.martensite_Pa = 30e9;
  p.poisson = 0.3;
  p.transformation_strain = 0.05;
  p.loading_start_Pa = p.compression_start_Pa = 400e6;
  p.loading_finish_Pa = 450e6;
  p.unloading_start_Pa = 250e6;
  p.unloading_finish_Pa = 200e6;
  const materials::Superelastic law(p);
  materials::SuperelasticState state;
  double most = 0;
  while (!run->march->finished()) {
    run->march->step();
    const double t = run->scene.system->state.time_s;
    state = law.respond(state, 0.04 * (t < 1 ? t : 2 - t)).state;
    EXPECT_NEAR(run->probe("pull_N"), 0.1 * state.stress_Pa * 1e-6, 1e-6 * 50) << t;
    most = std::max(most, state.martensite);
  }
  EXPECT_GT(most, 0.5);
  EXPECT_NEAR(run->probe("pull_N"), 0, 1e-5);
}

// Beyond the limit point, where a prescribed pressure finds nothing.
TEST(DryFeatures, SphereByItsVolume) {
  const auto table = test::reference("sphere_inflation_neo_hookean.csv");
  if (table.empty()) GTEST_SKIP() << "the reference table sphere_inflation_neo_hookean.csv is not there";
  CaseRun run("sphere_volume.toml");
  run.to_end();
  for (const auto& row : table) {
    if (std::stod(row[0]) != 2) continue;  // the run's volume ratio is 8
    EXPECT_NEAR(run.probe("filling_kPa"), 100 * std::stod(row[3]), 0.02 * 100 * std::stod(row[3]));
  }
}

TEST(DryFeatures, BodiesCollideWithoutLossOfMomentum) {
  const auto run = CaseRun::of_text(R"(
[[body]]
name = "left"
kind = "solid"
shape = "box"
size_mm = [1, 1, 1]
divisions = [2, 2, 2]
)" + test::tissue + R"(
velocity_mm_per_s = [200, 0, 0]
[[body]]
name = "right"
kind = "solid"
shape = "box"
origin_mm = [1.5, 0.2, 0.3]
size_mm = [1, 1, 1]
divisions = [2, 2, 2]
)" + test::tissue + R"(
[[contact_pair]]
name = "meet"
body = "left"
other = "right"
distance_mm = 0.1
[[probe]]
name = "all"
quantity = "momentum"
component = "x"
[[probe]]
name = "right"
quantity = "momentum"
of = "right"
component = "x"
[dynamics]
end_s = 0.02
safety = 0.2
)");
  const double start = run->probe("all_g_mm_per_s"), energy = run->march->kinetic_nJ();
  double most = 0, least = 1e300;
  while (!run->march->finished()) {
    const double before = run->march->kinetic_nJ();
    run->march->step();  // velocities stand half a step before and after the positions
    const double now = 0.5 * (before + run->march->kinetic_nJ()) + run->march->stored_nJ();
    most = std::max(most, now);
    least = std::min(least, now);
  }
  std::printf("collision: energy from %.5f to %.5f of the start\n", least / energy, most / energy);
  EXPECT_NEAR(run->probe("all_g_mm_per_s"), start, 1e-9 * start);
  EXPECT_GT(run->probe("right_g_mm_per_s"), 0.7 * start);
  EXPECT_GT(least, 0.98 * energy);
  EXPECT_LT(most, 1.02 * energy);
}

// A level set stands for the plane.
TEST(DryFeatures, BlockSlidesOnALevelSet) {
  const std::string block = R"(
[[body]]
name = "block"
kind = "solid"
shape = "box"
size_mm = [2, 2, 1]
divisions = [2, 2, 1]
law = "linear"
young_kPa = 100
density_g_per_mm3 = 1e-3
[[load]]
name = "weight"
kind = "gravity"
acceleration_mm_per_s2 = [4905, 0, -8495.7092]
[[nodes]]
name = "block"
body = "block"
[[contact_pair]]
name = "slope"
body = "block"
surface = "level_set"
file = "slab.obj"
spacing_mm = 0.5
stiffness_kPa_per_mm = 10
friction = 0.3
[[probe]]
name = "speed"
quantity = "velocity"
of = "block"
component = "x"
[dynamics]
end_s = 0.05
)";
  const auto run = CaseRun::of_text(block, {{"slab.obj", test::box_obj({-4, -4, -3}, {16, 6, 0})}});
  run->to_end();
  const double expected = 0.05 * 9810 * (std::sin(M_PI / 6) - 0.3 * std::cos(M_PI / 6));
  EXPECT_NEAR(run->probe("speed_mm_per_s"), expected, 0.02 * expected);
}

// A zigzag ring of nitinol from a mesh file, crimped by a cylinder from 20 to 14 mm and let go: a plateau,
// less force on the way back, and its shape again.
TEST(DryFeatures, SuperelasticStentInACrimper) {
  constexpr int struts = 12, beams = 4, count = struts * beams;
  std::string points, lines;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count, up = static_cast<double>(i % beams) / beams;
    points += fmt::format("{:.15g} {:.15g} {:.15g}\n", 10 * std::cos(angle), 10 * std::sin(angle),
                          6 * (i / beams % 2 == 0 ? up : 1 - up));
    lines += fmt::format("2 {} {}\n", i, (i + 1) % count);
  }
  std::string types;
  for (int i = 0; i < count; ++i) types += "3\n";
  const std::string file = fmt::format(
      "# vtk DataFile Version 3.0\nring\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n{}CELLS {} "
      "{}\n{}"
      "CELL_TYPES {}\n{}",
      count, points, count, 3 * count, lines, count, types);
  const auto at = [](const std::string& name, const std::string& place, const std::string& hold) {
    return "[[nodes]]\nname = \"" + name + "\"\nbody = \"ring\"\n" + place + test::support(name, hold);
  };
  const auto run =
      CaseRun::of_text(R"(
[[body]]
name = "ring"
kind = "beams"
file = "ring.vtk"
width_mm = 0.25
depth_mm = 0.2
depth = "radial"
material = "nitinol-62.9"
fibre_grid = [5, 3, 2]
[[nodes]]
name = "ring"
body = "ring"
)" + at("low", "select = \"plane\"\n", "[\"z\"]") +
                           at("right", "select = \"nearest\"\npoint_mm = [10, 0, 0]\n", "[\"y\"]") +
                           at("front", "select = \"nearest\"\npoint_mm = [0, 10, 6]\n", "[\"x\"]") +
                           R"(
[[contact_pair]]
name = "crimper"
body = "ring"
surface = "cylinder"
inside = true
radius_mm = 10.2
radius_change_mm = -3.2
stiffness_kPa_per_mm = 1e5
time_s = [0, 1, 2]
factor = [0, 1, 0]
[[probe]]
name = "push"
quantity = "contact_force"
of = "crimper"
component = "radial"
[[probe]]
name = "radius"
quantity = "position"
of = "ring"
component = "radial"
[dynamics]
solver = "static"
end_s = 2
load_steps = 16
)",
                       {{"ring.vtk", file}});
  std::vector<double> push{0}, radius{10};
  while (!run->march->finished()) {
    run->march->step();
    push.push_back(-run->probe("push_N"));
    radius.push_back(run->probe("radius_mm"));
  }
  std::printf("crimped ring: N at");
  for (int k : {4, 6, 8, 10, 12}) std::printf(" %.2f mm %.3f,", radius[k], push[k]);
  std::printf("\n");
  EXPECT_LT(radius[8], 7.3);
  EXPECT_LT(push[8] - push[6], 0.2 * (push[4] - push[2])) << "plateau";
  for (int k : {10, 12, 14}) {
    EXPECT_NEAR(radius[k], radius[16 - k], 0.05) << "the crimper is stiff";
    EXPECT_LT(push[k], (k == 14 ? 1 : 0.9) * push[16 - k]) << k;  // at 14 hardly any martensite is left
    EXPECT_GT(push[k], 0) << k;
  }
  EXPECT_NEAR(push[16], 0, 1e-9);
  EXPECT_NEAR(radius[16], 10, 1e-6);
}

// A ring in a cylinder that closes: hoop force E A u/R, 2 pi of it inwards in all.
TEST(DryFeatures, RingInACylinderThatCloses) {
  const auto run = CaseRun::of_text(R"(
[[body]]
name = "ring"
kind = "beams"
shape = "arc"
radius_mm = 10
angle_deg = [0, 360]
divisions = [64]
width_mm = 2
depth_mm = 2
young_kPa = 1000
poisson = 0.3
[[nodes]]
name = "ring"
body = "ring"
[[nodes]]
name = "right"
body = "ring"
select = "nearest"
point_mm = [10, 0, 0]
[[nodes]]
name = "top"
body = "ring"
select = "nearest"
point_mm = [0, 10, 0]
[[support]]
name = "plane"
nodes = "ring"
hold = ["z", "rx", "ry"]
[[support]]
name = "right"
nodes = "right"
hold = ["y"]
[[support]]
name = "top"
nodes = "top"
hold = ["x"]
[[contact_pair]]
name = "crimper"
body = "ring"
surface = "cylinder"
inside = true
radius_mm = 11
radius_change_mm = -0.03
offset_mm = 1
stiffness_kPa_per_mm = 1e4
[[probe]]
name = "push"
quantity = "contact_force"
of = "crimper"
component = "radial"
[[probe]]
name = "closing"
of = "ring"
component = "radial"
[[probe]]
name = "radius"
quantity = "position"
of = "ring"
statistic = "max"
component = "radial"
[dynamics]
solver = "static"
load_steps = 2
)");
  run->to_end();
  const double u = run->probe("closing_mm");
  EXPECT_LT(u, -0.025);
  EXPECT_NEAR(run->probe("radius_mm"), 10 + u, 1e-4);
  const double push = 2 * M_PI * 1 * 4 * u / 10;  // N, of E in N/mm2
  EXPECT_NEAR(run->probe("push_N"), push, 0.01 * std::abs(push));
}
