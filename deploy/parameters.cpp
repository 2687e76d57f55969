#include "parameters.hpp"

#include <cmath>

#include "bodies/frame_law.hpp"
#include "core/units.hpp"

namespace valsalva::deploy {
namespace {

constexpr double native_density = 1.1e-3;  // g/mm3, soft tissue

Tissue tissue(const Case& scene, const std::string& table) {
  Tissue t;
  t.law = {scene.real(table + ".c10_kPa") * units::pa_per_kPa, scene.real(table + ".c01"),
           scene.real(table + ".k1_kPa") * units::pa_per_kPa, scene.real(table + ".k2")};
  t.bending_modulus_Pa = materials::Hgo(t.law).matrix_modulus_Pa();
  t.density = native_density;
  return t;
}

}  // namespace

Parameters read_parameters(const Case& scene) {
  Parameters p;
  p.depth_mm = scene.real("deploy.depth_mm");
  p.rotation_rad = scene.real("deploy.rotation_deg") * M_PI / 180;
  p.sheath = scene.text("deploy.release") == "sheath";
  p.sheath_speed = scene.real("deploy.sheath_speed_mm_per_s");
  p.sheath_clearance = scene.real("deploy.sheath_clearance_mm");
  p.open_pressure_Pa = scene.real("deploy.open_pressure_mmHg") * units::pa_per_mmHg;
  p.open_ramp_s = scene.real("deploy.open_ramp_ms") * 1e-3;
  p.open_hold_s = scene.real("deploy.open_hold_ms") * 1e-3;
  p.open_damping = scene.real("deploy.open_damping_per_s");
  p.expand_s = scene.real("deploy.expand_ms") * 1e-3;
  p.release_damping = scene.real("deploy.release_damping_per_s");
  p.settle_s = scene.real("deploy.settle_ms") * 1e-3;
  p.settle_damping = scene.real("deploy.settle_damping_per_s");
  p.hold_stiffness = scene.real("deploy.hold_stiffness_N_per_mm") * units::uN_per_N;
  p.step_s = scene.real("deploy.step_us") * 1e-6;
  p.friction = scene.real("deploy.wall_friction");
  p.wall_stiffness = scene.real("deploy.wall_stiffness_kPa_per_mm") * units::pa_per_kPa;
  p.tissue_wall_stiffness = scene.real("deploy.tissue_wall_stiffness_kPa_per_mm") * units::pa_per_kPa;
  p.law = scene.text("contact.law") == "penalty" ? contact::Law::penalty : contact::Law::barrier;
  p.candidates = {scene.real("contact.modulus_kPa") * units::pa_per_kPa, scene.real("contact.rest_factor"),
                  scene.real("contact.wide_skin_mm"), scene.real("contact.near_skin_mm")};
  p.thickness_fraction = scene.real("contact.tissue_compressed_thickness_fraction");
  p.native_self_distance = scene.real("deploy.native_self_distance_mm");
  p.tie_stiffness = scene.real("deploy.tie_stiffness_N_per_mm") * units::uN_per_N;
  p.penetration_tolerance = scene.real("deploy.penetration_tolerance_mm");
  p.apposition_gap = scene.real("deploy.apposition_gap_mm");
  p.wall_thickness = scene.real("mesh.wall_thickness_mm");
  p.device = tissue(scene, "device");
  p.device.bending_modulus_Pa = scene.real("device.bending_modulus_MPa") * units::pa_per_MPa;
  p.device.density = scene.real("device.tissue_density_g_per_mm3");
  p.native = tissue(scene, "native");
  p.stenosis_factor = scene.real("native.stenosis_factor");
  p.frame = bodies::frame_material(scene);
  return p;
}

}  // namespace valsalva::deploy
