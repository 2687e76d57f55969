// What the run says in the end: figures of the last beat, checks, notes; and the state that it leaves.
#pragma once

#include "core/stage.hpp"
#include "simulation.hpp"

namespace valsalva::cycle {

/// The state of the moment: restart entries, moving and held bodies; with the fluid's fields for views where
/// `final`. Collective.
state::State state_of(const StageContext& context, const Inputs& in, const Simulation& simulation,
                      bool final);

/// Metrics, checks and notes of a finished run.
void summarise(Summary& summary, const Inputs& in, const Parameters& p, const Simulation& simulation);

}  // namespace valsalva::cycle
