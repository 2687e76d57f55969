#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "circulation/closed_loop.hpp"
#include "core/errors.hpp"
#include "core/units.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::circulation;

TEST(Elastance, ReachesItsMaximumAndMinimumAndIsPeriodic) {
  const LeftHeartParameters p = healthy_left_heart();
  for (const TwoHill& chamber : {p.atrium, p.ventricle}) {
    const Elastance e(chamber, p.period_s);
    double high = 0, low = 1e300;
    for (int i = 0; i < 100000; ++i) {
      high = std::max(high, e.at(p.period_s * i / 100000));
      low = std::min(low, e.at(p.period_s * i / 100000));
    }
    EXPECT_NEAR(high / chamber.maximum, 1.0, 1e-8);
    EXPECT_NEAR(low / chamber.minimum, 1.0, 1e-8);
    EXPECT_NEAR(e.at(0.3), e.at(0.3 + 5 * p.period_s), 1e-12);
    EXPECT_NEAR(e.at(0.3), e.at(0.3 - 2 * p.period_s), 1e-12);
  }
}

TEST(Elastance, FollowsTheFormulaBetween) {
  const TwoHill c{0.1, 0.4, 2, 20, 1e-3, 2e-2, 0};
  const Elastance e(c, 1.0);
  auto shape = [](double t) {
    const double g1 = std::pow(t / 0.1, 2), g2 = std::pow(t / 0.4, 20);
    return g1 / (1 + g1) / (1 + g2);
  };
  EXPECT_NEAR((e.at(0.2) - c.minimum) / (e.at(0.35) - c.minimum), shape(0.2) / shape(0.35), 1e-12);
}

TEST(LeftHeart, ConservesVolume) {
  const LeftHeartParameters p = healthy_left_heart();
  LeftHeart heart(p, 1e5, 9e5);
  const double before = heart.atrial_volume() + heart.ventricular_volume();
  double in = 0;
  for (int i = 0; i < 5000; ++i) {
    const double leaving = 1e5 * std::sin(i * 1e-3);
    heart.advance(i * 2e-4, 2e-4, -leaving);
    in += 2e-4 * (p.vein_flow - leaving);
  }
  EXPECT_NEAR(heart.atrial_volume() + heart.ventricular_volume() - before, in, 1e-6 * std::abs(before));
}

TEST(LeftHeart, MitralValveIsADiode) {
  LeftHeart heart(healthy_left_heart(), 1e5, 9e5);
  bool opened = false, closed = false;
  for (int i = 0; i < 8512; ++i) {
    heart.advance(i * 1e-4, 1e-4, 0);
    ASSERT_GE(heart.mitral_flow(), 0);
    (heart.mitral_flow() > 0 ? opened : closed) = true;
    if (heart.mitral_flow() > 0) {
      EXPECT_NEAR(heart.mitral_flow() * heart.parameters().mitral_resistance,
                  heart.atrial_pressure() - heart.ventricular_pressure(), 1e-6);
    }
  }
  EXPECT_TRUE(opened && closed);
}

// Two chambers of constant elastance through the open diode: the difference of pressures decays with
// exp(-(E_LA + E_LV) t / R_MV).
double relaxation_error(int steps) {
  LeftHeartParameters p = healthy_left_heart();
  p.vein_flow = 0;
  p.atrium.maximum = p.atrium.minimum * (1 + 1e-12);
  p.ventricle.maximum = p.ventricle.minimum * (1 + 1e-12);
  LeftHeart heart(p, 2e5, 1e5);
  const double start = heart.atrial_pressure() - heart.ventricular_pressure();
  const double rate = (p.atrium.minimum + p.ventricle.minimum) / p.mitral_resistance, end = 1 / rate;
  for (int i = 0; i < steps; ++i) heart.advance(i * end / steps, end / steps, 0);
  return std::abs((heart.atrial_pressure() - heart.ventricular_pressure()) / start - std::exp(-1.0));
}

TEST(LeftHeart, FillingIsFirstOrder) {
  EXPECT_LT(relaxation_error(200), 2e-3);
  EXPECT_NEAR(std::log2(relaxation_error(100) / relaxation_error(200)), 1.0, 0.02);
}

TEST(LeftHeart, HugeStepStaysBounded) {
  LeftHeart heart(healthy_left_heart(), 1e5, 9e5);
  heart.advance(0, 0.8512, 0);
  heart.advance(0.8512, 0.8512, 0);
  EXPECT_GT(heart.atrial_volume(), 0);
  EXPECT_LT(std::abs(heart.ventricular_pressure()), 1e5);
}

TEST(LeftHeart, RefusesBadParameters) {
  LeftHeartParameters p = healthy_left_heart();
  p.mitral_resistance = 0;
  EXPECT_THROW(LeftHeart(p, 1, 1), InputError);
  p = healthy_left_heart();
  p.ventricle.maximum = p.ventricle.minimum;
  EXPECT_THROW(LeftHeart(p, 1, 1), InputError);
  EXPECT_THROW(LeftHeart(healthy_left_heart(), std::nan(""), 1), InputError);
}

TEST(ClosedLoop, PeriodicBeatBalancesInflowAndLooksLikeAHeart) {
  using units::resistance_per_mmHg_s_per_mL;
  const LeftHeartParameters heart = healthy_left_heart();
  const WindkesselParameters tree{0.042 * resistance_per_mmHg_s_per_mL, 0.9046 * resistance_per_mmHg_s_per_mL,
                                  1.9504 * units::compliance_per_mL_per_mmHg};
  const PeriodicBeat beat = periodic_beat(heart, tree, {0.02 * resistance_per_mmHg_s_per_mL, 2e-4});
  EXPECT_NEAR(beat.stroke_volume, heart.vein_flow * heart.period_s, 1e-3 * beat.stroke_volume);
  // Published waveforms of the paper (figure 7b): aorta about 75-125 mmHg, ventricle to about 125 mmHg.
  EXPECT_GT(beat.aortic_pressure / units::pa_per_mmHg, 55);
  EXPECT_LT(beat.aortic_pressure / units::pa_per_mmHg, 90);
  EXPECT_GT(beat.peak_ventricular_pressure / units::pa_per_mmHg, 100);
  EXPECT_LT(beat.peak_ventricular_pressure / units::pa_per_mmHg, 140);
  EXPECT_LT(beat.ventricular_pressure / units::pa_per_mmHg, 20);
}

// exp(-T / RC) is 0.995 and 0.99995 with these compliances: the loop moves by less than the tolerance in a
// beat long before it is periodic. What flows in must flow out.
TEST(ClosedLoop, APeriodicBeatIsFoundForAnyCompliance) {
  const LeftHeartParameters heart = healthy_left_heart();
  const double inflow = heart.vein_flow * heart.period_s;
  for (const double factor : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
    const WindkesselParameters tree{0.042 * units::resistance_per_mmHg_s_per_mL,
                                    0.9046 * units::resistance_per_mmHg_s_per_mL,
                                    factor * 1.9504 * units::compliance_per_mL_per_mmHg};
    const PeriodicBeat beat = periodic_beat(heart, tree, {0.02 * units::resistance_per_mmHg_s_per_mL, 2e-4});
    EXPECT_NEAR(beat.stroke_volume, inflow, 2e-3 * inflow) << factor;
    // The mean flow through the peripheral resistance is the mean inflow.
    const double mean = beat.mean_aortic_pressure - tree.characteristic_resistance * heart.vein_flow;
    EXPECT_NEAR(mean, tree.peripheral_resistance * heart.vein_flow, 2e-3 * mean) << factor;
  }
}

TEST(ClosedLoop, AFixedEndOfInflowFails) {
  WindkesselParameters tree{0, 1e9, 1e-3};
  EXPECT_THROW(periodic_beat(healthy_left_heart(), tree, {0, 2e-4}), NumericalFailure);
}

}  // namespace
