#include "parameters.hpp"

#include "bodies/frame_law.hpp"
#include "core/units.hpp"

namespace valsalva::crimp {

Parameters read_parameters(const Case& scene) {
  Parameters p;
  p.tissue_law = {scene.real("device.c10_kPa") * units::pa_per_kPa, scene.real("device.c01"),
                  scene.real("device.k1_kPa") * units::pa_per_kPa, scene.real("device.k2")};
  p.bending_modulus_Pa = scene.real("device.bending_modulus_MPa") * units::pa_per_MPa;
  p.tissue_density = scene.real("device.tissue_density_g_per_mm3");
  p.frame = bodies::frame_material(scene);
  p.target_diameter_mm = scene.real("crimp.diameter_mm");
  p.speed_mm_per_s = scene.real("crimp.speed_mm_per_s");
  p.ramp_s = 1e-3 * scene.real("crimp.ramp_ms");
  p.settle_s = 1e-3 * scene.real("crimp.settle_ms");
  p.settled_ratio = scene.real("crimp.settled_energy_ratio");
  p.step_s = 1e-6 * scene.real("crimp.step_us");
  p.scaling_interval = static_cast<int>(scene.integer("crimp.scaling_interval"));
  p.damping_per_s = scene.real("crimp.damping_per_s");
  p.settle_damping_per_s = scene.real("crimp.settle_damping_per_s");
  p.tissue_damping_per_s = scene.real("crimp.tissue_damping_per_s");
  p.crimper_frame_Pa_per_mm = scene.real("crimp.crimper_stiffness_kPa_per_mm") * units::pa_per_kPa;
  p.crimper_tissue_Pa_per_mm = scene.real("crimp.crimper_tissue_stiffness_kPa_per_mm") * units::pa_per_kPa;
  p.crimper_friction = scene.real("crimp.crimper_friction");
  p.tie_uN_per_mm = scene.real("crimp.tie_stiffness_N_per_mm") * units::uN_per_N;
  p.asymmetry_mm = scene.real("crimp.asymmetry_mm");
  p.history_interval = static_cast<int>(scene.integer("crimp.history_interval"));
  p.law = scene.text("contact.law") == "barrier" ? contact::Law::barrier : contact::Law::penalty;
  p.candidates = {scene.real("contact.modulus_kPa") * units::pa_per_kPa, scene.real("contact.rest_factor"),
                  scene.real("contact.wide_skin_mm"), scene.real("contact.near_skin_mm")};
  p.strut_modulus_Pa = scene.real("contact.strut_modulus_kPa") * units::pa_per_kPa;
  p.thickness_fraction = scene.real("contact.tissue_compressed_thickness_fraction");
  return p;
}

}  // namespace valsalva::crimp
