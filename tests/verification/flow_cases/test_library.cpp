// Cases of the library that have a study (pipelines/study_*.py), on grids small enough for every run.
#include <cmath>

#include "run_case.hpp"

using valsalva::test::FlowRun;

namespace {

// What comes in goes through the throat and out, with walls that the grid cuts in either way.
class Nozzle : public testing::TestWithParam<const char*> {};

TEST_P(Nozzle, KeepsItsFlow) {
  FlowRun run(FlowRun::library("fluid-fda-nozzle.toml"),
              {"fluid.grid_mm=0.8", "fluid.end_s=0.02", "fluid.history_rows=5",
               std::string("fluid.wall=") + GetParam()});
  run.to_end();
  const double out = run.metric("out_mL_per_s"), throat = run.metric("through_throat_mL_per_s");
  std::printf("%s: out %.9f mL/s, throat / out - 1 = %.1e\n", GetParam(), out, throat / out - 1);
  EXPECT_NEAR(out / 5.20624, 1, 1e-6);
  EXPECT_NEAR(throat / out, 1, 5e-3);  // faces held by penalisation let a little through
}

INSTANTIATE_TEST_SUITE_P(FlowLibrary, Nozzle, testing::Values("staircase", "interpolated"),
                         [](const auto& info) { return std::string(info.param); });

// Steps grow by 1.2 at most; meeting the rows may not keep them from it.
TEST(FlowLibrary, StepsGrowToTheRows) {
  FlowRun run(FlowRun::library("fluid-taylor-green-re1600.toml"),
              {"fluid.cells=[8, 8, 8]", "fluid.end_s=2", "fluid.history_rows=20"});
  run.to_end();
  EXPECT_NEAR(run.scene.step_s(), 0.1, 1e-12);
  EXPECT_LT(run.scene.steps(), 60);
}

}  // namespace
