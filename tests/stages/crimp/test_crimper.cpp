#include <gtest/gtest.h>

#include <cmath>

#include "crimper.hpp"

namespace valsalva::crimp {
namespace {

TEST(Crimper, ClosesFromStartToEndInTheGivenTime) {
  const Crimper crimper(16, 2.85, 500, 4e-3);
  EXPECT_DOUBLE_EQ(crimper.radius_mm(0), 16);
  EXPECT_DOUBLE_EQ(crimper.radius_mm(crimper.duration_s()), 2.85);
  EXPECT_NEAR(crimper.duration_s(), 13.15 / 500 + 4e-3, 1e-15);
  EXPECT_DOUBLE_EQ(crimper.speed_mm_per_s(0.5 * crimper.duration_s()), 500);
}

TEST(Crimper, RadiusIsTheIntegralOfTheSpeedToSecondOrder) {
  const Crimper crimper(16, 2.85, 500, 4e-3);
  double error[2];
  for (int level = 0; level < 2; ++level) {
    const double h = level == 0 ? 2e-4 : 1e-4;
    error[level] = 0;
    for (double t : {1e-3, 2.5e-3, crimper.duration_s() - 1.5e-3}) {
      const double slope = (crimper.radius_mm(t + h) - crimper.radius_mm(t - h)) / (2 * h);
      error[level] = std::max(error[level], std::abs(slope + crimper.speed_mm_per_s(t)));
    }
  }
  EXPECT_LT(error[1], 1);
  EXPECT_NEAR(error[0] / error[1], 4, 0.1);
}

TEST(Crimper, AShortWayShortensTheRamps) {
  const Crimper crimper(3, 2.9, 500, 4e-3);
  EXPECT_NEAR(crimper.duration_s(), 2 * 0.1 / 500, 1e-15);
  EXPECT_NEAR(crimper.radius_mm(0.5 * crimper.duration_s()), 2.95, 1e-12);
}

TEST(Crimper, AWiderTargetThanTheDeviceStays) {
  const Crimper crimper(3, 4, 500, 4e-3);
  EXPECT_EQ(crimper.duration_s(), 0);
  EXPECT_EQ(crimper.radius_mm(1), 3);
}

}  // namespace
}  // namespace valsalva::crimp
