#include "circulation_case.hpp"

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::cycle {
namespace {

using namespace circulation;
using units::pa_per_mmHg;

TwoHill chamber(const Case& scene, const std::string& name, double period_s, double shift) {
  const auto of = [&](const std::string& key) { return scene.real("circulation." + name + "_" + key); };
  return {of("tau1_fraction") * period_s,
          of("tau2_fraction") * period_s,
          of("m1"),
          of("m2"),
          of("elastance_min_mmHg_per_mL") * units::elastance_per_mmHg_per_mL,
          of("elastance_max_mmHg_per_mL") * units::elastance_per_mmHg_per_mL,
          shift * period_s};
}

double resistance(const Case& scene, const std::string& key) {
  return scene.real("circulation." + key + "_mmHg_s_per_mL") * units::resistance_per_mmHg_s_per_mL;
}

Waveform knots(const Case& scene, const std::string& times, const std::string& values, double unit,
               double period_s) {
  std::vector<double> value = scene.reals(values);
  for (double& v : value) v *= unit;
  return Waveform(scene.reals(times), std::move(value), period_s, scene.file().string() + ": " + values);
}

double compliance(const Case& scene, const std::string& key) {
  return scene.real("circulation." + key + "_mL_per_mmHg") * units::compliance_per_mL_per_mmHg;
}

Waveform atrial_pressure(const Case& scene, double period_s) {
  const auto& values = scene.reals("circulation.atrial_pressure_mmHg");
  if (!scene.reals("circulation.atrial_time_s").empty())
    return knots(scene, "circulation.atrial_time_s", "circulation.atrial_pressure_mmHg", pa_per_mmHg,
                 period_s);
  if (values.size() != 1)
    throw InputError(
        "{}: circulation.atrial_pressure_mmHg has {} values and circulation.atrial_time_s none; expected one "
        "value, or as many times",
        scene.file().string(), values.size());
  const double constant = values.front() * pa_per_mmHg;
  return Waveform({0, 0.5 * period_s}, {constant, constant}, period_s, "circulation.atrial_pressure_mmHg");
}

}  // namespace

CirculationParameters read_circulation(const Case& scene) {
  CirculationParameters c;
  const std::string up = scene.text("circulation.upstream"), down = scene.text("circulation.downstream");
  c.upstream = up == "heart"     ? Upstream::heart
               : up == "flow"    ? Upstream::flow
               : up == "adapter" ? Upstream::adapter
               : up == "pump"    ? Upstream::pump
                                 : Upstream::pressure;
  c.downstream = down == "windkessel"   ? Downstream::windkessel
                 : down == "resistance" ? Downstream::resistance
                                        : Downstream::pressure;
  const double period = c.period_s = scene.real("circulation.period_s");
  c.heart.period_s = period;
  c.heart.vein_flow =
      scene.real("circulation.vein_flow_L_per_min") * 1e3 * units::mm3_per_mL / units::s_per_min;
  c.heart.mitral_resistance = resistance(scene, "mitral_resistance");
  c.heart.mitral_leak_resistance = resistance(scene, "mitral_leak_resistance");
  c.heart.outflow_resistance = resistance(scene, "lvot_resistance");
  c.heart.ventricle = chamber(scene, "lv", period, 0);
  c.heart.atrium = chamber(scene, "la", period, scene.real("circulation.la_shift_fraction"));
  c.windkessel = {resistance(scene, "characteristic_resistance"), resistance(scene, "peripheral_resistance"),
                  compliance(scene, "compliance")};
  c.end_diastolic_Pa = scene.real("circulation.end_diastolic_pressure_mmHg") * pa_per_mmHg;
  c.aortic_Pa = scene.real("circulation.aortic_pressure_mmHg") * pa_per_mmHg;
  c.outlet_resistance = resistance(scene, "outlet_resistance");
  if (c.upstream == Upstream::flow || c.upstream == Upstream::pump)
    c.flow =
        scene.reals("circulation.flow_time_s").empty()
            ? systolic_flow(scene.real("circulation.stroke_volume_mL") * units::mm3_per_mL,
                            scene.real("circulation.ejection_s"), period)
            : knots(scene, "circulation.flow_time_s", "circulation.flow_mL_per_s", units::mm3_per_mL, period);
  if (c.upstream == Upstream::pressure || c.upstream == Upstream::adapter)
    c.pressure =
        scene.reals("circulation.pressure_time_s").empty()
            ? systolic_pressure(c.end_diastolic_Pa,
                                scene.real("circulation.peak_pressure_mmHg") * pa_per_mmHg,
                                scene.real("circulation.systole_s"), period)
            : knots(scene, "circulation.pressure_time_s", "circulation.pressure_mmHg", pa_per_mmHg, period);
  c.adapter = {resistance(scene, "adapter_resistance"), resistance(scene, "adapter_outlet_resistance"),
               compliance(scene, "adapter_compliance")};
  c.pump = {compliance(scene, "pump_compliance"),    compliance(scene, "chamber_compliance"),
            resistance(scene, "adapter_resistance"), resistance(scene, "pump_outlet_resistance"),
            resistance(scene, "mitral_resistance"),  resistance(scene, "mitral_leak_resistance")};
  if (c.upstream == Upstream::pump) c.atrial_pressure = atrial_pressure(scene, period);
  return c;
}

}  // namespace valsalva::cycle
