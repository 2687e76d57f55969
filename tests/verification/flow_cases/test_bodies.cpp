// Deformable bodies in the fluid of a case file.
#include <cmath>

#include "coupling/immersed_structure.hpp"
#include "materials/st_venant_kirchhoff.hpp"
#include "run_case.hpp"
#include "solid_meshes.hpp"
#include "structure/dead_load.hpp"
#include "structure/solid.hpp"

using namespace valsalva;
using test::FlowRun;

namespace {

/// A cantilever of hex8 in a closed box of fluid, under an even acceleration across; four times as dense.
constexpr double step_s = 2e-4;
const char* const cantilever = R"toml(
[fluid]
box_mm = [0, 0, 0, 16, 12, 10]
grid_mm = 1
density_g_per_mm3 = 1e-3
viscosity_Pa_s = 0.01
step_s = 2e-4
end_s = 4e-3
history_rows = 20
[[boundary]]
name = "walls"
sides = ["all"]
kind = "wall"
[[body]]
name = "beam"
kind = "solid"
shape = "box"
origin_mm = [3, 5, 4]
size_mm = [9, 2, 2]
divisions = [9, 2, 2]
law = "linear"
young_kPa = 2
poisson = 0.3
formulation = "displacement"
density_g_per_mm3 = 4e-3
[[nodes]]
name = "foot"
body = "beam"
select = "group"
group = "start1"
[[support]]
name = "foot"
nodes = "foot"
hold = ["all"]
[[load]]
name = "weight"
kind = "gravity"
acceleration_mm_per_s2 = [0, -3000, 500]
[[nodes]]
name = "tip"
body = "beam"
select = "nearest"
point_mm = [12, 5, 4]
[[probe]]
name = "tip_y"
of = "tip"
component = "y"
[[probe]]
name = "tip_z"
of = "tip"
component = "z"
[coupling]
kernel = "ib4"
tie_rate_per_s = 300
)toml";

/// The same composed by hand; displacement of the tip.
Vec3 by_hand(int steps) {
  const structure::SolidMesh mesh =
      structure::solid_box(structure::Shape::hex8, {9, 2, 2},
                           [](const Vec3& u) { return Vec3(3 + 9 * u.x(), 5 + 2 * u.y(), 4 + 2 * u.z()); });
  const double young = 2000, poisson = 0.3, density = 4e-3, fluid_density = 1e-3;
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
               shear = 0.5 * young / (1 + poisson);
  const auto solid = std::make_shared<structure::Solid>(
      mesh,
      std::make_shared<materials::SolidLaw>(std::make_shared<materials::StVenantKirchhoff>(lambda, shear),
                                            materials::Volumetric{}, materials::Split::full),
      structure::Formulation::displacement);
  auto system = std::make_unique<structure::System>();
  const structure::Body body = system->add_body("beam", mesh.reference, solid->lumped_mass(density));
  int tip = 0;
  for (int a = 0; a < body.count; ++a) {
    if (mesh.reference[a].x() < 3 + 1e-9)
      for (int d = 0; d < 3; ++d) system->hold_along(a, Vec3::Unit(d));
    if ((mesh.reference[a] - Vec3(12, 5, 4)).norm() < 1e-9) tip = a;
  }
  std::vector<std::shared_ptr<structure::ForceTerm>> terms{
      std::make_shared<structure::SolidTerm>(solid, body),
      std::make_shared<structure::DeadLoadTerm>("weight",
                                                structure::weight_of(*system, body, Vec3(0, -3000, 500)),
                                                Points{}, [](double) { return 1.0; })};
  fluid::Boundaries walls;
  for (auto& sides : walls.side) sides = {fluid::Side::wall, fluid::Side::wall};
  fluid::FlowParameters parameters;
  parameters.density = fluid_density;
  parameters.viscosity = 0.01;
  fluid::Flow flow(MPI_COMM_SELF, {{16, 12, 10}, Vec3::Zero(), 1}, walls, parameters);
  coupling::ImmersedStructureSettings settings;
  settings.cells = coupling::cells_of(mesh);
  settings.sampling_mm = 0.5;
  settings.tie_rate_per_s = 300;
  settings.keep_volume = true;
  settings.lead = coupling::step_lead;
  coupling::add_excess_mass(*system, body, density, fluid_density, settings.excess_mass_g);
  coupling::ImmersedFlowSettings coupled;
  coupled.limits.largest_s = 1;
  coupling::ImmersedFlow run(
      flow, std::make_unique<coupling::ImmersedStructure>(std::move(system), terms, mesh.reference, settings),
      coupled);
  for (int i = 0; i < steps; ++i) EXPECT_NEAR(run.step(step_s).dt_s, step_s, 1e-15);
  return run.body()->x()[tip] - mesh.reference[tip];
}

std::map<std::string, state::Array> arrays_at_end(FlowRun& run) {
  return run.to_end().scene.save();
}

void expect_same(const std::map<std::string, state::Array>& a, const std::map<std::string, state::Array>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, array] : a) EXPECT_EQ(array.data, b.at(name).data) << name;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  if (at == std::string::npos) throw std::logic_error("no " + what);
  return text.replace(at, what.size(), by);
}

}  // namespace

TEST(FlowBodies, ACantileverIsThatComposedByHand) {
  FlowRun run(cantilever);
  run.to_end();
  const Vec3 direct = by_hand(20);
  const double y = run.metric("tip_y_mm"), z = run.metric("tip_z_mm");
  std::printf("tip %.12g %.12g, by hand %.12g %.12g\n", y, z, direct.y(), direct.z());
  EXPECT_LT(y, -0.001);
  EXPECT_NEAR(y, direct.y(), 1e-12);
  EXPECT_NEAR(z, direct.z(), 1e-12);
  EXPECT_EQ(run.scene.steps(), 20);
}

// Sides open along x are solved in turned axes: with the axes of the case turned along, all is the same.
TEST(FlowBodies, TurnedAxesGiveTheSame) {
  const auto tip = [](const std::string& open, const char* up, std::array<Vec3, 4> places, int across,
                      const std::string& box) {
    const auto text = [](const Vec3& v) { return fmt::format("[{}, {}, {}]", v[0], v[1], v[2]); };
    FlowRun run(fmt::format(R"toml(
[fluid]
box_mm = {}
grid_mm = 1
viscosity_Pa_s = 0.01
end_s = 6e-3
history_rows = 6
[[boundary]]
name = "ends"
sides = ["{}"]
kind = "outflow"
pressure_Pa = 0
[[body]]
name = "flap"
shape = "corners"
corners_mm = [{}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}]
divisions = [6, 8]
thickness_mm = 0.5
law = "linear"
young_kPa = 500
density_g_per_mm3 = 2e-3
[[nodes]]
name = "foot"
body = "flap"
select = "group"
group = "start1"
[[support]]
name = "foot"
nodes = "foot"
hold = ["all"]
[[nodes]]
name = "end"
body = "flap"
select = "group"
group = "end1"
[[load]]
name = "pull"
nodes = "end"
force_N = {}
[[probe]]
name = "end"
of = "end"
component = "{}"
[coupling]
kernel = "ib4"
)toml",
                            box, open, places[0][0], places[0][1], places[0][2], places[1][0], places[1][1],
                            places[1][2], places[2][0], places[2][1], places[2][2], places[3][0],
                            places[3][1], places[3][2], text(1e-4 * Vec3::Unit(across)), up));
    run.to_end();
    return run.metric("end_mm");
  };
  const auto turned = [](const Vec3& v) { return Vec3(v[2], v[0], v[1]); };  // x -> y -> z -> x
  const std::array<Vec3, 4> places{Vec3(4, 3, 6), Vec3(7, 3, 6), Vec3(7, 7, 6), Vec3(4, 7, 6)};
  std::array<Vec3, 4> other;
  for (int i = 0; i < 4; ++i) other[i] = turned(places[i]);
  const double one = tip("z", "z", places, 2, "[0, 0, 0, 11, 10, 12]"),
               two = tip("x", "x", other, 0, "[0, 0, 0, 12, 11, 10]");
  std::printf("end %.12g, turned %.12g\n", one, two);
  EXPECT_GT(one, 0.01);
  EXPECT_NEAR(one, two, 1e-9);
}

TEST(FlowBodies, AResumedRunIsTheSameBitForBit) {
  const std::string text = replaced(replaced(cantilever, "step_s = 2e-4\n", ""), "hold = [\"all\"]",
                                    "hold = [\"all\"]\ndisplacement_mm = [0, 0, 0.3]\n"
                                    "time_s = [0, 1e-3, 4e-3]\nfactor = [0, 1, 0.5]") +
                           R"toml(
[[body]]
name = "sheet"
shape = "plate"
origin_mm = [4, 3.4, 3]
size_mm = [6, 4]
direction2 = [0, 0, 1]
divisions = [12, 8]
thickness_mm = 0.2
law = "neo-hookean"
law_parameters = ["mu_Pa = 2e4"]
[[contact_pair]]
name = "touch"
body = "beam"
other = "sheet"
distance_mm = 1.4
modulus_kPa = 1
[[flow_probe]]
name = "force"
quantity = "force"
of = "beam"
)toml";
  FlowRun whole(text), before(text), after(text);
  for (int step = 0; step < 17; ++step) before.step();
  state::State stored;
  stored.restart = before.scene.save();
  after.scene.load(stored);
  expect_same(arrays_at_end(whole), arrays_at_end(after));
  EXPECT_GT(whole.scene.steps(), 17);
}

// What a body that is pulled, a sheet that is held and the fluid's own force give goes into the momentum of
// fluid and bodies, all of it: in a periodic box to round-off.
TEST(FlowBodies, MomentumBalances) {
  FlowRun run(R"toml(
[fluid]
box_mm = [0, 0, 0, 12, 10, 8]
grid_mm = 1
density_g_per_mm3 = 1e-3
viscosity_Pa_s = 0.02
end_s = 0.01
history_rows = 50
body_force_Pa_per_mm = ["0.5", "0", "0"]
velocity = ["3", "0", "2*sin(pi*x/6)"]
[[boundary]]
name = "all"
sides = ["all"]
kind = "periodic"
[[body]]
name = "ball"
kind = "solid"
shape = "box"
origin_mm = [2, 3, 3]
size_mm = [3, 3, 3]
divisions = [3, 3, 3]
law = "linear"
young_kPa = 3
density_g_per_mm3 = 3e-3
[[load]]
name = "weight"
kind = "gravity"
body = "ball"
acceleration_mm_per_s2 = [0, 1000, 0]
[[flow_probe]]
name = "all"
quantity = "momentum"
[[flow_probe]]
name = "on_ball"
quantity = "force"
of = "ball"
[[probe]]
name = "ball_x"
quantity = "momentum"
of = "ball"
component = "x"
[[probe]]
name = "ball_y"
quantity = "momentum"
of = "ball"
component = "y"
)toml");
  run.to_end();
  const History& h = run.scene.history();
  const std::size_t last = h.rows() - 1;
  const auto gain = [&](const char* name) { return h.at(last, name) - h.at(0, name); };
  const double fluid_volume = 12 * 10 * 8 - 27, duration = 0.01, weight = 3e-3 * 27 * 1000;
  std::printf("momentum gained %.15g (force times time %.15g), %.15g (%.15g), %.3g\n",
              gain("all_x_g_mm_per_s"), 0.5 * fluid_volume * duration, gain("all_y_g_mm_per_s"),
              weight * duration, gain("all_z_g_mm_per_s"));
  EXPECT_NEAR(gain("all_x_g_mm_per_s"), 0.5 * fluid_volume * duration, 1e-10);
  EXPECT_NEAR(gain("all_y_g_mm_per_s"), weight * duration, 1e-10);
  EXPECT_NEAR(gain("all_z_g_mm_per_s"), 0, 1e-10);
  // The force on the ball is what its momentum gains beyond its weight.
  double impulse = 0;
  for (std::size_t i = 1; i <= last; ++i)
    impulse += 1e6 * h.at(i, "on_ball_y_N") * (h.at(i, "time_s") - h.at(i - 1, "time_s"));
  std::printf("impulse of the fluid %.5g, momentum less weight %.5g\n", impulse,
              gain("ball_y_g_mm_per_s") - weight * duration);
  EXPECT_NEAR(impulse, gain("ball_y_g_mm_per_s") - weight * duration, 0.03 * weight * duration);
}

// Weight and buoyancy: as dense as the fluid a body stays where it is, heavier it falls, lighter it rises;
// tethers carry its weight less that of the fluid it displaces.
TEST(FlowBodies, WeightAndBuoyancy) {
  const auto run = [](double density, const std::vector<std::string>& more, const std::string& held = "") {
    std::vector<std::string> overrides{fmt::format("body.ball.density_g_per_mm3={}", density)};
    overrides.insert(overrides.end(), more.begin(), more.end());
    auto one = std::make_unique<FlowRun>(R"toml(
[fluid]
box_mm = [0, 0, 0, 14, 14, 14]
grid_mm = 1
density_g_per_mm3 = 1e-3
viscosity_Pa_s = 1e-3
end_s = 0.01
history_rows = 10
body_force_Pa_per_mm = ["0", "0", "-9.81"]
[[boundary]]
name = "walls"
sides = ["all"]
kind = "wall"
[[body]]
name = "ball"
kind = "solid"
shape = "ball"
origin_mm = [7, 7, 7]
radius_mm = 2.5
divisions = [4, 4, 4]
law = "linear"
young_kPa = 5
[[load]]
name = "weight"
kind = "gravity"
acceleration_mm_per_s2 = [0, 0, -9810]
[[nodes]]
name = "all"
body = "ball"
select = "all"
[[probe]]
name = "ball"
of = "all"
component = "z"
[[probe]]
name = "content"
quantity = "volume"
of = "ball"
[[flow_probe]]
name = "lift"
quantity = "force"
of = "ball"
component = "z"
[coupling]
kernel = "ib4"
)toml" + held,
                                         overrides);
    one->to_end();
    return one;
  };
  const auto still = run(1e-3, {}), heavy = run(3e-3, {}), light = run(5e-4, {"coupling.excess_mass=false"});
  std::printf("as dense: %.3g mm; three times: %.4f mm; half: %.4f mm\n", still->metric("ball_mm"),
              heavy->metric("ball_mm"), light->metric("ball_mm"));
  EXPECT_LT(std::abs(still->metric("ball_mm")), 1e-6);
  const double free_fall = -0.5 * 9810 * 0.01 * 0.01 * 2 / 3;  // without the fluid's inertia
  EXPECT_LT(heavy->metric("ball_mm"), 0.3 * free_fall);
  EXPECT_GT(heavy->metric("ball_mm"), free_fall);
  EXPECT_GT(light->metric("ball_mm"), 0.01);

  const auto hung = run(3e-3, {"fluid.viscosity_Pa_s=0.6", "fluid.end_s=0.15"}, R"toml(
[[support]]
name = "strings"
nodes = "all"
hold = ["z"]
stiffness_N_per_mm = 5e-5
[[probe]]
name = "strings"
quantity = "reaction"
of = "strings"
component = "z"
)toml");
  const double volume = hung->metric("content_mm3"), weight = 9810e-6 * 2e-3 * volume;
  std::printf("strings carry %.5g N, weight less displaced fluid's %.5g N; lift %.5g of %.5g N\n",
              hung->metric("strings_N"), weight, hung->metric("lift_N"), 0.5 * weight);
  EXPECT_NEAR(hung->metric("strings_N") / weight, 1, 0.02);
  EXPECT_NEAR(hung->metric("lift_N") / (0.5 * weight), 1, 0.04);
}

// Stretched by a tenth, a round membrane stands under the pressure of Laplace's law and keeps its content.
TEST(FlowBodies, AClosedMembraneKeepsItsContent) {
  FlowRun run(FlowRun::library("fsi-membrane.toml"), {"fluid.end_s=0.05", "fluid.history_rows=5"});
  const double before = run.metric("content_mm3");
  run.to_end();
  const double leak = run.metric("content_mm3") / before - 1, pressure = run.metric("inside_Pa") / 870.1;
  std::printf("content changed by %.3g, pressure over Laplace's %.4f\n", leak, pressure);
  EXPECT_LT(std::abs(leak), 1e-4);
  EXPECT_NEAR(pressure, 1, 0.02);
}

// A flap on the floor of a channel stands on the side of the box itself.
TEST(FlowBodies, AFlapOnAWallBendsDownstream) {
  FlowRun run(FlowRun::library("fsi-flap.toml"), {"fluid.end_s=0.02", "fluid.history_rows=10"});
  run.to_end();
  std::printf("tip %.4f mm downstream, pull on the foot %.4g N\n", run.metric("tip_x_mm"),
              run.metric("foot_N"));
  EXPECT_GT(run.metric("tip_x_mm"), 0.05);
  EXPECT_LT(run.metric("foot_N"), 0);
}

// A bar two cells thick, clamped to a wall in still fluid, under its own weight.
constexpr const char* hanging_bar = R"([fluid]
box_mm = [0, 0, 0, 18, 12, 3]
grid_mm = 1
density_g_per_mm3 = 1e-3
viscosity_Pa_s = 0.024
end_s = 1.2
history_rows = 12
[[boundary]]
name = "walls"
sides = ["x_low", "y"]
kind = "wall"
[[boundary]]
name = "plane flow"
sides = ["z"]
kind = "periodic"
[[boundary]]
name = "open"
sides = ["x_high"]
kind = "outflow"
[[body]]
name = "bar"
kind = "solid"
shape = "box"
origin_mm = [0, 5, 0]
size_mm = [12, 2, 3]
divisions = [6, 1, 1]
element = "hex27"
law = "linear"
young_kPa = 2.8
poisson = 0.4
formulation = "displacement"
density_g_per_mm3 = 1e-3
[[nodes]]
name = "foot"
body = "bar"
select = "group"
group = "start1"
[[support]]
name = "foot"
nodes = "foot"
hold = ["all"]
[[nodes]]
name = "all"
body = "bar"
select = "all"
[[support]]
name = "plane strain"
nodes = "all"
hold = ["z"]
[[load]]
name = "weight"
kind = "gravity"
body = "bar"
acceleration_mm_per_s2 = [0, -30, 0]
[[nodes]]
name = "tip"
body = "bar"
select = "nearest"
point_mm = [12, 6, 0]
[[probe]]
name = "tip_y"
of = "tip"
component = "y"
)";

// It has to rest where a beam does, with every element's volume as at the start
// (docs/verification/flow-bodies.md: without, it loses its stiffness). Plane strain of an incompressible
// solid: E* = 4 mu; w = q L^4/(8 E* I) + q L^2/(2 (5/6) mu t).
TEST(FlowBodies, ABarRestsWhereABeamDoes) {
  constexpr double length = 12, thickness = 2, mu = 1e3, density = 1e-3, gravity = 30;
  FlowRun run(hanging_bar, {});
  run.to_end();
  const double q = density * gravity * thickness,
               bending = q * std::pow(length, 4) / (8 * 4 * mu * std::pow(thickness, 3) / 12),
               shear = q * length * length / (2 * 5.0 / 6 * mu * thickness);
  std::printf("tip %.5f mm, beam %.5f mm, largest change of a volume %.2g\n", run.metric("tip_y_mm"),
              -(bending + shear), run.metric("coupling_largest_volume_change"));
  // The wall holds the fluid, and with it the bar, up to half a cell from it.
  const double ratio = run.metric("tip_y_mm") / -(bending + shear);
  EXPECT_GT(ratio, std::pow(1 - 0.5 / length, 4));
  EXPECT_LT(ratio, 1.02);
  EXPECT_LT(run.metric("coupling_largest_volume_change"), 1e-8);
}

// A slab of one cell instead of three is the same plane flow. (Not to more digits: over three cells the nodal
// forces of an element of 27 nodes are not even across the slab.)
TEST(FlowBodies, ABarInASlabOfOneCell) {
  const auto tip = [](int cells) {
    return FlowRun(hanging_bar, {fmt::format("fluid.box_mm=[0,0,0,18,12,{}]", cells),
                                 fmt::format("body.bar.size_mm=[12,2,{}]", cells), "fluid.end_s=0.3"})
        .to_end()
        .metric("tip_y_mm");
  };
  const double one = tip(1), three = tip(3);
  std::printf("tip %.6f and %.6f mm\n", one, three);
  EXPECT_LT(one, -0.03);
  EXPECT_NEAR(one / three, 1, 0.02);
}

// Turek and Hron's FSI1 with two cells across the bar: a coarse grid, whose errors
// docs/verification/flow-bodies.md has.
TEST(FlowBodies, TheBarBehindACylinderRestsNearWhereItShould) {
  // Turek and Hron 2006, table of FSI1.
  constexpr double across = 0.8209, drag = 14.295, lift = 0.7638;
  FlowRun run(FlowRun::library("fsi-turek-hron-fsi1.toml"),
              {"fluid.grid_mm=10", "fluid.box_mm=[0,0,0,1000,410,10]", "fluid.end_s=6",
               "fluid.average_from_s=5.5", "body.bar.divisions=[12,1,1]",
               "body.bar.size_mm=[351.01020514433643,20,10]", "flow_probe.force.reference_area_mm2=500"});
  run.to_end();
  std::printf("A at (%.4f, %.4f) mm, drag %.3f, lift %.4f N/m\n", run.metric("A_x_mm_mean"),
              run.metric("A_y_mm_mean"), run.metric("force_x_coefficient_mean"),
              run.metric("force_y_coefficient_mean"));
  EXPECT_NEAR(run.metric("A_y_mm_mean") / across, 1, 0.1);
  EXPECT_NEAR(run.metric("force_x_coefficient_mean") / drag, 1, 0.05);
  EXPECT_NEAR(run.metric("force_y_coefficient_mean") / lift, 1, 0.1);
}

TEST(FlowBodies, WhatIsWrongIsNamed) {
  const auto message = [](const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
      FlowRun run(text, overrides);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const auto expect = [](const std::string& found, std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(found.find(word), std::string::npos) << word << " in: " << found;
  };
  const std::string text = cantilever;
  expect(message(text, {"body.beam.density_g_per_mm3=5e-4"}), {"beam", "0.0005", "lighter", "excess_mass"});
  EXPECT_EQ(message(text, {"body.beam.density_g_per_mm3=5e-4", "coupling.excess_mass=false"}), "no error");
  expect(message(text, {"body.beam.origin_mm=[9,5,4]"}), {"beam node", "along x", "larger box"});
  expect(message(text, {"body.beam.velocity_mm_per_s=[1,0,0]"}), {"'beam'", "velocity_mm_per_s"});
  expect(message(text, {"fluid.time_scheme=rk3"}), {"rk3", "ab2"});
  expect(message(text + "[dynamics]\nsolver = \"static\"\n"), {"[dynamics]", "fluid.end_s"});
  expect(message(text + "[[body]]\nname = \"rock\"\nkind = \"rigid\"\nmotion = \"free\"\nshape = \"sphere\"\n"
                        "radius_mm = 1\ndivisions = [8, 4]\n"),
         {"'rock'", "free", "stiff solid"});
  expect(message(text + "[[flow_probe]]\nname = \"f\"\nquantity = \"force\"\nof = \"bem\"\n"), {"'bem'"});
  expect(message(text + "[[flow_probe]]\nname = \"tip_y\"\nquantity = \"velocity\"\n"
                        "[[probe]]\nname = \"v\"\nof = \"nowhere\"\n"),
         {"[[probe]] 'v'", "nowhere"});
  expect(message("[fluid]\nbox_mm = [0,0,0,9,9,9]\ngrid_mm = 1\n[[probe]]\nname = \"p\"\nof = \"q\"\n"),
         {"[[probe]]", "[[body]]", "[[flow_probe]]"});
  expect(message(text, {"body.beam.start_displacement=[\"0\",\"t\",\"0\"]"}), {"start_displacement", "t"});
}
