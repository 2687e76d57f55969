// The law of the device's frame: what the case's [device] table says of it, and what superelastic struts
// remember from one stage to the next. Restart entries, absent for elastic struts: "frame/martensite" and
// "frame/fibre_stress_Pa", one a fibre in the order of structure::FibreHistory, "frame/dissipated_nJ".
#pragma once

#include "core/case.hpp"
#include "state/state.hpp"
#include "structure/beam.hpp"

namespace valsalva::bodies {

/// device.frame_law and the keys that belong to it.
structure::BeamMaterial frame_material(const Case& scene);

void write_fibres(const structure::FibreHistory& history, state::State& to);

/// Rest for elastic struts. InputError when superelastic ones find no history, or one of another number.
structure::FibreHistory read_fibres(const state::State& from, const structure::BeamNetwork& network);

}  // namespace valsalva::bodies
