// Small strains against closed forms of plates and tubes.
#include "run_case.hpp"
#include "tables.hpp"

using namespace valsalva;
using test::CaseRun;

// Round and clamped: w = q a^4/(64 D).
TEST(DryClosedForms, ClampedRoundPlateUnderPressure) {
  const auto run = CaseRun::of_text(R"(
[[body]]
name = "plate"
kind = "shell"
shape = "disc"
radius_mm = 10
divisions = [24, 24]
thickness_mm = 0.1
law = "linear"
young_kPa = 1000
poisson = 0.3
[[nodes]]
name = "rim"
body = "plate"
select = "border"
[[nodes]]
name = "middle"
body = "plate"
select = "nearest"
[[support]]
name = "rim"
nodes = "rim"
hold = ["all"]
[[load]]
name = "push"
kind = "pressure"
body = "plate"
pressure_kPa = 1e-8
[[probe]]
name = "middle"
of = "middle"
component = "z"
[dynamics]
solver = "static"
load_steps = 1
)");
  run->to_end();
  const double flexural = 1e6 * 1e-3 / (12 * (1 - 0.09)), exact = 1e-5 * 1e4 / (64 * flexural);
  EXPECT_NEAR(run->probe("middle_mm"), exact, 0.01 * exact);
}

// Plane strain: u(a) = (1 + nu)/E p a^2/(b^2 - a^2) [(1 - 2 nu) a + b^2/a], hoop stress p (a^2 + b^2)/(b^2 -
// a^2).
TEST(DryClosedForms, ThickTubeUnderPressure) {
  const auto run = CaseRun::of_text(
      R"(
[[body]]
name = "tube"
kind = "solid"
shape = "cylinder"
radius_mm = 10
wall_mm = 10
angle_deg = [0, 90]
size_mm = [2]
divisions = [8, 1, 6]
element = "hex27"
law = "neo-hookean"
law_parameters = ["mu_Pa = 1e5"]
volumetric = "quadratic"
bulk_modulus_kPa = 1000
)" + test::symmetry("tube", "start1", "[0, 1, 0]") +
      test::symmetry("tube", "end1", "[1, 0, 0]") + test::symmetry("tube", "start2", "[0, 0, 1]") +
      test::symmetry("tube", "end2", "[0, 0, 1]") + test::group("tube", "start3") + R"(
[[load]]
name = "inside"
kind = "pressure"
body = "tube"
nodes = "start3"
pressure_kPa = 1e-3
[[nodes]]
name = "lumen"
body = "tube"
select = "nearest"
point_mm = [10, 0, 0]
[[probe]]
name = "widening"
of = "lumen"
component = "x"
[[probe]]
name = "hoop"
quantity = "stress"
of = "tube"
component = "principal_max"
[dynamics]
solver = "static"
load_steps = 1
)");
  run->to_end();
  const double mu = 1e5, bulk = 1e6, young = 9 * bulk * mu / (3 * bulk + mu);
  const double nu = (3 * bulk - 2 * mu) / (2 * (3 * bulk + mu)), p = 1, a = 10, b = 20;
  const double exact = (1 + nu) / young * p * a * a / (b * b - a * a) * ((1 - 2 * nu) * a + b * b / a);
  EXPECT_NEAR(run->probe("widening_mm"), exact, 1e-3 * exact);
  // At the quadrature points nearest to the inside.
  const double r = a + 0.5 * (1 - std::sqrt(0.6)) * 10 / 6;
  const double hoop = 1e-3 * p * a * a / (b * b - a * a) * (1 + b * b / (r * r));
  EXPECT_NEAR(run->probe("hoop_kPa"), hoop, 0.01 * hoop);
}
