#include <gtest/gtest.h>

#include <cmath>

#include "metrics/periodicity.hpp"

namespace valsalva::metrics {
namespace {

BeatSamples sine(int samples, double offset, double amplitude = 1) {
  BeatSamples beat;
  for (int i = 0; i <= samples; ++i) {
    beat.phase_s.push_back(0.8 * i / samples);
    beat.value.push_back(offset + amplitude * std::sin(2 * M_PI * i / samples));
  }
  return beat;
}

TEST(Periodicity, EqualBeatsDoNotDifferWhereverTheirSamplesLie) {
  EXPECT_EQ(beat_difference(sine(300, 2), sine(300, 2)), 0);
  EXPECT_LT(beat_difference(sine(300, 2), sine(473, 2)), 1e-4);
}

TEST(Periodicity, AShiftIsItsShareOfTheRange) {
  EXPECT_NEAR(beat_difference(sine(300, 2.1), sine(300, 2)), 0.05, 1e-4);
}

TEST(Periodicity, AChangeOfAmplitudeIsItsRootMeanSquare) {
  EXPECT_NEAR(beat_difference(sine(1000, 0, 1.2), sine(1000, 0)), 0.2 / std::sqrt(2) / 2, 1e-3);
}

TEST(Periodicity, WithoutARangeAnyChangeIsAWholeOne) {
  const BeatSamples still{{0, 1}, {3, 3}}, other{{0, 1}, {4, 4}};
  EXPECT_EQ(beat_difference(still, still), 0);
  EXPECT_EQ(beat_difference(other, still), 1);
}

}  // namespace
}  // namespace valsalva::metrics
