// The state of a deployment: a checkpoint while it runs, and in the end what `cycle` starts from.
#pragma once

#include "core/run_folder.hpp"
#include "core/stage.hpp"
#include "measures.hpp"

namespace valsalva::deploy {

enum class Act { opening = 0, expansion = 1 };

/// native_now: during the first act the device is not part of the simulation, and the state shows it as
/// placed.
state::State snapshot(const StageContext& context, const Simulation& s, const Inputs& in, Act act, long step,
                      const History& history, double largest_ratio);

void add_results(state::State& state, const Measures& m, const Placement& placement);

struct Restored {
  Act act;
  long step;
  double largest_ratio;
  structure::Snapshot snapshot;
};
Restored restored_from(const state::State& state, History& history);

}  // namespace valsalva::deploy
