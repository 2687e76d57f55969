#include <cmath>

#include "run_case.hpp"

using namespace valsalva;
using test::CaseRun;

TEST(DrySolid, HertzUnderARigidSphere) {
  CaseRun run("hertz.toml");
  run.to_end();
  const double modulus = 1e3 / (1 - 0.09), d = 0.25;  // Pa, mm
  const double expected =
      4.0 / 3.0 * modulus * std::sqrt(10.0) * std::pow(d, 1.5) * 1e-6 / 4;  // N, a quarter
  std::printf("Hertz: %.4f of the half-space\n", -run.probe("push_N") / expected);
  EXPECT_NEAR(-run.probe("push_N"), expected, 0.08 * expected);
}

// The published tip on the same meshes to its last digit, and the converged one within 0.5 %.
TEST(DrySolid, CooksMembrane) {
  const auto table = test::reference("cook_miehe_neo_hookean.csv");
  if (table.empty()) GTEST_SKIP() << "the reference table cook_miehe_neo_hookean.csv is not there";
  const auto published = [&](const std::string& edge) {
    for (const auto& row : table)
      if (row[0] == edge) return std::stod(row[2]);
    throw std::runtime_error("no row " + edge);
  };
  const auto tip = [](const std::string& edge) {
    CaseRun run("cook.toml", {{"[4, 4, 1]", "[" + edge + ", " + edge + ", 1]"}});
    run.to_end();
    return run.probe("tip_mm");
  };
  const double coarse = tip("4"), fine = tip("8");
  std::printf("Cook: %.3f with 4, %.3f mm with 8 an edge\n", coarse, fine);
  EXPECT_NEAR(coarse, published("4"), 0.011);
  EXPECT_NEAR(fine, published("8"), 0.011);
  EXPECT_NEAR(fine, published("64"), 0.005 * published("64"));
}

TEST(DrySolid, TwistedBeam) {
  double published = 0;
  for (const auto& row : test::reference("linear_shells_beams.csv"))
    if (row[0].starts_with("twisted beam")) published = std::stod(row[2]);
  if (published == 0) GTEST_SKIP() << "the reference table linear_shells_beams.csv is not there";
  CaseRun run("twisted_solid.toml");
  run.to_end();
  std::printf("twisted beam of solids: %.4f of the reference\n", run.probe("z_mm") / published);
  EXPECT_NEAR(run.probe("z_mm"), published, 0.01 * published);
}
