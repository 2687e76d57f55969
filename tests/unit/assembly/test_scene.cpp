#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "assembly/march.hpp"
#include "assembly/probes.hpp"
#include "assembly/shell_edge.hpp"
#include "core/errors.hpp"
#include "scene/scene.hpp"

using namespace valsalva;
using namespace valsalva::assembly;

namespace {

Case read(const std::string& text) {
  Schema schema;
  declare_all(schema);
  return Case::from_text(text, "scene.toml", schema, Fidelity::standard);
}

const std::string plate = R"(
[[body]]
name = "sheet"
shape = "plate"
size_mm = [2, 1]
divisions = [4, 2]
thickness_mm = 0.2
law = "linear"
young_kPa = 100
poisson = 0.3
[[nodes]]
name = "root"
body = "sheet"
select = "group"
group = "start1"
[[nodes]]
name = "tip"
body = "sheet"
select = "group"
group = "end1"
[[nodes]]
name = "all"
body = "sheet"
)";

const std::string loaded = plate + R"(
[[support]]
name = "clamp"
nodes = "root"
hold = ["all"]
[[load]]
name = "push"
nodes = "tip"
force_N = [0, 0, 2e-5]
[[contact_pair]]
name = "floor"
body = "sheet"
surface = "plane"
point_mm = [0, 0, -0.11]
friction = 0.2
stiffness_kPa_per_mm = 10
[[probe]]
name = "tip"
of = "tip"
component = "z"
[[probe]]
name = "clamp"
quantity = "reaction"
of = "clamp"
component = "z"
)";

/// The same with a sheet of hinges.
std::string hinged(std::string text) {
  text.insert(text.find("shape = "), "shell_element = \"hinge\"\n");
  return text;
}

void expect_refused(const std::string& text, const std::vector<std::string>& words) {
  try {
    const Case scene = read(text);
    Scene built = compose(scene);
    const Probes probes(scene, built);
    make_march(scene, built);
    FAIL() << "accepted: " << text;
  } catch (const InputError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << word << " is not in: " << error.what();
  }
}

Points shaken(Points x, double size) {
  for (std::size_t a = 0; a < x.size(); ++a)
    x[a] += size * Vec3(std::sin(3.1 * a + 1), std::sin(5.3 * a + 2), std::sin(7.7 * a + 3));
  return x;
}

/// -grad of the energy against the forces, by central differences: the error at two steps.
std::array<double, 2> gradient_errors(const structure::ForceTerm& term, structure::Configuration at) {
  structure::Forces f;
  f.reset(at.x.size(), at.rotation.size());
  term.add_forces(at, f);
  const Points direction = shaken(Points(at.x.size(), Vec3::Zero()), 1);
  double exact = 0;
  for (std::size_t a = 0; a < at.x.size(); ++a) exact -= f.force[a].dot(direction[a]);
  std::array<double, 2> error;
  for (int k = 0; k < 2; ++k) {
    const double h = k == 0 ? 1e-3 : 5e-4;
    double energy[2];
    for (int sign : {0, 1}) {
      structure::Configuration moved = at;
      for (std::size_t a = 0; a < at.x.size(); ++a) moved.x[a] += (sign ? h : -h) * direction[a];
      structure::Forces unused;
      unused.reset(at.x.size(), at.rotation.size());
      energy[sign] = term.add_forces(moved, unused);
    }
    error[k] = std::abs((energy[1] - energy[0]) / (2 * h) - exact);
  }
  return error;
}

/// The tangent against the differences of the forces.
void expect_tangent(const structure::ForceTerm& term, const structure::Configuration& now) {
  structure::BlockMatrix k(now.x.size(), 0);
  term.add_tangent(now, k);
  const Points direction = shaken(Points(now.x.size(), Vec3::Zero()), 1);
  Eigen::VectorXd u(3 * now.x.size());
  for (std::size_t a = 0; a < now.x.size(); ++a) u.segment<3>(3 * a) = direction[a];
  const Eigen::VectorXd by_matrix = k.times(u);
  structure::Forces plus, minus;
  plus.reset(now.x.size(), 0);
  minus.reset(now.x.size(), 0);
  structure::Configuration moved = now;
  for (std::size_t a = 0; a < now.x.size(); ++a) moved.x[a] = now.x[a] + 1e-6 * direction[a];
  term.add_forces(moved, plus);
  for (std::size_t a = 0; a < now.x.size(); ++a) moved.x[a] = now.x[a] - 1e-6 * direction[a];
  term.add_forces(moved, minus);
  for (std::size_t a = 0; a < now.x.size(); ++a)
    EXPECT_LT((by_matrix.segment<3>(3 * a) + (plus.force[a] - minus.force[a]) / 2e-6).norm(),
              1e-5 * by_matrix.norm());
}

}  // namespace

TEST(Scene, ComposesBodiesSetsAndSupports) {
  const Scene s = compose(read(loaded));
  ASSERT_EQ(s.bodies.size(), 1u);
  EXPECT_EQ(s.nodes.at("root").size(), 3u);
  EXPECT_EQ(s.nodes.at("all").size(), 15u);
  EXPECT_EQ(s.system->held_directions(s.nodes.at("root")[0]), Mat3::Identity());
  double area = 0;
  for (double a : s.bodies[0].surface_area()) area += a;
  EXPECT_NEAR(area, 2, 1e-12);
}

TEST(Scene, SolidsNeedResistanceToChangeOfVolume) {
  const std::string block = R"(
[[body]]
name = "block"
kind = "solid"
shape = "box"
size_mm = [1, 1, 1]
divisions = [1, 1, 1]
law = "neo-hookean"
law_parameters = ["mu_Pa = 1e3"]
)";
  expect_refused(block, {"[[body]] 'block'", "'neo-hookean'", "volumetric", "bulk_modulus_kPa", "split"});
  EXPECT_NO_THROW(compose(read(block + "split = \"full\"\n")));
  EXPECT_NO_THROW(compose(read(block + "volumetric = \"quadratic\"\nbulk_modulus_kPa = 10\n")));
  EXPECT_NO_THROW(compose(read(block + "[fluid]\n")));
}

// W of the fibres is k1/(2 k2) (exp(k2 (I4 - 1)^2) - 1), once for each family.
TEST(Scene, OneFamilyOfFibresCountsOnce) {
  const auto energy = [](const std::string& angles) {
    const Scene s = compose(read(R"(
[[body]]
name = "sheet"
shape = "plate"
size_mm = [2, 1]
divisions = [4, 2]
thickness_mm = 0.2
law = "hgo"
law_parameters = ["c10_Pa = 1e-6", "c01 = 1", "k1_Pa = 1e4", "k2 = 5"]
fibres = "constant"
fibre_direction = [1, 0, 0]
fibre_angles_deg = )" + angles));
    structure::Configuration at = s.system->state;
    for (Vec3& x : at.x) x.x() *= 1.1;
    structure::Forces f;
    f.reset(at.x.size(), at.rotation.size());
    double sum = 0;
    for (const auto& term : s.terms) sum += term->add_forces(at, f);
    return sum;
  };
  const double e = 1.1 * 1.1 - 1, expected = 2 * 1 * 0.2 * 1e4 / 10 * (std::exp(5 * e * e) - 1);
  EXPECT_NEAR(energy("[0]"), expected, 1e-6 * expected);
  EXPECT_NEAR(energy("[0, 0]"), 2 * expected, 1e-6 * expected);
}

TEST(Scene, RefusesWhatIsWrongAndSaysWhere) {
  expect_refused("[dynamics]\n", {"no [[body]]"});
  expect_refused(plate + "[[body]]\nname = \"sheet\"\nshape = \"plate\"\n", {"size_mm", "2"});
  expect_refused(plate + "[[support]]\nname = \"s\"\nnodes = \"rot\"\nhold = [\"x\"]\n",
                 {"[[support]] 's'", "rot", "root"});
  expect_refused(plate + "[[support]]\nname = \"s\"\nnodes = \"root\"\nhold = [\"w\"]\n",
                 {"'w'", "symmetry"});
  expect_refused(
      plate + "[[support]]\nname = \"s\"\nnodes = \"root\"\nhold = [\"x\"]\ndisplacement_mm = [0, 1, 0]\n",
      {"displacement_mm", "y"});
  expect_refused(
      plate + "[[nodes]]\nname = \"n\"\nbody = \"sheet\"\nselect = \"plane\"\npoint_mm = [0, 0, 9]\n",
      {"no node", "tolerance_mm"});
  expect_refused(plate + "[[nodes]]\nname = \"n\"\nbody = \"sheet\"\nselect = \"group\"\ngroup = \"x\"\n",
                 {"start1"});
  expect_refused(
      plate + "[[load]]\nname = \"l\"\nkind = \"moment\"\nnodes = \"tip\"\nmoment_N_mm = [1, 0, 0]\n",
      {"along them"});
  expect_refused(
      "[[body]]\nname = \"b\"\nkind = \"solid\"\nshape = \"box\"\nsize_mm = [1, 1, 1]\ndivisions = "
      "[1, 1, 1]\nlaw = \"linear\"\nyoung_kPa = 1\n[[nodes]]\nname = \"n\"\nbody = "
      "\"b\"\n[[load]]\nname = \"l\"\nkind = \"moment\"\nnodes = \"n\"\nmoment_N_mm = [1, 0, 0]\n",
      {"no rotation"});
  expect_refused(
      plate + "[[load]]\nname = \"l\"\nnodes = \"tip\"\nforce_N = [1, 0, 0]\ntime_s = [0, 1]\nfactor = [1]\n",
      {"time_s", "factor"});
  expect_refused(
      plate +
          "[[load]]\nname = \"l\"\nnodes = \"tip\"\nforce_N = [1, 0, 0]\ntime_s = [1, 0]\nfactor = [1, 2]\n",
      {"ascend"});
  expect_refused(plate + "[[contact_pair]]\nname = \"c\"\nbody = \"sheet\"\n", {"other and surface"});
  expect_refused(plate + "[[contact_pair]]\nname = \"c\"\nbody = \"sheet\"\nsurface = \"sphere\"\n",
                 {"radius_mm"});
  expect_refused(plate + "[[probe]]\nname = \"p\"\nquantity = \"reaction\"\nof = \"clamp\"\n",
                 {"[[support]]"});
  expect_refused(
      plate +
          "[[load]]\nname = \"l\"\nkind = \"gravity\"\nacceleration_mm_per_s2 = [0, 0, 1]\nbody = \"x\"\n",
      {"'x'"});
  expect_refused(
      "[[body]]\nname = \"b\"\nshape = \"plate\"\nsize_mm = [1, 1]\ndivisions = [1, 1]\nthickness_mm = 1\n",
      {"material and law"});
  expect_refused(
      "[[body]]\nname = \"b\"\nshape = \"plate\"\nsize_mm = [1, 1]\ndivisions = [1, 1]\nthickness_mm = "
      "1\nlaw = "
      "\"neo-hookean\"\nlaw_parameters = [\"mu_Pa 5\"]\n",
      {"mu_Pa 5", "key = number"});
  expect_refused("[[body]]\nname = \"b\"\nfile = \"absent.msh\"\n", {"absent.msh"});
}

TEST(Scene, ForcesOfContactTethersAndClampsAreGradients) {
  Scene s = compose(read(hinged(plate) + R"(
[[support]]
name = "tethers"
nodes = "tip"
hold = ["x", "z"]
stiffness_N_per_mm = 1e-3
displacement_mm = [0.1, 0, 0.2]
[[support]]
name = "clamp"
nodes = "root"
hold = ["all"]
[[contact_pair]]
name = "ball"
body = "sheet"
surface = "sphere"
point_mm = [1, 0.5, -1]
radius_mm = 1.2
)"));
  structure::Configuration now = s.system->state;
  now.x = shaken(now.x, 0.05);
  now.time_s = 0.7;
  int checked = 0;
  for (const auto& term : s.terms) {
    if (term->name() == "sheet") continue;
    const auto error = gradient_errors(*term, now);
    EXPECT_LT(error[1], 0.3 * error[0] + 1e-9) << term->name();
    ++checked;
  }
  EXPECT_EQ(checked, 3);
}

TEST(Scene, ClampTermIsTheTangentOfItsForces) {
  Scene s = compose(read(hinged(loaded)));
  structure::Configuration now = s.system->state;
  now.x = shaken(now.x, 0.05);
  for (const auto& term : s.terms) {
    if (!term->name().starts_with("edge of")) continue;
    expect_tangent(*term, now);
  }
}

// Without friction, of bodies inside and outside of round surfaces, and on a plane.
TEST(Scene, TangentOfContactWithRigidSurfaces) {
  for (const char* surface :
       {"surface = \"cylinder\"\ninside = true\ndirection = [1, 0, 0]\npoint_mm = [0, 0.4, 0]\nradius_mm = "
        "0.6\n",
        "surface = \"cylinder\"\ndirection = [0, 1, 0]\npoint_mm = [1, 0, -2]\nradius_mm = 2\n",
        "surface = \"sphere\"\npoint_mm = [1, 0.4, -1]\nradius_mm = 1.2\n",
        "surface = \"sphere\"\ninside = true\npoint_mm = [1, 0.4, 0]\nradius_mm = 0.8\n",
        "surface = \"plane\"\ndirection = [0.2, 0.1, 1]\n"}) {
    const Scene s = compose(read(plate + "[[contact_pair]]\nname = \"tool\"\nbody = \"sheet\"\n" + surface));
    structure::Configuration now = s.system->state;
    now.x = shaken(now.x, 0.03);
    EXPECT_GT(s.surfaces.at("tool")->penetration_mm(now), 0.01) << surface;
    expect_tangent(*s.surfaces.at("tool"), now);
  }
}

TEST(Scene, PrescribedMotionArrives) {
  for (const char* solver : {"explicit", "quasi_static", "static"}) {
    const Case scene = read(plate + R"(
[[support]]
name = "root"
nodes = "root"
hold = ["all"]
[[support]]
name = "tip"
nodes = "tip"
hold = ["x", "y", "z"]
displacement_mm = [0.2, 0, 0]
[[probe]]
name = "tip"
of = "tip"
component = "x"
[[probe]]
name = "root"
quantity = "reaction"
of = "root"
component = "x"
[[probe]]
name = "pull"
quantity = "reaction"
of = "tip"
component = "x"
[dynamics]
end_s = 0.02
damping_per_s = 3000
load_steps = 3
solver = ")" + std::string(solver) +
                            "\"\n");
    Scene built = compose(scene);
    const Probes probes(scene, built);
    const auto march = make_march(scene, built);
    while (!march->finished()) march->step();
    const auto v = probes.values(built, march->kinetic_nJ());
    EXPECT_NEAR(v[0], 0.2, 1e-9) << solver;
    const bool dynamic = std::string(solver) == "explicit";
    EXPECT_NEAR(v[1], -v[2], (dynamic ? 0.1 : 1e-3) * v[2]) << solver;
    // E t b strain: held across the width at both ends, so a little stiffer than a bar.
    EXPECT_NEAR(v[2], 1e5 * 0.2 * 1 * 0.1 * 1e-6, 0.3 * 2e-3) << solver;
  }
}

TEST(Scene, EverySolverContinuesBitForBit) {
  for (const char* solver : {"explicit", "quasi_static", "static", "implicit"}) {
    const Case scene =
        read(loaded + "[dynamics]\nend_s = 0.01\nload_steps = 4\nsolver = \"" + solver + "\"\n");
    Scene whole = compose(scene), first = compose(scene), second = compose(scene);
    const auto a = make_march(scene, whole), b = make_march(scene, first);
    const int steps = std::string(solver) == "static" ? 4 : 400;
    for (int i = 0; i < steps; ++i) a->step();
    for (int i = 0; i < steps / 2; ++i) b->step();
    const auto c = make_march(scene, second);
    c->restore(b->save());
    for (int i = steps / 2; i < steps; ++i) c->step();
    EXPECT_EQ(a->steps(), c->steps());
    EXPECT_EQ(whole.system->state.x, second.system->state.x) << solver;
    EXPECT_EQ(a->save(), c->save()) << solver;
  }
}

TEST(TimeTable, IsLinearBetweenAndConstantOutside) {
  const TimeTable t({1, 2, 4}, {0, 10, 0}, "test");
  EXPECT_EQ(t(0), 0);
  EXPECT_EQ(t(1.5), 5);
  EXPECT_EQ(t(2), 10);
  EXPECT_EQ(t(3), 5);
  EXPECT_EQ(t(9), 0);
  EXPECT_THROW(TimeTable({1, 1}, {0, 1}, "test"), InputError);
}

TEST(Scene, RadiiChangeOfRoundSurfacesOnly) {
  const std::string pair = plate + "[[contact_pair]]\nname = \"tool\"\nbody = \"sheet\"\n";
  expect_refused(pair + "surface = \"plane\"\nradius_change_mm = 1\n",
                 {"'tool'", "radius_change_mm", "cylinder"});
  expect_refused(pair + "surface = \"sphere\"\nradius_mm = 1\nradius_change_mm = -1\n", {"radius_change_mm"});
  expect_refused(
      plate +
          "[[probe]]\nname = \"p\"\nquantity = \"reaction_moment\"\nof = \"tip\"\ncomponent = \"radial\"\n",
      {"radial", "displacement"});
}

// Of a ring: the depth points outwards, the width along its axis.
TEST(Scene, DepthOfBeamsFromAnAxis) {
  const std::string ring = R"(
[[body]]
name = "ring"
kind = "beams"
shape = "arc"
origin_mm = [3, 0, 1]
radius_mm = 2
divisions = [12]
width_mm = 0.2
depth_mm = 0.1
young_kPa = 1
depth = "radial"
)";
  const Scene s = compose(read(ring + "depth_point_mm = [3, 0, 0]\n"));
  const auto& mesh = s.bodies[0].beams->mesh();
  for (int e = 0; e < s.bodies[0].beams->elements(); ++e) {
    const auto& ends = mesh.elements[e];
    const Vec3 out = 0.5 * (mesh.reference[ends[0]] + mesh.reference[ends[1]]) - Vec3(3, 0, 1);
    EXPECT_LT((mesh.depth_axis[e] - out.normalized()).norm(), 1e-12) << e;
  }
  expect_refused(ring + "depth_direction = [0, 0, 0]\n", {"'ring'", "depth_direction"});
}
