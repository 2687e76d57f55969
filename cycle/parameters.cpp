#include "parameters.hpp"

#include <algorithm>

#include "core/errors.hpp"
#include "core/units.hpp"
#include "test_section.hpp"

namespace valsalva::cycle {

namespace {

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
  p.fluid.wall = fluid::wall_from(scene.text("fluid.wall"));
  p.fluid.wall_upwind = scene.text("fluid.wall_convection") == "upwind1";
  p.fluid.implicit_viscosity = scene.text("fluid.viscosity_scheme") == "implicit";
  if (scene.text("fluid.subgrid") == "vreman")
    p.fluid.extra_viscosity.vreman = scene.real("fluid.vreman_constant");
  if (scene.text("fluid.viscosity_model") == "carreau-yasuda") {
    p.fluid.extra_viscosity.carreau_yasuda = fluid::CarreauYasuda{
        scene.real("fluid.zero_shear_viscosity_Pa_s"), scene.real("fluid.carreau_time_s"),
        scene.real("fluid.carreau_exponent"), scene.real("fluid.carreau_transition")};
  }
  p.coupling.kernel = coupling::kernel_from(scene.text("cycle.kernel"));
  p.coupling.limits.safety = scene.real("cycle.step_safety");
  p.coupling.limits.largest_s = scene.real("cycle.max_step_s");
  if (const auto& law = p.fluid.extra_viscosity.carreau_yasuda) {
    const double viscous_limit = p.h * p.h * p.fluid.density / (12 * law->zero_shear);
    p.coupling.limits.largest_s = std::min(p.coupling.limits.largest_s, viscous_limit);
  }
  p.coupling.limits.cfl = scene.real("cycle.max_cfl");
  p.coupling.largest_stretch = scene.real("cycle.largest_stretch");
  p.coupling.probe_interval = static_cast<int>(scene.integer("cycle.probe_interval"));
  p.coupling.probe_iterations = static_cast<int>(scene.integer("cycle.probe_iterations"));
  p.spacing.repulsion = {scene.real("cycle.repulsion_kPa") * units::pa_per_kPa,
                         scene.real("cycle.repulsion_cells") * p.h};
  p.spacing.standoff_mm = scene.real("cycle.standoff_cells") * p.h;
  p.tissue = has_test_section(scene) ? tissue_in_test_section(scene)
                                     : tissue_of(scene, p.device ? "device" : "native");
  p.masks = {scene.real("cycle.strut_mask_cells"), scene.real("cycle.shell_mask_cells"),
             scene.real("cycle.edge_mask_cells")};
  p.circulation = read_circulation(scene);
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
