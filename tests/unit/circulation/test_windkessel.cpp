#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "circulation/windkessel.hpp"
#include "core/errors.hpp"
#include "core/units.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::circulation;

WindkesselParameters paper() {
  return {0.042 * units::resistance_per_mmHg_s_per_mL, 0.9046 * units::resistance_per_mmHg_s_per_mL,
          1.9504 * units::compliance_per_mL_per_mmHg};
}

TEST(Windkessel, DecaysExactlyWithoutInflow) {
  const WindkesselParameters p = paper();
  Windkessel w(p, 10e3);
  for (int i = 0; i < 7; ++i) w.advance(0, 0.1, 0);
  EXPECT_NEAR(w.pressure(), 10e3 * std::exp(-0.7 / (p.peripheral_resistance * p.compliance)), 1e-8);
}

TEST(Windkessel, ConstantInflowIsExactForAnyStep) {
  const WindkesselParameters p = paper();
  const double q = 9e4, tau = p.peripheral_resistance * p.compliance;
  Windkessel one(p, 5e3), many(p, 5e3);
  one.advance(0, 2.0, q);
  for (int i = 0; i < 1000; ++i) many.advance(0, 0.002, q);
  const double exact = p.peripheral_resistance * q +
                       (5e3 - p.peripheral_resistance * q) * std::exp(-2.0 / tau) +
                       p.characteristic_resistance * q;
  EXPECT_NEAR(one.pressure(), exact, 1e-7);
  EXPECT_NEAR(many.pressure(), exact, 1e-7);
}

// Q = q sin(w t): the periodic answer is |Z| q sin(w t + phase), Z = R_c + R_p / (1 + i w R_p C).
double error_of_sine(int steps_per_period) {
  const WindkesselParameters p = paper();
  const double w = 2 * std::numbers::pi / 0.8, q = 1e5, dt = 0.8 / steps_per_period;
  const double a = w * p.peripheral_resistance * p.compliance,
               scale = p.peripheral_resistance * q / (1 + a * a);
  auto stored = [&](double t) { return scale * (std::sin(w * t) - a * std::cos(w * t)); };
  Windkessel model(p, stored(0));
  double worst = 0;
  for (int i = 0; i < steps_per_period; ++i) {
    model.advance(i * dt, dt, q * std::sin(w * (i + 0.5) * dt));
    worst = std::max(worst, std::abs(model.stored_pressure() - stored((i + 1) * dt)));
  }
  return worst / scale;
}

TEST(Windkessel, SinusoidalFlowAtMidStepIsSecondOrder) {
  const double coarse = error_of_sine(50), fine = error_of_sine(100);
  EXPECT_LT(fine, 1e-2);
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.05);
}

TEST(Windkessel, HugeStepStaysBounded) {
  const WindkesselParameters p = paper();
  Windkessel w(p, 10e3);
  w.advance(0, 1e6, 1e5);
  EXPECT_NEAR(w.stored_pressure(), p.peripheral_resistance * 1e5, 1e-9);
}

TEST(Windkessel, RestoresBitwise) {
  Windkessel a(paper(), 10e3);
  a.advance(0, 0.013, 7e4);
  Windkessel b(paper(), 0);
  b.restore(a.save());
  a.advance(0, 0.01, 3e4);
  b.advance(0, 0.01, 3e4);
  EXPECT_EQ(a.pressure(), b.pressure());
}

TEST(Windkessel, RefusesBadParameters) {
  EXPECT_THROW(Windkessel({0.1, 0.0, 1.0}, 0), InputError);
  EXPECT_THROW(Windkessel({-0.1, 1.0, 1.0}, 0), InputError);
  EXPECT_THROW(Windkessel({0.1, 1.0, -1.0}, 0), InputError);
  EXPECT_THROW(Windkessel({0.1, 1.0, 1.0}, std::nan("")), InputError);
  EXPECT_THROW(Resistance(-1, 0), InputError);
}

TEST(Resistance, IsOhmsLaw) {
  Resistance r(2e-3, 500);
  r.advance(0, 1e-3, 4e4);
  EXPECT_DOUBLE_EQ(r.pressure(), 580);
}

}  // namespace
