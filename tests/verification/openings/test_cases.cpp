// Openings from case files: a vessel that forks, sides of several axes, resuming, and mistakes.
#include <cstring>

#include "expect_error.hpp"
#include "run_case.hpp"

using namespace valsalva;
using test::FlowRun;

namespace {

// A tube that forks into two: the flow is given, two resistances take it.
const std::string branching = R"toml(
[fluid]
box_mm = [-12, -5, -12, 12, 5, 12]
grid_mm = 0.8
end_s = 0.3
step_s = 1e-3
history_rows = 3
pressure_tolerance = 1e-12

[[obstacle]]
name = "trunk"
shape = "cylinder"
radius_mm = 4
length_mm = 20
centre_mm = [0, 0, -10]
part = true
[[obstacle]]
name = "right"
shape = "cylinder"
radius_mm = 3
length_mm = 30
axis = [1, 0, 1]
centre_mm = [10, 0, 10]
part = true
[[obstacle]]
name = "left"
shape = "cylinder"
radius_mm = 3
length_mm = 30
axis = [-1, 0, 1]
centre_mm = [-10, 0, 10]
part = true
[[obstacle]]
name = "vessel"
shape = "union"
of = ["trunk", "right", "left"]
fluid = "inside"

[[opening]]
name = "inlet"
kind = "flow"
centre_mm = [0, 0, -8]
normal = [0, 0, -1]
radius_mm = 5
flow_mL_per_s = 1.5
profile = "parabola"
factor_of_t = "min(1, 20*t)"
[[opening]]
name = "right"
centre_mm = [6, 0, 6]
normal = [1, 0, 1]
radius_mm = 4
resistance_Pa_s_per_mL = 100
[[opening]]
name = "left"
centre_mm = [-6, 0, 6]
normal = [-1, 0, 1]
radius_mm = 4
resistance_Pa_s_per_mL = 200

[[flow_probe]]
name = "in"
quantity = "opening_flow"
of = "inlet"
[[flow_probe]]
name = "right"
quantity = "opening_flow"
of = "right"
[[flow_probe]]
name = "left"
quantity = "opening_flow"
of = "left"
[[flow_probe]]
name = "p_right"
quantity = "opening_pressure"
of = "right"
[[flow_probe]]
name = "iterations"
quantity = "pressure_iterations"
[[flow_probe]]
name = "div"
quantity = "divergence"
)toml";

}  // namespace

TEST(OpeningCases, AForkSharesTheFlowAsItsResistancesSay) {
  FlowRun run(branching);
  run.to_end();
  const double in = run.metric("in_mL_per_s"), right = run.metric("right_mL_per_s"),
               left = run.metric("left_mL_per_s");
  std::printf("right %.5f, left %.5f mL/s, balance %.2g, %.0f iterations, %.0f of %zu cells\n", right, left,
              in + right + left, run.metric("iterations"), run.scene.flow().pressure_unknowns(),
              run.scene.flow().grid().all_cells());
  EXPECT_NEAR(in, -1.5, 1e-12);
  EXPECT_NEAR(in + right + left, 0, 1e-9);
  EXPECT_NEAR(right / left, 2, 0.04);  // less than that of the resistances, by the vessel's own
  EXPECT_LT(right / left, 2);
  EXPECT_NEAR(run.metric("p_right_Pa"), 100 * right, 0.02);
}

namespace {

// The same vessel with resistances far beyond its inertance over a step (about 100 Pa s/mL).
std::string steep_branching() {
  std::string text = branching;
  for (const auto& [from, to] : {std::pair{"= 100\n", "= 1e5\n"}, std::pair{"= 200\n", "= 2e5\n"}})
    text.replace(text.find(from), std::strlen(from), to);
  return text;
}

}  // namespace

TEST(OpeningCases, AForkSharesTheFlowAsLargeResistancesSay) {
  FlowRun run(steep_branching());
  run.to_end();
  const double right = run.metric("right_mL_per_s"), left = run.metric("left_mL_per_s");
  EXPECT_NEAR(right + left, 1.5, 1e-9);
  EXPECT_NEAR(right / left, 2, 2e-4);
  EXPECT_NEAR(run.metric("p_right_Pa"), 1e5 * right, 1);
}

class ResumedOpenings : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Answers, ResumedOpenings, testing::Bool(),
                         [](const auto& steep) { return steep.param ? "Steep" : "Gentle"; });

TEST_P(ResumedOpenings, GoOnBitForBit) {
  const std::string text = GetParam() ? steep_branching() : branching;
  FlowRun whole(text), before(text), after(text);
  for (int step = 0; step < 130; ++step) before.step();
  state::State stored;
  stored.restart = before.scene.save();
  after.scene.load(stored);
  for (int step = 0; step < 160; ++step) whole.step();
  for (int step = 130; step < 160; ++step) after.step();
  const auto a = whole.scene.save(), b = after.scene.save();
  for (const auto& [name, array] : a) EXPECT_EQ(array.doubles(name), b.at(name).doubles(name)) << name;
}

namespace {

// A bend in a box: in through x_low, out through sides of two axes.
std::string bend(const std::string& more = "") {
  return R"toml(
[fluid]
box_mm = [0, 0, 0, 6, 6, 3]
grid_mm = 0.5
viscosity_Pa_s = 1e-2
end_s = 0.05
step_s = 1e-3
history_rows = 5
)toml" + more +
         R"toml(
[[boundary]]
name = "in"
sides = ["x_low"]
kind = "inflow"
profile = "uniform"
flow_mL_per_s = 0.4
[[boundary]]
name = "on"
sides = ["x_high"]
kind = "outflow"
[[boundary]]
name = "up"
sides = ["y_high"]
kind = "outflow"
pressure_Pa = 0.02
[[flow_probe]]
name = "in"
quantity = "side_flow"
side = "x_low"
[[flow_probe]]
name = "on"
quantity = "side_flow"
side = "x_high"
[[flow_probe]]
name = "up"
quantity = "side_flow"
side = "y_high"
)toml";
}

}  // namespace

TEST(OpeningCases, OutflowSidesLieAlongSeveralAxes) {
  FlowRun run(bend("pressure_tolerance = 1e-12"));
  run.to_end();
  EXPECT_NEAR(run.metric("in_mL_per_s") + run.metric("on_mL_per_s") + run.metric("up_mL_per_s"), 0, 1e-9);
  EXPECT_GT(run.metric("on_mL_per_s"), 0.15);
  // Turned about the diagonal, the two outflows change places: one is a side of the solver's box, the other
  // an opening. They differ on the edge where they meet.
  std::string turned = bend("pressure_tolerance = 1e-12");
  for (auto& [from, to] : {std::pair{"x_low", "Y_low"}, {"x_high", "Y_high"}, {"y_high", "X_high"}}) {
    for (auto at = turned.find(from); at != std::string::npos; at = turned.find(from))
      turned.replace(at, std::strlen(from), to);
  }
  for (auto& [from, to] : {std::pair{"Y_", "y_"}, {"X_", "x_"}}) {
    for (auto at = turned.find(from); at != std::string::npos; at = turned.find(from))
      turned.replace(at, 2, to);
  }
  FlowRun other(turned);
  other.to_end();
  EXPECT_NEAR(other.metric("in_mL_per_s"), -0.4, 1e-12);
  EXPECT_NEAR(other.metric("on_mL_per_s"), run.metric("on_mL_per_s"), 4e-4);
  EXPECT_NEAR(other.metric("up_mL_per_s"), run.metric("up_mL_per_s"), 4e-4);
}

TEST(OpeningCases, MistakesAreNamed) {
  const auto refused = [](const std::string& text, std::initializer_list<const char*> words) {
    test::expect_error(ExitCode::input, words, [&] { FlowRun run(text); });
  };
  const auto with = [](std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  };
  refused(bend("pressure_solver = \"direct\""), {"along x", "along y", "direct"});
  refused(with(branching, "pressure_tolerance = 1e-12", "pressure_solver = \"direct\""),
          {"[[opening]]", "direct"});
  refused(with(branching, "radius_mm = 5\n", "radius_mm = 2\n"), {"inlet", "radius"});
  refused(with(branching, "centre_mm = [0, 0, -8]", "centre_mm = [9, 0, -8]"), {"inlet", "no fluid"});
  refused(with(branching, "flow_mL_per_s = 1.5", "pressure_Pa = 1.5"), {"inlet", "pressure_Pa", "kind"});
  refused(with(branching, "of = \"inlet\"", "of = \"outlet\""), {"outlet", "[[opening]]"});
  refused(with(branching, "pressure_tolerance = 1e-12", "viscosity_scheme = \"implicit\""),
          {"explicit", "krylov"});
}
