#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "circulation/waveform.hpp"
#include "core/errors.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::circulation;

TEST(Waveform, PassesThroughItsKnotsAndIsPeriodic) {
  const Waveform w({0.0, 0.1, 0.3, 0.7}, {1.0, 4.0, -2.0, 0.5}, 1.0, "test");
  EXPECT_DOUBLE_EQ(w.at(0.1), 4.0);
  EXPECT_DOUBLE_EQ(w.at(0.7), 0.5);
  EXPECT_NEAR(w.at(3.3), -2.0, 1e-12);
  EXPECT_NEAR(w.at(-0.9), 4.0, 1e-12);
  EXPECT_NEAR(w.at(1.0 - 1e-12), 1.0, 1e-9);
}

TEST(Waveform, NeverOvershoots) {
  const Waveform w({0.0, 0.1, 0.2, 0.5, 0.6}, {0.0, 10.0, 10.0, 0.0, 0.0}, 1.0, "test");
  for (int i = 0; i < 5000; ++i) {
    EXPECT_GE(w.at(i * 2e-4), -1e-12);
    EXPECT_LE(w.at(i * 2e-4), 10 + 1e-12);
  }
}

TEST(Waveform, IntegralIsThatOfTheCurve) {
  const Waveform w({0.05, 0.2, 0.3, 0.7}, {1.0, 4.0, -2.0, 0.5}, 1.0, "test");
  double sum = 0;
  for (int i = 0; i < 20000; ++i) sum += w.at((i + 0.5) / 20000) / 20000;
  EXPECT_NEAR(w.integral(), sum, 1e-7);
}

TEST(Waveform, RefusesBadKnots) {
  EXPECT_THROW(Waveform({0.0}, {1.0}, 1, "t"), InputError);
  EXPECT_THROW(Waveform({0.0, 0.5}, {1.0}, 1, "t"), InputError);
  EXPECT_THROW(Waveform({0.5, 0.2}, {1.0, 2.0}, 1, "t"), InputError);
  EXPECT_THROW(Waveform({0.0, 1.0}, {1.0, 2.0}, 1, "t"), InputError);
  EXPECT_THROW(Waveform({0.0, 0.5}, {1.0, std::nan("")}, 1, "t"), InputError);
}

TEST(Waveform, SystolicFlowHasTheStrokeVolumeAndAnEarlyPeak) {
  const Waveform q = systolic_flow(45.32, 0.33, 0.7836);
  EXPECT_NEAR(q.integral(), 45.32, 1e-9);
  double best = 0;
  for (int i = 0; i < 1000; ++i)
    if (q.at(i * 3.3e-4) > q.at(best)) best = i * 3.3e-4;
  EXPECT_NEAR(best, 0.11, 0.005);
  EXPECT_NEAR(q.at(0.5), 0, 1e-9);
}

TEST(FlowSource, DrivesAColumnAgainstPressureAndFollowsTheWaveform) {
  const Waveform target = systolic_flow(7e4, 0.33, 0.8);
  const double inertance = 2e-4, load = 8e3, resistance = 3e-3, dt = 5e-5;
  FlowSource pump(target, inertance, load);
  double flow = 0, worst = 0, largest = 0;
  for (int i = 0; i < 16000; ++i) {
    pump.advance(i * dt, dt, -flow);
    flow += dt / inertance * (pump.pressure() - load - resistance * flow);
    worst = std::max(worst, std::abs(flow - target.at((i + 1) * dt)));
    largest = std::max(largest, flow);
  }
  EXPECT_LT(worst, 0.01 * largest);
}

}  // namespace
