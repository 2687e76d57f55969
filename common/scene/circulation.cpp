#include "scene/scene.hpp"

namespace valsalva {

namespace {

void declare_heart(Schema& schema) {
  schema.real("circulation.vein_flow_L_per_min", 5.8, not_negative(),
              "Heart: constant flow of the pulmonary veins into the left atrium (Brown et al. 2022)");
  schema.real("circulation.mitral_resistance_mmHg_s_per_mL", 0.005, positive(),
              "Heart: resistance of the open mitral valve, a diode (Brown et al. 2022)");
  schema.real("circulation.mitral_leak_resistance_mmHg_s_per_mL", 0, not_negative(),
              "Resistance of the shut mitral valve; 0: nothing passes");
  schema.real("circulation.lvot_resistance_mmHg_s_per_mL", 0.0043, not_negative(),
              "Heart: resistance between ventricle and outflow tract (Brown et al. 2022)");
  schema.real("circulation.lv_tau1_fraction", 0.0725, positive(),
              "Left ventricle, two-Hill elastance: rise time over the period (Brown et al. 2022)");
  schema.real("circulation.lv_tau2_fraction", 0.4503, positive(), "the same: fall time over the period");
  schema.real("circulation.lv_m1", 2.7463, positive(), "the same: exponent of the rise");
  schema.real("circulation.lv_m2", 21.5683, positive(), "the same: exponent of the fall");
  schema.real("circulation.lv_elastance_min_mmHg_per_mL", 0.01, positive(), "the same: least elastance");
  schema.real("circulation.lv_elastance_max_mmHg_per_mL", 0.1191, positive(), "the same: greatest elastance");
  schema.real("circulation.la_tau1_fraction", 0.1150, positive(),
              "Left atrium, two-Hill elastance: rise time over the period (Brown et al. 2022)");
  schema.real("circulation.la_tau2_fraction", 0.1882, positive(), "the same: fall time over the period");
  schema.real("circulation.la_m1", 1.32, positive(), "the same: exponent of the rise");
  schema.real("circulation.la_m2", 13.1, positive(), "the same: exponent of the fall");
  schema.real("circulation.la_elastance_min_mmHg_per_mL", 0.08, positive(), "the same: least elastance");
  schema.real("circulation.la_elastance_max_mmHg_per_mL", 0.17, positive(), "the same: greatest elastance");
  schema.real("circulation.la_shift_fraction", 0.85, {0, 1},
              "Atrial contraction starts this share of the period after ventricular contraction");
}

void declare_waveforms(Schema& schema) {
  schema.real("circulation.stroke_volume_mL", 45.32, positive(),
              "Prescribed flow: volume of a beat of the analytic waveform (Brown et al. 2022, one patient)");
  schema.real("circulation.ejection_s", 0.33, positive(), "Prescribed flow: duration of ejection (assumed)");
  schema.reals(
      "circulation.flow_time_s", {}, 0, not_negative(),
      "Prescribed flow: times of the knots, increasing, below the period; empty: the analytic waveform");
  schema.reals("circulation.flow_mL_per_s", {}, 0, unlimited(), "Prescribed flow: value at each knot");
  schema.real("circulation.end_diastolic_pressure_mmHg", 8, {-50, 300},
              "Pressure of the ventricle before contraction, for upstream = pressure or flow");
  schema.real("circulation.peak_pressure_mmHg", 120, {0, 400},
              "Prescribed pressure: peak of the analytic ventricular waveform");
  schema.real("circulation.systole_s", 0.35, positive(),
              "Prescribed pressure: duration of the analytic pulse");
  schema.reals("circulation.pressure_time_s", {}, 0, not_negative(),
               "Prescribed upstream pressure: times of the knots; empty: the analytic waveform");
  schema.reals("circulation.pressure_mmHg", {}, 0, unlimited(),
               "Prescribed upstream pressure: value at each knot");
}

void declare_pulse_duplicator(Schema& schema) {
  schema.real("circulation.adapter_resistance_mmHg_s_per_mL", 0.15, positive(),
              "Adapter, pump: resistance R_1, R_VIA of the impedance adapter (Lee et al. 2020)");
  schema.real(
      "circulation.adapter_outlet_resistance_mmHg_s_per_mL", 0.15, not_negative(),
      "Adapter: resistance R_2 between its compliance and the valve (Lee et al. 2020, porcine valve)");
  schema.real("circulation.adapter_compliance_mL_per_mmHg", 0.1, positive(),
              "Adapter: compliance (Lee et al. 2020, porcine valve)");
  schema.real("circulation.pump_compliance_mL_per_mmHg", 0.0275, positive(),
              "Pump: compliance C_1 on its side of the adapter (Lee et al. 2020, bovine pericardial valve)");
  schema.real("circulation.chamber_compliance_mL_per_mmHg", 0.0347, positive(),
              "Pump: compliance C_2 of the ventricle's chamber (the same)");
  schema.real("circulation.pump_outlet_resistance_mmHg_s_per_mL", 0.0898, not_negative(),
              "Pump: resistance R_out between chamber and valve (the same)");
  schema.reals("circulation.atrial_time_s", {}, 0, not_negative(),
               "Pump: times of the atrium's pressure; empty: it is constant");
  schema.reals(
      "circulation.atrial_pressure_mmHg", {8}, 0, unlimited(),
      "Pump: pressure of the atrium at each time; the mitral resistance stands between it and the chamber");
}

}  // namespace

void declare_circulation(Schema& schema) {
  schema.table("circulation", "What drives the valve (upstream) and what it works against (downstream)");
  schema.choice(
      "circulation.upstream", "heart", {"heart", "flow", "pressure", "adapter", "pump"},
      "Elastance model of the left heart; a prescribed flow or pressure; a pulse duplicator: the pump's "
      "pressure behind an impedance adapter, or the pump's flow with the atrium's pressure");
  schema.choice("circulation.downstream", "windkessel", {"windkessel", "resistance", "pressure"},
                "Three-element Windkessel, a resistance to a constant pressure, or a constant pressure");
  schema.real("circulation.period_s", 0.8512, {0.2, 3}, "Duration of a beat (Brown et al. 2022)");
  declare_heart(schema);
  declare_waveforms(schema);
  declare_pulse_duplicator(schema);
  schema.real("circulation.characteristic_resistance_mmHg_s_per_mL", 0.042, not_negative(),
              "Windkessel: R_c (Brown et al. 2022)");
  schema.real("circulation.peripheral_resistance_mmHg_s_per_mL", 0.9046, positive(),
              "Windkessel: R_p (Brown et al. 2022)");
  schema.real("circulation.compliance_mL_per_mmHg", 1.9504, positive(), "Windkessel: C (Brown et al. 2022)");
  schema.real("circulation.outlet_resistance_mmHg_s_per_mL", 0.0525, not_negative(),
              "Downstream resistance (70 dyn s/cm5, Johnson et al. 2022)");
  schema.real(
      "circulation.aortic_pressure_mmHg", 80, {-50, 300},
      "Pressure behind the downstream resistance, the constant downstream pressure, and the Windkessel's "
      "start where the upstream is not a heart");
}

}  // namespace valsalva
