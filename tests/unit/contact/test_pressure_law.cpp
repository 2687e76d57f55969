#include <gtest/gtest.h>

#include <cmath>

#include "contact/pressure_law.hpp"

namespace valsalva::contact {
namespace {

constexpr double K = 2e5, h = 0.1;

class PressureLaw : public testing::TestWithParam<Law> {};

TEST_P(PressureLaw, PressureAndStiffnessAreDerivativesToSecondOrder) {
  for (double s : {0.2, 0.35, 0.5, 0.7, 0.9}) {
    const Pressure p = normal_pressure(GetParam(), K, s * h, h);
    double pressure_error[2], stiffness_error[2];
    for (int level = 0; level < 2; ++level) {
      const double step = (level == 0 ? 4e-3 : 2e-3) * h;
      const auto at = [&](double d) { return normal_pressure(GetParam(), K, d, h); };
      pressure_error[level] =
          std::abs((at(s * h - step).energy - at(s * h + step).energy) / (2 * step) - p.pressure) / K;
      stiffness_error[level] =
          std::abs((at(s * h - step).pressure - at(s * h + step).pressure) / (2 * step) - p.stiffness) * h /
          K;
    }
    for (const auto& error : {pressure_error, stiffness_error}) {
      EXPECT_LT(error[1], 1e-2);
      if (error[1] > 1e-9) EXPECT_NEAR(error[0] / error[1], 4, 0.1);
    }
  }
}

TEST_P(PressureLaw, NothingAtAndBeyondTheContactDistance) {
  for (double d : {h, 1.5 * h}) {
    const Pressure p = normal_pressure(GetParam(), K, d, h);
    EXPECT_EQ(p.energy, 0);
    EXPECT_EQ(p.pressure, 0);
    EXPECT_EQ(p.stiffness, 0);
  }
}
INSTANTIATE_TEST_SUITE_P(Both, PressureLaw, testing::Values(Law::barrier, Law::penalty));

TEST(Barrier, ClosedValueAtHalfTheDistance) {
  // 2 (-1/2) ln(1/2) + (1/4)/(1/2) = ln 2 + 1/2
  EXPECT_NEAR(normal_pressure(Law::barrier, K, 0.5 * h, h).pressure, K * (std::log(2) + 0.5), 1e-9 * K);
}

TEST(Barrier, BoundlessWherePenaltyGivesIn) {
  EXPECT_GT(normal_pressure(Law::barrier, K, 0.01 * h, h).pressure, 100 * K);
  EXPECT_LE(normal_pressure(Law::penalty, K, 0, h).pressure, K);
}

TEST(Barrier, PressureStartsWithZeroSlope) {
  EXPECT_LT(normal_pressure(Law::barrier, K, 0.999 * h, h).stiffness, 0.01 * K / h);
}

}  // namespace
}  // namespace valsalva::contact
