// The pump and its impedance adapter against closed forms, for any step, and their balance of volume.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "circulation/pulse_duplicator.hpp"
#include "core/units.hpp"
#include "expect_error.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::circulation;

constexpr double resistance = units::resistance_per_mmHg_s_per_mL;
constexpr double compliance = units::compliance_per_mL_per_mmHg;

Waveform constant(double value) {
  return Waveform({0, 0.5}, {value, value}, 1, "constant");
}

// pulse-duplicator-2020: the porcine and the bovine pericardial valve's upstream models.
AdapterParameters porcine() {
  return {0.15 * resistance, 0.15 * resistance, 0.1 * compliance};
}
ChamberParameters bovine() {
  return {0.0275 * compliance, 0.0347 * compliance, 0.15 * resistance,
          0.0898 * resistance, 0.0280 * resistance, 0};
}

TEST(ImpedanceAdapter, ConstantDataIsExactForAnyStep) {
  const AdapterParameters p = porcine();
  const double pump = 16e3, flow = -2e5, tau = p.inner_resistance * p.compliance;
  for (const double dt : {1e-4, 3e-3, 2.0}) {
    ImpedanceAdapter adapter(p, constant(pump), 1e3);
    double time = 0;
    for (; time < 5 * tau || time == 0; time += dt) adapter.advance(time, dt, flow);
    const double steady = pump + p.inner_resistance * flow;
    const double stored = steady + (1e3 - steady) * std::exp(-time / tau);
    EXPECT_NEAR(adapter.pressure(), stored + p.outer_resistance * flow, 1e-6) << dt;
  }
}

double sine_error(int steps) {
  const AdapterParameters p = porcine();
  const double w = 2 * std::numbers::pi, a = w * p.inner_resistance * p.compliance;
  std::vector<double> time, value;
  for (int i = 0; i < 1000; ++i) {
    time.push_back(i / 1000.0);
    value.push_back(1e4 * std::sin(w * i / 1000.0));
  }
  const auto stored = [&](double t) { return 1e4 / (1 + a * a) * (std::sin(w * t) - a * std::cos(w * t)); };
  ImpedanceAdapter adapter(p, Waveform(time, value, 1, "sine"), stored(0));
  double worst = 0;
  for (int i = 0; i < steps; ++i) {
    adapter.advance(1.0 * i / steps, 1.0 / steps, 0);
    worst = std::max(worst, std::abs(adapter.stored_pressure() - stored((i + 1.0) / steps)));
  }
  return worst / 1e4;
}

TEST(ImpedanceAdapter, SecondOrderForAVaryingPump) {
  const double coarse = sine_error(80), fine = sine_error(160);
  EXPECT_LT(fine, 0.01);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2);
}

// Atrium far below: the valve is shut. With constant pump flow and outflow: both pressures rise at the rate
// (Q_p - Q) / (C_1 + C_2), their difference relaxes to R (C_2 Q_p + C_1 Q) / (C_1 + C_2).
TEST(PumpChamber, ShutItFillsAtTheRateOfBothCompliances) {
  const ChamberParameters p = bovine();
  PumpChamber pump(p, constant(3e5), constant(-1e9), 2e3);
  const double dt = 1e-4, out = 1e5;
  for (int i = 0; i < 4000; ++i) pump.advance(i * dt, dt, -out);
  const double c1 = p.pump_compliance, c2 = p.chamber_compliance;
  const double volume = c1 * pump.pump_side_pressure() + c2 * pump.chamber_pressure();
  EXPECT_NEAR(volume / ((c1 + c2) * 2e3 + (3e5 - out) * 0.4), 1, 1e-10) << "volume is conserved";
  EXPECT_NEAR(pump.pump_side_pressure() - pump.chamber_pressure(),
              p.adapter_resistance * (c2 * 3e5 + c1 * out) / (c1 + c2), 1e-3);
  EXPECT_EQ(pump.mitral_flow(), 0);
  EXPECT_NEAR(pump.pressure(), pump.chamber_pressure() - p.outlet_resistance * out, 1e-9);
}

TEST(PumpChamber, OpenItSettlesAtTheMitralValvesDrop) {
  const ChamberParameters p = bovine();
  PumpChamber pump(p, constant(-1e5), constant(1e3), 2e3);
  for (int i = 0; i < 4000; ++i) pump.advance(i * 1e-4, 1e-4, 0);
  EXPECT_NEAR(pump.mitral_flow(), 1e5, 1e-3);
  EXPECT_NEAR(pump.chamber_pressure(), 1e3 - p.mitral_resistance * 1e5, 1e-6);
}

TEST(PumpChamber, ALeakingMitralValveLetsBackWhatItsResistanceSays) {
  ChamberParameters p = bovine();
  p.mitral_leak_resistance = 2 * resistance;
  PumpChamber pump(p, constant(1e4), constant(1e3), 2e3);
  for (int i = 0; i < 40000; ++i) pump.advance(i * 1e-3, 1e-3, 0);
  EXPECT_NEAR(pump.mitral_flow(), -1e4, 1e-3);
  EXPECT_NEAR(pump.chamber_pressure(), 1e3 + 2 * resistance * 1e4, 1e-5);
}

TEST(PumpChamber, StableForAnyStepComplianceAndResistance) {
  for (const double c : {1e-4, 1.0, 1e2})
    for (const double r : {1e-4, 1.0, 1e4})
      for (const double dt : {1e-6, 1e-3, 0.1}) {
        ChamberParameters p = bovine();
        p.pump_compliance *= c;
        p.chamber_compliance *= c;
        p.adapter_resistance *= r;
        p.mitral_resistance *= r;
        PumpChamber pump(p, constant(0), constant(1e3), 9e3);
        double before = 9e3;
        for (int i = 0; i < 200; ++i) {
          pump.advance(i * dt, dt, 0);
          const double now = std::max(pump.chamber_pressure(), pump.pump_side_pressure());
          EXPECT_LE(now, before * (1 + 1e-12));
          EXPECT_GE(std::min(pump.chamber_pressure(), pump.pump_side_pressure()), 1e3 * (1 - 1e-9));
          before = now;
        }
      }
}

TEST(PumpChamber, ContinuesBitForBit) {
  const Waveform beat = systolic_flow(7e4, 0.3, 1), atrium = systolic_pressure(500, 1500, 0.3, 1);
  PumpChamber whole(bovine(), beat, atrium, 1e3), first(bovine(), beat, atrium, 1e3),
      second(bovine(), beat, atrium, 5e3);
  for (int i = 0; i < 200; ++i) whole.advance(i * 1e-3, 1e-3, -1e3);
  for (int i = 0; i < 100; ++i) first.advance(i * 1e-3, 1e-3, -1e3);
  second.restore(first.save());
  for (int i = 100; i < 200; ++i) second.advance(i * 1e-3, 1e-3, -1e3);
  EXPECT_EQ(whole.save(), second.save());
}

TEST(PulseDuplicator, ImpossibleParametersAreRefused) {
  AdapterParameters a = porcine();
  a.compliance = 0;
  test::expect_error(ExitCode::input, {"impedance adapter", "C = 0", "C > 0"},
                     [&] { ImpedanceAdapter(a, constant(0), 0); });
  ChamberParameters c = bovine();
  c.adapter_resistance = -1;
  test::expect_error(ExitCode::input, {"pump", "R_VIA = -1", "positive"},
                     [&] { PumpChamber(c, constant(0), constant(0), 0); });
}

}  // namespace
