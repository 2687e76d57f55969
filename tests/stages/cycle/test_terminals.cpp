// The ends of the flow domain in front of a column of blood, L dQ/dt = P_d - P: any resistance and
// compliance, also where the column is not what the ends take it for.
#include <gtest/gtest.h>

#include <cmath>

#include "../../../cycle/terminals.hpp"
#include "core/units.hpp"

namespace valsalva::cycle {
namespace {

constexpr double mmHg = units::pa_per_mmHg, drive = 120 * mmHg, inertance = 1.3e-4, initialisation_s = 0.01;

struct Course {
  double flow = 0, pressure = 0, largest = 0;  // the last ones; the largest pressure
};

/// 60 ms of a column of this true inertance under a constant pressure, with alternating steps.
Course run(const CirculationParameters& p, double true_inertance) {
  Terminals ends(p, initialisation_s, inertance);
  Course c;
  double time_s = 0;
  for (int n = 0; time_s < 0.06; ++n) {
    const double dt = n % 3 ? 1e-4 : 6e-5;
    ends.begin(time_s, dt, c.flow, c.flow);
    c.flow += dt / true_inertance * (drive - ends.high_pressure());
    if (const coupling::Answer answer = ends.answers()[1]) {
      const double taken = dt / true_inertance, before = ends.high_pressure();
      const double found =
          coupling::meet(Eigen::MatrixXd::Constant(1, 1, taken), {c.flow}, {before}, {answer})[0];
      c.flow -= taken * (found - before);
      ends.finish({-c.flow, c.flow}, {ends.low_pressure(), found});
    }
    c.pressure = ends.high_pressure();
    c.largest = std::max(c.largest, std::abs(c.pressure));
    time_s += dt;
  }
  return c;
}

CirculationParameters behind(Downstream downstream) {
  CirculationParameters p;
  p.upstream = Upstream::pressure;
  p.pressure.emplace(std::vector<double>{0, 0.4}, std::vector<double>{drive, drive}, 0.8, "test");
  p.period_s = 0.8;
  p.downstream = downstream;
  p.aortic_Pa = 80 * mmHg;
  return p;
}

TEST(Ends, ResistanceOfAnySizeObeysOhm) {
  for (const double share : {0.4, 0.8, 1.0, 1.4})
    for (const double resistance : {0.5, 3.0, 10.0, 1e3, 1e6, 1e9}) {  // mmHg s/mL
      CirculationParameters p = behind(Downstream::resistance);
      p.outlet_resistance = resistance * units::resistance_per_mmHg_s_per_mL;
      const Course c = run(p, share * inertance);
      EXPECT_NEAR(c.pressure, drive, 0.01 * drive) << resistance << ", " << share;
      EXPECT_NEAR(c.flow, (drive - p.aortic_Pa) / p.outlet_resistance,
                  0.02 * (drive - p.aortic_Pa) / p.outlet_resistance + 1e-6)
          << resistance << ", " << share;
      EXPECT_LT(c.largest, 3 * drive) << resistance << ", " << share;
    }
}

TEST(Ends, WindkesselOfAnyComplianceSettlesWhereItsResistancesSay) {
  for (const double compliance : {1e-8, 1e-4}) {  // of the normal one: RC far below the time there is
    CirculationParameters p = behind(Downstream::windkessel);
    p.windkessel = {0.042 * units::resistance_per_mmHg_s_per_mL, 5 * units::resistance_per_mmHg_s_per_mL,
                    compliance * 1.9504 * units::compliance_per_mL_per_mmHg};
    const Course c = run(p, 0.8 * inertance);
    const double all = p.windkessel.characteristic_resistance + p.windkessel.peripheral_resistance;
    EXPECT_NEAR(c.flow, drive / all, 0.02 * drive / all) << compliance;
    EXPECT_NEAR(c.pressure, drive, 0.02 * drive) << compliance;
  }
}

TEST(Ends, AGentleAnswerIsThatOfTheStepsStart) {
  CirculationParameters p = behind(Downstream::resistance);
  p.outlet_resistance = 0.0525 * units::resistance_per_mmHg_s_per_mL;
  Terminals ends(p, initialisation_s, inertance);
  ends.begin(0.02, 5e-5, 3e5, 3e5);
  EXPECT_FALSE(ends.answers()[0] || ends.answers()[1]);
  EXPECT_EQ(ends.high_pressure(), p.aortic_Pa + p.outlet_resistance * 3e5);
}

TEST(Ends, GoOnFromWhatWasSaved) {
  CirculationParameters p = behind(Downstream::resistance);
  p.outlet_resistance = 50 * units::resistance_per_mmHg_s_per_mL;
  Terminals whole(p, initialisation_s, inertance), part(p, initialisation_s, inertance);
  const auto step = [](Terminals& ends, int n) {
    ends.begin(0.02 + n * 1e-4, 1e-4, 10 * n, 20 * n);
    ASSERT_TRUE(ends.answers()[1]);
    ends.finish({-11.0 * n, 21.0 * n}, {3.0 * n, ends.answers()[1](21.0 * n)});
  };
  for (int n = 0; n < 7; ++n) step(whole, n);
  part.restore(whole.save());
  for (int n = 7; n < 9; ++n)
    for (Terminals* ends : {&whole, &part}) step(*ends, n);
  EXPECT_EQ(whole.high_pressure(), part.high_pressure());
  EXPECT_EQ(whole.low_pressure(), part.low_pressure());
}

}  // namespace
}  // namespace valsalva::cycle
