// Stress of Kirchhoff shells as probes and as fields of the views, against closed forms.
#include "run_case.hpp"
#include "tables.hpp"

using namespace valsalva;
using test::CaseRun;

namespace {

std::string stress_probe(const std::string& name, const std::string& layer, const std::string& component,
                         const std::string& more) {
  return "[[probe]]\nname = \"" + name + "\"\nquantity = \"stress\"\nof = \"sheet\"\nlayer = \"" + layer +
         "\"\ncomponent = \"" + component + "\"\n" + more + "\n";
}

}  // namespace

// A quarter of a tube between planes of symmetry: hoop stress p R/t, along the axis nu p R/t.
TEST(DryShellStress, TubeUnderPressure) {
  const auto run = CaseRun::of_text(
      R"(
[[body]]
name = "sheet"
kind = "shell"
shape = "cylinder"
radius_mm = 10
angle_deg = [0, 90]
size_mm = [5]
divisions = [24, 8]
pattern = "alternating"
thickness_mm = 0.2
law = "linear"
young_kPa = 1000
poisson = 0.3
fibres = "cylindrical"
fibre_direction = [0, 0, 1]
fibre_angles_deg = [0]
[[load]]
name = "inside"
kind = "pressure"
body = "sheet"
pressure_kPa = 1e-3
)" + test::symmetry("sheet", "start1", "[0, 1, 0]") +
      test::symmetry("sheet", "end1", "[1, 0, 0]") + test::symmetry("sheet", "start2", "[0, 0, 1]") +
      test::symmetry("sheet", "end2", "[0, 0, 1]") + stress_probe("hoop", "middle", "principal_max", "") +
      stress_probe("fibre", "middle", "fibre", "point_mm = [7, 7, 2]") +
      stress_probe("across", "middle", "direction", "direction = [1, -1, 0]\npoint_mm = [7, 7, 2]") +
      stress_probe("axis", "middle", "zz", "point_mm = [7, 7, 2]") +
      stress_probe("bent", "bending", "fibre", "point_mm = [7, 7, 2]") +
      "[dynamics]\nsolver = \"static\"\nload_steps = 1\n");
  run->to_end();
  const double hoop = 1e-3 * 10 / 0.2;
  for (const char* probe : {"hoop_kPa", "fibre_kPa", "across_kPa"})
    EXPECT_NEAR(run->probe(probe), hoop, 0.01 * hoop) << probe;
  EXPECT_NEAR(run->probe("axis_kPa"), 0.3 * hoop, 0.01 * hoop);
  EXPECT_NEAR(run->probe("bent_kPa"), 0, 0.01 * hoop);
}

// A strip bent by an end moment m a width (1 uN): 6 m/t^2 below, the opposite above, and nothing in the
// middle, in a sheet that has turned.
TEST(DryShellStress, StripBentByAMoment) {
  const auto run = CaseRun::of_text(
      R"(
[[body]]
name = "sheet"
kind = "shell"
shape = "plate"
size_mm = [10, 2]
divisions = [30, 6]
pattern = "right"
thickness_mm = 0.1
law = "linear"
young_kPa = 1200
poisson = 0
)" + test::held("sheet", "start1", "[\"all\"]") +
      R"(
[[nodes]]
name = "end"
body = "sheet"
select = "group"
group = "end1"
[[load]]
name = "moment"
kind = "moment"
nodes = "end"
moment_N_mm = [0, -2e-6, 0]
)" + stress_probe("top", "top", "direction", "direction = [1, 0, 0]\npoint_mm = [8, 1, 0]") +
      stress_probe("bottom", "bottom", "direction", "direction = [1, 0, 0]\npoint_mm = [8, 1, 0]") +
      stress_probe("middle", "middle", "direction", "direction = [1, 0, 0]\npoint_mm = [8, 1, 0]") +
      stress_probe("bending", "bending", "direction", "direction = [1, 0, 0]\npoint_mm = [8, 1, 0]") +
      stress_probe("across", "bottom", "yy", "point_mm = [8, 1, 0]") +
      "[dynamics]\nsolver = \"static\"\nload_steps = 2\n");
  run->to_end();
  const double bent = 6 * 1 / 0.01 * 1e-3;  // kPa
  EXPECT_NEAR(run->probe("bottom_kPa"), bent, 0.01 * bent);
  EXPECT_NEAR(run->probe("top_kPa"), -bent, 0.01 * bent);
  EXPECT_NEAR(run->probe("bending_kPa"), -bent, 0.01 * bent);
  EXPECT_NEAR(run->probe("middle_kPa"), 0, 0.01 * bent);
  EXPECT_NEAR(run->probe("across_kPa"), 0, 0.02 * bent);

  const auto field = assembly::element_field(run->scene.bodies[0], run->scene.system->state);
  const std::size_t triangles = run->scene.bodies[0].mesh.triangles.size();
  for (const char* layer : {"bottom", "middle", "top"}) {
    EXPECT_EQ(field.layers.at(std::string("stress_") + layer + "_kPa").values.size(), 6 * triangles);
    for (const char* name : {"principal_max_", "principal_min_", "von_mises_"})
      EXPECT_EQ(field.layers.at(name + std::string(layer) + "_kPa").values.size(), triangles) << name;
  }
  // In the inner half, of one sign on each side.
  const auto& most = field.layers.at("principal_max_bottom_kPa").values;
  const auto& least = field.layers.at("principal_min_top_kPa").values;
  const auto& mises = field.layers.at("von_mises_top_kPa").values;
  int seen = 0;
  for (std::size_t e = 0; e < triangles; ++e) {
    const double x = run->scene.bodies[0].mesh.points[run->scene.bodies[0].mesh.triangles[e][0]].x();
    if (x < 3 || x > 7) continue;
    EXPECT_NEAR(most[e], bent, 0.03 * bent);
    EXPECT_NEAR(least[e], -bent, 0.03 * bent);
    EXPECT_NEAR(mises[e], bent, 0.03 * bent);
    ++seen;
  }
  EXPECT_GT(seen, 100);
}

TEST(DryShellStress, WrongLayersAreNamed) {
  const std::string solid = R"(
[[body]]
name = "sheet"
kind = "solid"
shape = "box"
size_mm = [1, 1, 1]
divisions = [1, 1, 1]
law = "linear"
young_kPa = 1
[dynamics]
solver = "static"
)";
  try {
    CaseRun::of_text(solid + stress_probe("top", "top", "xx", ""));
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("[[probe]] 'top'"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("layer"), std::string::npos) << error.what();
  }
}
