// How every stage writes, keeps and continues its states.
//
//   auto resumed = state::resume(context);                 // with --resume
//   state::CheckpointClock clock(context);
//   while (...) {
//     step();
//     if (of lasting interest) state::keep(context, snapshot());
//     if (clock.due(context.comm)) state::save(context, snapshot());
//     if (interrupted()) state::stop(context, snapshot()); // writes, throws Interrupted
//   }
//   State last = snapshot(); last.final = true; state::save(context, last);
#pragma once

#include <chrono>
#include <optional>

#include "core/stage.hpp"
#include "state/state.hpp"

namespace valsalva::state {

/// A state whose header (stage, case, parameters, digests, parents) is filled from the stage's context.
State begin(const StageContext& context, double time_s, std::int64_t step);

/// Writes state_<step>.h5 on rank 0, removes all but the last two, refreshes the views. Collective.
std::filesystem::path save(const StageContext& context, const State& state);

/// save, and the state stays when later ones come: it is kept_<step>.h5 too, and in the series of views.
/// Collective.
void keep(const StageContext& context, const State& state);

/// Removes what an earlier run in this folder has kept. Collective.
void drop_kept(const StageContext& context);

/// save, then Interrupted that names the file and the command to continue. Collective.
[[noreturn]] void stop(const StageContext& context, const State& state);

/// With --resume: the stage's own newest state. InputError when there is none, or when it was computed with
/// other values of parameters than those of `may_differ`, which it names. Without --resume: nothing.
std::optional<State> resume(const StageContext& context, const std::set<std::string>& may_differ = {});

/// Says when a checkpoint is due by wall clock; rank 0 decides for all. What is computed does not depend on
/// it.
class CheckpointClock {
 public:
  /// The interval is the case's output.checkpoint_s.
  explicit CheckpointClock(const StageContext& context);
  bool due(MPI_Comm comm);

 private:
  std::chrono::steady_clock::time_point last_;
  double seconds_;
};

}  // namespace valsalva::state
