#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/units.hpp"
#include "metrics/beat.hpp"
#include "metrics/flutter.hpp"
#include "metrics/statistics.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::metrics;

constexpr double pi = std::numbers::pi;

// A half sine of flow for 0.3 s, a gradient in phase with it, 10 mm3/s of leak in diastole.
BeatSeries half_sine(int samples) {
  BeatSeries s;
  for (int i = 0; i <= samples; ++i) {
    const double t = 0.8 * i / samples, wave = t < 0.3 ? std::sin(pi * t / 0.3) : 0;
    s.time_s.push_back(t);
    s.flow.push_back(t < 0.3 ? 4e5 * wave : -1e4);
    s.upstream_Pa.push_back(t < 0.3 ? 1e4 + 2000 * wave : 1e3);
    s.downstream_Pa.push_back(1e4);
    s.jet_mm_per_s.push_back(2000 * wave);
    s.inflow_power.push_back(100 * wave);
    s.outflow_power.push_back(90 * wave);
    s.paravalvular.push_back(t < 0.3 ? 5 : -2e3);
  }
  return s;
}

TEST(Beat, ClosedFormsOfAHalfSine) {
  const auto m = beat_metrics(half_sine(8000), 0.8, 1e-3);
  ASSERT_TRUE(m);
  EXPECT_NEAR(m->mean_gradient_Pa, 2000 * 2 / pi, 1);
  EXPECT_NEAR(m->peak_gradient_Pa, 2000, 1e-2);
  EXPECT_NEAR(m->stroke_volume, 4e5 * 0.3 * 2 / pi, 30);
  EXPECT_NEAR(m->regurgitant_volume, 1e4 * 0.5, 5);
  EXPECT_NEAR(m->paravalvular_leak, 2e3 * 0.5, 1);
  EXPECT_NEAR(m->output, (m->stroke_volume - m->regurgitant_volume) / 0.8, 1e-9);
  EXPECT_NEAR(m->peak_jet_mm_per_s, 2000, 1e-2);
  EXPECT_NEAR(m->energy_efficiency, 0.9, 1e-9);
  // Gorlin type: Q_rms = 400 / sqrt 2 mL/s, mean gradient 4000/pi Pa, rho 1 g/cm3.
  EXPECT_NEAR(m->eoa_mm2 / 100, 400 / std::sqrt(2.0) / (51.6 * std::sqrt(4000 / pi / units::pa_per_mmHg)),
              1e-3);
  EXPECT_NEAR(m->eoa_continuity_mm2, 200, 0.1);
  EXPECT_NEAR(m->ejection_end_s, 0.3, 1e-3);
}

TEST(Beat, NothingWithoutForwardFlowOrGradient) {
  BeatSeries s = half_sine(100);
  for (double& q : s.flow) q = -1;
  EXPECT_FALSE(beat_metrics(s, 0.8, 1e-3));
  s = half_sine(100);
  for (double& p : s.upstream_Pa) p = 0;
  EXPECT_FALSE(beat_metrics(s, 0.8, 1e-3));
  EXPECT_FALSE(beat_metrics(half_sine(2), 0.8, 1e-3));
}

TEST(Flutter, FindsAmplitudeAndFrequencyOnATrend) {
  std::vector<double> t, x;
  for (int i = 0; i <= 3000; ++i) {
    t.push_back(1e-4 * i * (1 + 1e-5 * i));
    x.push_back(5 + 20 * t.back() - 40 * t.back() * t.back() + 0.3 * std::sin(2 * pi * 60 * t.back()));
  }
  const Flutter f = flutter(t, x, 0.05, 0.25);
  EXPECT_NEAR(f.peak_Hz, 60, 2.5);
  EXPECT_NEAR(f.amplitude, 0.3 / std::sqrt(2.0), 0.01);
}

TEST(Flutter, IsSilentOutsideItsBandAndForShortWindows) {
  std::vector<double> t, x;
  for (int i = 0; i <= 3000; ++i) {
    t.push_back(1e-4 * i);
    x.push_back(std::sin(2 * pi * 5 * t.back()));
  }
  EXPECT_LT(flutter(t, x, 0.05, 0.25).amplitude, 0.01);
  EXPECT_EQ(flutter(t, x, 0.1, 0.12).amplitude, 0);
}

TEST(Percentile, WeighsItsValues) {
  EXPECT_EQ(weighted_percentile({3, 1, 2}, {1, 1, 1}, 0.5), 2);
  EXPECT_EQ(weighted_percentile({3, 1, 2}, {1, 98, 1}, 0.9), 1);
  EXPECT_EQ(weighted_percentile({3, 1, 2}, {1, 98, 1}, 0.995), 3);
  EXPECT_EQ(weighted_percentile({}, {}, 0.5), 0);
}

}  // namespace
