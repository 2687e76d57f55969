#include <cmath>

#include "run_case.hpp"

using namespace valsalva;
using test::CaseRun;

TEST(DryShell, CantileverFollowsTheElastica) {
  const auto table = test::reference("elastica_tip_load.csv");
  if (table.empty()) GTEST_SKIP() << "the reference table elastica_tip_load.csv is not there";
  CaseRun run("cantilever_shell.toml");
  int compared = 0;
  for (const auto& row : table) {
    const double load = std::stod(row[0]);
    if (load > 4 || std::abs(load / 0.2 - std::round(load / 0.2)) > 1e-9) continue;
    run.until(load);
    EXPECT_NEAR(run.probe("z_mm"), 10 * std::stod(row[1]), 0.02 * 10 * std::stod(row[1])) << load;
    EXPECT_NEAR(-run.probe("x_mm"), 10 * std::stod(row[2]), 0.02 * 10 * std::stod(row[1])) << load;
    ++compared;
  }
  EXPECT_GE(compared, 8);
}

// The end moment rolls the strip up: tip positions of the table (exact), the circle closed at half of the
// load.
TEST(DryShell, RollUpByAnEdgeMoment) {
  const auto table = test::reference("sze2004_cantilever.csv");
  if (table.empty()) GTEST_SKIP() << "the reference table sze2004_cantilever.csv is not there";
  CaseRun run("roll_up.toml");
  int compared = 0;
  double worst = 0;
  for (const auto& row : table) {
    if (!row[0].starts_with("cantilever_end_moment")) continue;
    run.until(std::stod(row[1]));
    worst = std::max({worst, std::abs(-run.probe("x_mm") - std::stod(row[3])),
                      std::abs(run.probe("z_mm") - std::stod(row[5]))});
    ++compared;
  }
  std::printf("roll-up: off by at most %.4f of 12 over %d loads\n", worst, compared);
  EXPECT_GE(compared, 20);
  EXPECT_LT(worst, 0.005 * 12);
}

TEST(DryShell, SphereUnderPressure) {
  const auto table = test::reference("sphere_inflation_neo_hookean.csv");
  if (table.empty()) GTEST_SKIP() << "the reference table sphere_inflation_neo_hookean.csv is not there";
  for (const auto& row : table) {
    const double stretch = std::stod(row[0]);
    if (stretch > 1.25) continue;
    // mu = 100 kPa
    CaseRun run("sphere_inflation.toml", {{"1.108503", std::to_string(100 * std::stod(row[3]))}});
    const double empty = run.probe("filled_mm3");
    run.to_end();
    // Near the limit point the stretch is sensitive: dl/l = 1.6 dp/p at 1.2.
    EXPECT_NEAR(std::cbrt(run.probe("filled_mm3") / empty), stretch, 0.02 * (stretch - 1));
  }
}

namespace {

struct Benchmark {
  const char *file, *probe, *mesh, *name;  // name: how the reference's row begins
  double factor;                           // of the case's load, with the sign of the probe
};

/// The first number of the row's value.
double published(const Benchmark& b) {
  for (const auto& row : test::reference("linear_shells_beams.csv"))
    if (row[0].starts_with(b.name)) return b.factor * std::stod(row[2]);
  return 0;
}

double ratio(const Benchmark& b, const std::string& divisions, const std::string& pattern) {
  CaseRun run(b.file, {{b.mesh, divisions}, {"\"alternating\"", "\"" + pattern + "\""}});
  run.to_end();
  return run.probe(b.probe) / published(b);
}

}  // namespace

// On coarse meshes of every pattern; crossed ones converge fastest. Finer ones: docs/verification/shells.md.
TEST(DryShell, BenchmarksOfLinearShells) {
  const Benchmark roof{"scordelis_lo.toml", "edge_mm", "[24, 24]", "Scordelis-Lo roof", -1e-3};
  const Benchmark pipe{"pinched_cylinder.toml", "loaded_mm", "[32, 32]", "pinched cylinder", -1};
  const Benchmark dome{"pinched_hemisphere.toml", "out_mm", "[32, 32]", "pinched hemisphere", 1e-3};
  const Benchmark twist{"twisted_beam.toml", "z_mm", "[48, 4]", "twisted beam", 1};
  if (published(roof) == 0) GTEST_SKIP() << "the reference table linear_shells_beams.csv is not there";
  for (const auto& b : {roof, pipe, dome, twist})
    for (const char* pattern : {"alternating", "right", "crossed"}) {
      const bool beam = b.file == twist.file;
      const double coarse = ratio(b, beam ? "[24, 2]" : "[12, 12]", pattern),
                   fine = ratio(b, beam ? "[48, 4]" : "[24, 24]", pattern);
      std::printf("%s %s: %.4f %.4f of the reference\n", b.file, pattern, coarse, fine);
      EXPECT_NEAR(fine, 1, std::string(pattern) == "crossed" ? 0.05 : 0.15) << b.file << " " << pattern;
    }
}
