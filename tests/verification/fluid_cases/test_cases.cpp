// Benchmark flows against published results, on grids small enough for every run.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <optional>
#include <string>

#include "cases.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

// The value of a row of flow_bluff_bodies.csv: case, quantity, value, source.
std::optional<double> figure(const std::string& of_case, const std::string& quantity) {
  std::ifstream in(std::string(VALSALVA_REFERENCE) + "/flow_bluff_bodies.csv");
  for (std::string line; std::getline(in, line);) {
    const auto field = line.find("," + quantity + ",");
    if (line.starts_with(of_case) && field != std::string::npos)
      return std::stod(line.substr(field + quantity.size() + 2));
  }
  return std::nullopt;
}

TEST(Cavity, ApproachesGhiaAtReynolds100) {
  const Cavity coarse = cavity(100, 16, 14, Convection::centred4),
               fine = cavity(100, 32, 14, Convection::centred4);
  std::printf("rms of u %.4f -> %.4f, of v %.4f -> %.4f\n", coarse.rms_u, fine.rms_u, coarse.rms_v,
              fine.rms_v);
  EXPECT_LT(fine.change, 1e-4);
  if (fine.rms_u < 0) GTEST_SKIP() << "no reference data";
  EXPECT_LT(fine.rms_u, 0.01);  // of the lid's speed
  EXPECT_LT(fine.rms_v, 0.01);
  EXPECT_LT(fine.rms_u, 0.6 * coarse.rms_u);
}

TEST(Cylinder, DragApproachesSchaeferAndTurek) {
  const auto published = figure("Schaefer-Turek 2D-1 (", "Cd");
  if (!published) GTEST_SKIP() << "no reference data";
  const double exact = *published;
  const Cylinder run = cylinder(48, 5, Wall::interpolated);
  std::printf("drag %.3f, published %.3f\n", run.drag, exact);
  EXPECT_LT(run.change, 2e-3);
  EXPECT_NEAR(run.drag / exact, 1, 0.05);
}

TEST(TaylorGreen, EarlyDissipationIsThatOfTheSpectralSolution) {
  FlowParameters scheme;
  scheme.order = 4;
  scheme.convection = Convection::conserving4;
  const Dissipation run = taylor_green(32, 3, scheme);
  std::printf("difference up to t = 3: %.3f of the mean\n", run.rms);
  if (run.rms < 0) GTEST_SKIP() << "no reference data";
  EXPECT_LT(run.rms, 0.1);
}

}  // namespace
