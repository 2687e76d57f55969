#include "run_case.hpp"

using namespace valsalva;
using test::CaseRun;

TEST(DryBeam, CantileverFollowsTheElastica) {
  const auto table = test::reference("elastica_tip_load.csv");
  if (table.empty()) GTEST_SKIP() << "the reference table elastica_tip_load.csv is not there";
  CaseRun run("cantilever_beam.toml");
  int compared = 0;
  for (const auto& row : table) {
    const double load = std::stod(row[0]);  // the run's time is P L^2 / (E I)
    if (load > 4 || std::abs(load / 0.2 - std::round(load / 0.2)) > 1e-9) continue;
    run.until(load);
    EXPECT_NEAR(run.probe("z_mm"), 10 * std::stod(row[1]), 0.002 * 10 * std::stod(row[1])) << load;
    EXPECT_NEAR(-run.probe("x_mm"), 10 * std::stod(row[2]), 0.004 * 10 * std::stod(row[1])) << load;
    EXPECT_NEAR(run.probe("clamp_N"), -load * 1e-6, 1e-11);
    ++compared;
  }
  EXPECT_GE(compared, 8);
}

TEST(DryBeam, DynamicRelaxationFindsTheSameEquilibrium) {
  CaseRun newton("cantilever_beam.toml", {{"load_steps = 20", "load_steps = 4"}});
  CaseRun relaxed(
      "cantilever_beam.toml",
      {{"load_steps = 20", "load_steps = 1"}, {"\"static\"", "\"quasi_static\""}, {"[40]", "[10]"}});
  CaseRun coarse("cantilever_beam.toml", {{"[40]", "[10]"}});
  relaxed.to_end();
  coarse.to_end();
  EXPECT_NEAR(relaxed.probe("z_mm"), coarse.probe("z_mm"), 2e-3 * coarse.probe("z_mm"));
  EXPECT_NEAR(relaxed.probe("x_mm"), coarse.probe("x_mm"), 2e-3 * coarse.probe("z_mm"));
}

TEST(DryBeam, StraightBeamWithoutLoadStaysWhereItIs) {
  for (const char* solver : {"static", "quasi_static", "explicit", "implicit"}) {
    CaseRun run(
        "cantilever_beam.toml",
        {{"[[load]]\nname = \"shear\"\nkind = \"force\"\nnodes = \"tip\"\nforce_N = [0, 0, 4e-6]\n", ""},
         {"\"static\"", std::string("\"") + solver + "\""},
         {"load_steps = 20", "load_steps = 2"},
         {"end_s = 4", "end_s = 1e-3"}});
    for (int step = 0; step < 50 && !run.march->finished(); ++step) run.march->step();
    EXPECT_EQ(run.probe("most_mm"), 0) << solver;
  }
}
