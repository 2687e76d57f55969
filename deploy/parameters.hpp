// What the case asks of a deployment, in internal units (mm, g, s, Pa, uN).
#pragma once

#include "contact/candidates.hpp"
#include "contact/pressure_law.hpp"
#include "core/case.hpp"
#include "materials/hgo.hpp"
#include "structure/beam.hpp"

namespace valsalva::deploy {

struct Tissue {
  materials::HgoParameters law;
  double bending_modulus_Pa = 0;
  double density = 0;  ///< g/mm3
};

struct Parameters {
  double depth_mm = 5, rotation_rad = 0;
  bool sheath = false;
  double sheath_speed = 0, sheath_clearance = 0;
  double open_pressure_Pa = 0, open_ramp_s = 0, open_hold_s = 0, open_damping = 0;
  double expand_s = 0, release_damping = 0, settle_s = 0, settle_damping = 0;
  double hold_stiffness = 0;
  double step_s = 1e-5;
  double friction = 0, wall_stiffness = 0, tissue_wall_stiffness = 0;
  double native_self_distance = 0.25;  ///< mm
  double tie_stiffness = 0;
  contact::Law law = contact::Law::barrier;
  contact::CandidateParameters candidates;
  double thickness_fraction = 1;  ///< of the device's tissue in contact, as it was crimped
  double penetration_tolerance = 0.2, apposition_gap = 0.5;
  double wall_thickness = 1;
  Tissue device, native;
  double stenosis_factor = 1;
  structure::BeamMaterial frame;
};

Parameters read_parameters(const Case& scene);

}  // namespace valsalva::deploy
