// What cycle takes from the case file, in internal units.
#pragma once

#include <optional>

#include "circulation_case.hpp"
#include "core/case.hpp"
#include "coupling/immersed_flow.hpp"
#include "fluid/flow.hpp"
#include "materials/hgo.hpp"

namespace valsalva::cycle {

struct Tissue {
  materials::HgoParameters law;
  double bending_modulus_Pa = 0;
  double stiffness_factor = 1;
};

struct Masks {  // in cells
  double strut = 0.5, shell = 0.6, edge = 0.8;
};

struct Parameters {
  bool device = false;  ///< the leaflets are those of a device
  double h = 1;
  double margin_cells = 2;
  fluid::FlowParameters fluid;
  coupling::ImmersedFlowSettings coupling;
  coupling::Spacing spacing;
  Tissue tissue;
  Masks masks;
  CirculationParameters circulation;
  double initialisation_s = 0.03, end_s = 0;
  int beats = 1;
  double anchor_drag = 0;  ///< uN s/mm
  int history_interval = 10, frames_per_beat = 24;
};

Parameters read_parameters(const Case& scene);

}  // namespace valsalva::cycle
