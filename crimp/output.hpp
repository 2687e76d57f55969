// The stage's state and summary.
#pragma once

#include "core/stage.hpp"
#include "simulation.hpp"
#include "state/checkpoint.hpp"

namespace valsalva::crimp {

History make_history();
/// One row at the present time.
void record(History& history, const Simulation& s);
/// The largest ratio of kinetic to internal energy, of the rows in which internal energy has reached a
/// twentieth of its largest value: before that the device still hangs freely and the ratio says nothing.
double largest_energy_ratio(const History& history);

/// Everything that deploy and a bitwise continuation need.
state::State snapshot(const StageContext& context, const state::State& stent, const Simulation& s,
                      const History& history);
void restore(const state::State& from, Simulation& s, History& history);

void fill_summary(Summary& summary, const Simulation& s, const History& history, const Parameters& p);

}  // namespace valsalva::crimp
