#include "parameters.hpp"

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::cycle {

namespace {

using circulation::Waveform;
using units::pa_per_mmHg;

circulation::TwoHill chamber(const Case& scene, const std::string& name, double period_s, double shift) {
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

CirculationParameters circulation_of(const Case& scene) {
  CirculationParameters c;
  const std::string up = scene.text("circulation.upstream"), down = scene.text("circulation.downstream");
  c.upstream = up == "heart" ? Upstream::heart : up == "flow" ? Upstream::flow : Upstream::pressure;
  c.downstream = down == "windkessel"   ? Downstream::windkessel
                 : down == "resistance" ? Downstream::resistance
                                        : Downstream::pressure;
  const double period = c.period_s = scene.real("circulation.period_s");
  c.heart.period_s = period;
  c.heart.vein_flow =
      scene.real("circulation.vein_flow_L_per_min") * 1e3 * units::mm3_per_mL / units::s_per_min;
  c.heart.mitral_resistance = resistance(scene, "mitral_resistance");
  c.heart.outflow_resistance = resistance(scene, "lvot_resistance");
  c.heart.ventricle = chamber(scene, "lv", period, 0);
  c.heart.atrium = chamber(scene, "la", period, scene.real("circulation.la_shift_fraction"));
  c.windkessel = {resistance(scene, "characteristic_resistance"), resistance(scene, "peripheral_resistance"),
                  scene.real("circulation.compliance_mL_per_mmHg") * units::compliance_per_mL_per_mmHg};
  c.end_diastolic_Pa = scene.real("circulation.end_diastolic_pressure_mmHg") * pa_per_mmHg;
  c.aortic_Pa = scene.real("circulation.aortic_pressure_mmHg") * pa_per_mmHg;
  c.outlet_resistance = resistance(scene, "outlet_resistance");
  if (c.upstream == Upstream::flow)
    c.flow =
        scene.reals("circulation.flow_time_s").empty()
            ? circulation::systolic_flow(scene.real("circulation.stroke_volume_mL") * units::mm3_per_mL,
                                         scene.real("circulation.ejection_s"), period)
            : knots(scene, "circulation.flow_time_s", "circulation.flow_mL_per_s", units::mm3_per_mL, period);
  if (c.upstream == Upstream::pressure)
    c.pressure =
        scene.reals("circulation.pressure_time_s").empty()
            ? circulation::systolic_pressure(c.end_diastolic_Pa,
                                             scene.real("circulation.peak_pressure_mmHg") * pa_per_mmHg,
                                             scene.real("circulation.systole_s"), period)
            : knots(scene, "circulation.pressure_time_s", "circulation.pressure_mmHg", pa_per_mmHg, period);
  return c;
}

Tissue tissue_of(const Case& scene, const std::string& table) {
  Tissue t;
  t.law = {scene.real(table + ".c10_kPa") * units::pa_per_kPa, scene.real(table + ".c01"),
           scene.real(table + ".k1_kPa") * units::pa_per_kPa, scene.real(table + ".k2")};
  if (table == "device") {
    t.bending_modulus_Pa = scene.real("device.bending_modulus_MPa") * units::pa_per_MPa;
  } else {
    t.bending_modulus_Pa = materials::Hgo(t.law).matrix_modulus_Pa();
    t.stiffness_factor = scene.real("native.stenosis_factor");
  }
  return t;
}

}  // namespace

Parameters read_parameters(const Case& scene) {
  Parameters p;
  p.device = scene.has("device");
  p.h = scene.real("fluid.spacing_mm");
  p.margin_cells = scene.real("fluid.margin_cells");
  p.fluid.convection = fluid::convection_from(scene.text("fluid.convection"));
  p.fluid.penalisation_s = scene.real("fluid.penalisation_s");
  p.fluid.density = scene.real("fluid.density_g_per_mm3");
  p.fluid.viscosity = scene.real("fluid.viscosity_Pa_s");
  p.coupling.kernel = coupling::kernel_from(scene.text("cycle.kernel"));
  p.coupling.limits.safety = scene.real("cycle.step_safety");
  p.coupling.limits.largest_s = scene.real("cycle.max_step_s");
  p.coupling.limits.cfl = scene.real("cycle.max_cfl");
  p.coupling.probe_interval = static_cast<int>(scene.integer("cycle.probe_interval"));
  p.coupling.probe_iterations = static_cast<int>(scene.integer("cycle.probe_iterations"));
  p.spacing.repulsion = {scene.real("cycle.repulsion_kPa") * units::pa_per_kPa,
                         scene.real("cycle.repulsion_cells") * p.h};
  p.spacing.standoff_mm = scene.real("cycle.standoff_cells") * p.h;
  p.tissue = tissue_of(scene, p.device ? "device" : "native");
  p.masks = {scene.real("cycle.strut_mask_cells"), scene.real("cycle.shell_mask_cells"),
             scene.real("cycle.edge_mask_cells")};
  p.circulation = circulation_of(scene);
  p.initialisation_s = scene.real("cycle.initialisation_s");
  p.beats = static_cast<int>(scene.integer("cycle.beats"));
  const double duration = scene.real("cycle.duration_s");
  p.end_s = duration > 0 ? duration : p.initialisation_s + p.beats * p.circulation.period_s;
  p.anchor_drag = scene.real("cycle.anchor_drag_N_s_per_mm") * units::uN_per_N;
  p.history_interval = static_cast<int>(scene.integer("cycle.history_interval"));
  p.frames_per_beat = static_cast<int>(scene.integer("cycle.frames_per_beat"));
  return p;
}

}  // namespace valsalva::cycle
