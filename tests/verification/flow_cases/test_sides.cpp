// Sides, their factors over time, what stands behind them, and what is refused.
#include <cmath>

#include "expect_error.hpp"
#include "run_case.hpp"

using namespace valsalva;
using test::FlowRun;

namespace {

// A square duct along x with slip sides: plug flow.
std::string duct(const std::string& low, const std::string& high, const std::string& more = "") {
  return R"toml(
[fluid]
box_mm = [0, 0, 0, 8, 4, 4]
grid_mm = 1
density_g_per_mm3 = 1e-3
viscosity_Pa_s = 0
end_s = 0.1
step_s = 1e-3
history_rows = 10
)toml" + more +
         R"toml(
[[boundary]]
name = "low"
sides = ["x_low"]
)toml" + low +
         R"toml(
[[boundary]]
name = "high"
sides = ["x_high"]
)toml" + high +
         R"toml(
[[flow_probe]]
name = "through"
quantity = "flow"
axis = "x"
at_mm = 3
[[flow_probe]]
name = "out"
quantity = "side_flow"
side = "x_high"
[[flow_probe]]
name = "p"
quantity = "section_pressure"
axis = "x"
at_mm = 4
)toml";
}

}  // namespace

TEST(FlowSides, APressureDifferenceAcceleratesThePlug) {
  FlowRun run(duct("kind = \"outflow\"\npressure_Pa = 100", "kind = \"outflow\""));
  run.to_end();
  // What enters takes its head from the reservoir: L dw/dt = dp/rho - w^2/2, w = w0 tanh(t/T).
  const double w0 = std::sqrt(2 * 100 / 1e-3), rise = 2 * 8 / w0;
  const double exact = w0 * std::tanh(0.1 / rise) * 16 / 1000;
  EXPECT_NEAR(run.metric("through_mL_per_s") / exact, 1, 1e-3);
  EXPECT_NEAR(run.metric("through_mL_per_s"), run.metric("out_mL_per_s"), 1e-9);
}

TEST(FlowSides, AFactorOverTimeScalesTheInflow) {
  for (const std::string factor :
       {"time_s = [0, 0.05, 0.1]\nfactor = [0, 1, 0.5]", "factor_of_t = \"t < 0.05 ? 20*t : 1.5 - 10*t\""}) {
    FlowRun run(
        duct("kind = \"inflow\"\nprofile = \"uniform\"\nflow_mL_per_s = 2\n" + factor, "kind = \"outflow\""));
    run.to_end();
    EXPECT_NEAR(run.metric("through_mL_per_s"), 1.0, 1e-9) << factor;
    EXPECT_NEAR(run.scene.history().at(5, "out_mL_per_s"), 2.0, 1e-9) << factor;
  }
}

TEST(FlowSides, APeriodicTableBeginsAnew) {
  FlowRun run(
      duct("kind = \"inflow\"\nprofile = \"uniform\"\nspeed_mm_per_s = 10\nperiod_s = 0.04\n"
           "time_s = [0, 0.01, 0.02, 0.03]\nfactor = [0, 1, 0, -1]",
           "kind = \"outflow\""));
  run.to_end();
  for (int row = 0; row <= 10; ++row) {
    const double t = 0.01 * row, triangle = 2 / M_PI * std::asin(std::sin(2 * M_PI * t / 0.04));
    EXPECT_NEAR(run.scene.history().at(row, "through_mL_per_s"), 0.16 * triangle, 1e-9) << t;
  }
}

TEST(FlowSides, AResistanceAnswersTheFlow) {
  FlowRun run(duct("kind = \"inflow\"\nprofile = \"uniform\"\nflow_mL_per_s = 3",
                   "kind = \"outflow\"\nresistance_Pa_s_per_mL = 40\npressure_Pa = 5"));
  run.to_end();
  EXPECT_NEAR(run.metric("p_Pa"), 5 + 40 * 3, 1e-6);
}

// Pressure drives the plug; the duct's inertance over the step is 0.5 Pa s/mL, and an answer to the flow of
// the step before would grow without bound beyond that.
TEST(FlowSides, AnOutletMayResistAsItLikes) {
  for (const std::string solver : {"direct", "krylov"}) {
    for (const double resistance : {2.0, 200.0, 1e4, 1e9}) {
      FlowRun run(duct("kind = \"outflow\"\npressure_Pa = 100",
                       fmt::format("kind = \"outflow\"\nresistance_Pa_s_per_mL = {}", resistance),
                       fmt::format("pressure_solver = \"{}\"\n", solver)));
      run.to_end();
      // What enters leaves its head in the reservoir.
      const double flow = run.metric("through_mL_per_s"), head = 0.5e-3 * std::pow(flow * 1000 / 16, 2);
      if (resistance < 100) {  // still on its way
        EXPECT_GT(flow, 6) << solver;
        continue;
      }
      EXPECT_NEAR(flow * resistance, 100 - head, 0.2) << resistance << ", " << solver;
      EXPECT_NEAR(run.metric("p_Pa"), 100 - head, 0.2) << resistance << ", " << solver;
    }
  }
}

TEST(FlowSides, AWindkesselCharges) {
  FlowRun run(duct("kind = \"inflow\"\nprofile = \"uniform\"\nflow_mL_per_s = 3",
                   "kind = \"outflow\"\nresistance_Pa_s_per_mL = 40\ncompliance_mL_per_Pa = 2e-3\n"
                   "characteristic_Pa_s_per_mL = 4"));
  run.to_end();
  // The answer is that of the step before.
  const double t = 0.099, exact = 12 + 120 * (1 - std::exp(-t / 0.08));
  EXPECT_NEAR(run.metric("p_Pa"), exact, 1e-6);
}

// The scene is turned inside so that open sides lie along z: results must not notice.
TEST(FlowSides, TheAxisOfTheFlowDoesNotMatter) {
  const auto scene = [](int axis) {
    const std::string names = "xyz";
    const char a = names[axis], b = names[(axis + 1) % 3], c = names[(axis + 2) % 3];
    std::array<double, 3> extent{}, centre{};
    extent[axis] = 8;
    extent[(axis + 1) % 3] = 5;
    extent[(axis + 2) % 3] = 4;
    centre[axis] = 3;
    centre[(axis + 1) % 3] = 2.2;
    centre[(axis + 2) % 3] = 2;
    return fmt::format(R"toml(
[fluid]
box_mm = [0, 0, 0, {}, {}, {}]
grid_mm = 0.5
viscosity_Pa_s = 5e-3
end_s = 0.05
step_s = 2.5e-3
history_rows = 1
[[boundary]]
name = "in"
sides = ["{}_low"]
kind = "inflow"
profile = "parabola"
speed_mm_per_s = 30
[[boundary]]
name = "out"
sides = ["{}_high"]
kind = "outflow"
[[boundary]]
name = "walls"
sides = ["{}", "{}"]
[[obstacle]]
name = "ball"
radius_mm = 1
centre_mm = [{}, {}, {}]
[[flow_probe]]
name = "ball"
quantity = "force"
of = "ball"
[[flow_probe]]
name = "moment"
quantity = "moment"
of = "ball"
[[flow_probe]]
name = "drop"
quantity = "pressure"
point_mm = [{}, {}, {}]
)toml",
                       extent[0], extent[1], extent[2], a, a, b, c, centre[0], centre[1], centre[2],
                       centre[0], centre[1], centre[2]);
  };
  const std::string names = "xyz";
  std::vector<double> first;
  for (int axis = 0; axis < 3; ++axis) {
    FlowRun run(scene(axis));
    run.to_end();
    std::vector<double> values;
    for (int e = 0; e < 3; ++e) {
      values.push_back(1e6 * run.metric(fmt::format("ball_{}_N", names[(axis + e) % 3])));
      values.push_back(1e6 * run.metric(fmt::format("moment_{}_N_mm", names[(axis + e) % 3])));
    }
    values.push_back(run.metric("drop_Pa"));
    if (axis == 0) {
      first = values;
      EXPECT_GT(values[0], 1.0);  // it is pushed along the stream
    }
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_NEAR(values[i], first[i], 1e-9 * (std::abs(first[i]) + first[0])) << axis << " " << i;
  }
}

TEST(FlowSides, MistakesAreNamed) {
  const auto refused = [](const std::string& text, std::initializer_list<const char*> words) {
    test::expect_error(ExitCode::input, words, [&] { FlowRun run(text); });
  };
  refused(duct("kind = \"inflow\"\nprofile = \"uniform\"", "kind = \"outflow\""), {"low", "speed_mm_per_s"});
  refused(duct("kind = \"inflow\"\nvelocity = [\"1\", \"0\", \"oops\"]", "kind = \"outflow\""),
          {"low", "velocity", "oops"});
  refused(duct("kind = \"inflow\"\nvelocity = [\"1\", \"0\", \"0\"]", "kind = \"wall\""), {"outflow"});
  refused(duct("kind = \"periodic\"", "kind = \"outflow\""), {"periodic"});
  refused(duct("kind = \"wall\"", "kind = \"wall\"", "cells = [8, 4, 4]"), {"grid_mm", "cells"});
  refused(duct("kind = \"wall\"", "kind = \"wall\"", "order = 4"), {"order 4", "periodic"});
  refused(duct("kind = \"wall\"", "kind = \"outflow\"", "pressure_solver = \"direct\"\n") +
              "[[boundary]]\nname = \"top\"\nsides = [\"y_high\"]\nkind = \"outflow\"\n",
          {"along x", "along y"});
  refused(duct("kind = \"wall\"", "kind = \"wall\"") +
              "[[flow_probe]]\nname = \"drag\"\nquantity = \"force\"\nof = \"ball\"\n",
          {"drag", "ball", "obstacle"});
  refused(duct("kind = \"wall\"", "kind = \"wall\"") +
              "[[obstacle]]\nname = \"hole\"\nshape = \"difference\"\nof = [\"ball\"]\n",
          {"hole", "ball"});
}

TEST(FlowSides, ALaterEndGoesOnFromAnEarlierOne) {
  const std::string text =
      duct("kind = \"inflow\"\nprofile = \"uniform\"\nflow_mL_per_s = 3\nfactor_of_t = \"sin(9*t)\"",
           "kind = \"outflow\"\nresistance_Pa_s_per_mL = 40");
  FlowRun whole(text), first(text, {"fluid.end_s=0.04", "fluid.history_rows=4"}), rest(text);
  first.to_end();
  state::State stored;
  stored.restart = first.scene.save();
  rest.scene.load(stored);
  whole.to_end();
  rest.to_end();
  const History &a = whole.scene.history(), &b = rest.scene.history();
  ASSERT_EQ(a.rows(), b.rows());
  for (std::size_t row = 0; row < a.rows(); ++row)
    for (const std::string& column : a.columns())
      EXPECT_NEAR(a.at(row, column), b.at(row, column), 1e-9 * std::abs(a.at(row, column))) << column;
}

TEST(FlowSides, AResumedRunIsTheSameBitForBit) {
  const std::string text =
      duct("kind = \"inflow\"\nprofile = \"uniform\"\nflow_mL_per_s = 3\nfactor_of_t = \"sin(9*t)\"",
           "kind = \"outflow\"\nresistance_Pa_s_per_mL = 40\ncompliance_mL_per_Pa = 2e-3") +
      R"toml(
[[obstacle]]
name = "ball"
radius_mm = 1
centre_mm = [3, 2, 2]
displacement = ["0.3*sin(50*t)", "0", "0"]
[[flow_probe]]
name = "axis"
quantity = "profile"
line_mm = [0, 1, 1, 8, 1, 1]
points = 9
)toml";
  FlowRun whole(text), before(text), after(text);
  for (int step = 0; step < 63; ++step) before.step();
  state::State stored;
  stored.restart = before.scene.save();
  after.scene.load(stored);
  whole.to_end();
  after.to_end();
  const auto a = whole.scene.save(), b = after.scene.save();
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, array] : a) EXPECT_EQ(array.data, b.at(name).data) << name;
  EXPECT_EQ(whole.scene.profiles(), after.scene.profiles());
}
