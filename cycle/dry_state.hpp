// A scene without fluid in a state file: bodies as meshes for viewing, the solver's arrays below "scene/".
#pragma once

#include "assembly/scene.hpp"
#include "state/state.hpp"

namespace valsalva::cycle {

/// Meshes at their present positions: point data reference, displacement, velocity (3); cell data stretch,
/// von_mises_kPa where the element has them.
void add_bodies(state::State& out, const assembly::Scene& scene);

void add_snapshot(state::State& out, const structure::Snapshot& snapshot);
structure::Snapshot snapshot_of(const state::State& state);

}  // namespace valsalva::cycle
