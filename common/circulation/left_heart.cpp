#include "circulation/left_heart.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::circulation {

namespace {

void require(bool good, const char* what, double value, const char* expected) {
  if (!good) throw InputError("circulation: {} is {}; expected {}", what, value, expected);
}

}  // namespace

Elastance::Elastance(const TwoHill& p, double period_s) : parameters_(p), period_s_(period_s) {
  require(period_s > 0 && std::isfinite(period_s), "the heart's period (s)", period_s, "a positive one");
  require(p.tau1_s > 0, "an elastance's tau1 (s)", p.tau1_s, "a positive one");
  require(p.tau2_s > 0, "an elastance's tau2 (s)", p.tau2_s, "a positive one");
  require(p.m1 > 0, "an elastance's exponent m1", p.m1, "a positive one");
  require(p.m2 > 0, "an elastance's exponent m2", p.m2, "a positive one");
  require(p.minimum > 0, "an elastance's minimum (Pa/mm3)", p.minimum, "a positive one");
  require(p.maximum > p.minimum, "an elastance's maximum (Pa/mm3)", p.maximum, "more than the minimum");
  // The shape has one maximum: bracket it on a fine table, then refine by golden section.
  constexpr int samples = 2000;
  int best = 1;
  for (int i = 1; i < samples; ++i)
    if (shape(period_s * i / samples) > shape(period_s * best / samples)) best = i;
  double low = period_s * (best - 1) / samples, high = period_s * (best + 1) / samples;
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  while (high - low > 1e-9 * period_s) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (shape(a) < shape(b) ? low : high) = shape(a) < shape(b) ? a : b;
  }
  scale_ = (p.maximum - p.minimum) / shape(0.5 * (low + high));
}

double Elastance::shape(double phase_s) const {
  const double g1 = std::pow(phase_s / parameters_.tau1_s, parameters_.m1);
  const double g2 = std::pow(phase_s / parameters_.tau2_s, parameters_.m2);
  return g1 / (1 + g1) / (1 + g2);
}

double Elastance::at(double time_s) const {
  double phase = std::fmod(time_s - parameters_.shift_s, period_s_);
  if (phase < 0) phase += period_s_;
  return scale_ * shape(phase) + parameters_.minimum;
}

LeftHeartParameters healthy_left_heart() {
  using units::elastance_per_mmHg_per_mL;
  using units::resistance_per_mmHg_s_per_mL;
  LeftHeartParameters p;
  const double period = p.period_s = 0.8512;
  p.vein_flow = 5.8e6 / units::s_per_min;
  p.mitral_resistance = 0.005 * resistance_per_mmHg_s_per_mL;
  p.outflow_resistance = 0.0043 * resistance_per_mmHg_s_per_mL;
  p.atrium = {0.1150 * period,
              0.1882 * period,
              1.32,
              13.1,
              0.08 * elastance_per_mmHg_per_mL,
              0.17 * elastance_per_mmHg_per_mL,
              0.85 * period};
  p.ventricle = {0.0725 * period,
                 0.4503 * period,
                 2.7463,
                 21.5683,
                 0.01 * elastance_per_mmHg_per_mL,
                 0.1191 * elastance_per_mmHg_per_mL,
                 0.0};
  return p;
}

LeftHeart::LeftHeart(const LeftHeartParameters& p, double atrial_volume, double ventricular_volume)
    : parameters_(p),
      atrium_(p.atrium, p.period_s),
      ventricle_(p.ventricle, p.period_s),
      atrial_volume_(atrial_volume),
      ventricular_volume_(ventricular_volume) {
  require(p.vein_flow >= 0, "the pulmonary vein's flow (mm3/s)", p.vein_flow, "zero or more");
  require(p.mitral_resistance > 0, "the mitral resistance (Pa s/mm3)", p.mitral_resistance, "a positive one");
  require(p.mitral_leak_resistance >= 0, "the shut mitral valve's resistance (Pa s/mm3)",
          p.mitral_leak_resistance, "zero or more");
  require(p.outflow_resistance >= 0, "the outflow tract's resistance (Pa s/mm3)", p.outflow_resistance,
          "zero or more");
  require(std::isfinite(atrial_volume) && atrial_volume > 0, "the atrial volume (mm3)", atrial_volume,
          "a positive one");
  require(std::isfinite(ventricular_volume) && ventricular_volume > 0, "the ventricular volume (mm3)",
          ventricular_volume, "a positive one");
  atrial_pressure_ = atrium_.at(0) * atrial_volume;
  ventricular_pressure_ = ventricle_.at(0) * ventricular_volume;
}

void LeftHeart::advance(double time_s, double dt_s, double inflow) {
  const double atrial = atrium_.at(time_s + dt_s), ventricular = ventricle_.at(time_s + dt_s);
  const double atrial_closed = atrial_volume_ + dt_s * parameters_.vein_flow;
  const double ventricular_closed = ventricular_volume_ + dt_s * inflow;
  // Implicit: R_MV Q = E_LA (V_LA' - dt Q) - E_LV (V_LV' + dt Q), cut off at Q = 0 by the diode.
  const double drive = atrial * atrial_closed - ventricular * ventricular_closed;
  const auto flow = [&](double resistance) { return drive / (resistance + dt_s * (atrial + ventricular)); };
  const double leak = parameters_.mitral_leak_resistance;
  mitral_flow_ = drive > 0 ? flow(parameters_.mitral_resistance) : leak > 0 ? flow(leak) : 0;
  atrial_volume_ = atrial_closed - dt_s * mitral_flow_;
  ventricular_volume_ = ventricular_closed + dt_s * mitral_flow_;
  atrial_pressure_ = atrial * atrial_volume_;
  ventricular_pressure_ = ventricular * ventricular_volume_;
  inflow_ = inflow;
}

std::vector<double> LeftHeart::save() const {
  return {atrial_volume_,        ventricular_volume_, atrial_pressure_,
          ventricular_pressure_, mitral_flow_,        inflow_};
}

void LeftHeart::restore(const std::vector<double>& saved) {
  VALSALVA_ASSERT(saved.size() == 6);
  atrial_volume_ = saved[0];
  ventricular_volume_ = saved[1];
  atrial_pressure_ = saved[2];
  ventricular_pressure_ = saved[3];
  mitral_flow_ = saved[4];
  inflow_ = saved[5];
}

}  // namespace valsalva::circulation
