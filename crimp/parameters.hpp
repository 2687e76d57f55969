// What crimping needs from the case, in internal units (mm, g, s, Pa, uN).
#pragma once

#include "contact/candidates.hpp"
#include "contact/pressure_law.hpp"
#include "core/case.hpp"
#include "materials/hgo.hpp"
#include "structure/beam.hpp"

namespace valsalva::crimp {

struct Parameters {
  materials::HgoParameters tissue_law;
  double bending_modulus_Pa = 0;
  double tissue_density = 0;
  structure::BeamMaterial frame;

  double target_diameter_mm = 0;
  double speed_mm_per_s = 0, ramp_s = 0;
  double settle_s = 0, settled_ratio = 0;
  double step_s = 0;
  int scaling_interval = 1;
  double damping_per_s = 0, settle_damping_per_s = 0, tissue_damping_per_s = 0;
  double crimper_frame_Pa_per_mm = 0, crimper_tissue_Pa_per_mm = 0, crimper_friction = 0;
  double tie_uN_per_mm = 0;
  double asymmetry_mm = 0;
  int history_interval = 1;

  contact::Law law = contact::Law::barrier;
  contact::CandidateParameters candidates;
  double strut_modulus_Pa = 0;
  double thickness_fraction = 1;
};

Parameters read_parameters(const Case& scene);

}  // namespace valsalva::crimp
