#include "state/checkpoint.hpp"

#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/provenance.hpp"
#include "state/kept.hpp"

namespace valsalva::state {

State begin(const StageContext& context, double time_s, std::int64_t step) {
  State state;
  state.stage = context.summary.stage;
  state.case_name = context.scene.name();
  state.version = version();
  state.parameters = context.scene.effective();
  state.parameters_sha256 = context.summary.parameters_sha256;
  for (const auto& [path, digest] : context.summary.inputs) state.parents.push_back(path + " " + digest);
  state.time_s = time_s;
  state.step = step;
  return state;
}

std::filesystem::path save(const StageContext& context, const State& state) {
  const std::filesystem::path path = context.run.state_path(state.step);
  if (mpi::rank(context.comm) == 0) {
    write(path, state);
    context.run.prune();
    write_views(context.run.path(), path);
  }
  MPI_Barrier(context.comm);
  return path;
}

void keep(const StageContext& context, const State& state) {
  // First the name that stays: whoever continues from this state need not ask whether it was kept.
  if (mpi::rank(context.comm) == 0) write(kept_path(context.run.path(), state.step), state);
  save(context, state);
}

void drop_kept(const StageContext& context) {
  if (mpi::rank(context.comm) == 0)
    for (const auto& [index, path] : kept_states(context.run.path())) std::filesystem::remove(path);
  MPI_Barrier(context.comm);
}

void stop(const StageContext& context, const State& state) {
  const std::filesystem::path path = save(context, state);
  throw Interrupted("interrupted at step {}; the checkpoint is {}; continue with --resume", state.step,
                    path.string());
}

std::optional<State> resume(const StageContext& context) {
  if (!context.resume) return std::nullopt;
  const auto newest = context.run.latest_state();
  if (!newest)
    throw InputError("--resume: {} holds no state to continue from; run without --resume",
                     context.run.path().string());
  State state = read(*newest, context.summary.stage);
  if (state.parameters_sha256 != context.summary.parameters_sha256)
    throw InputError("--resume: {} was computed with other parameters; run without --resume, or restore them",
                     newest->string());
  log::info("continuing from {} (step {}, time {:.6g} s)", newest->string(), state.step, state.time_s);
  return state;
}

CheckpointClock::CheckpointClock(const StageContext& context)
    : last_(std::chrono::steady_clock::now()), seconds_(context.scene.real("output.checkpoint_s")) {}

bool CheckpointClock::due(MPI_Comm comm) {
  const auto now = std::chrono::steady_clock::now();
  int answer = std::chrono::duration<double>(now - last_).count() >= seconds_ ? 1 : 0;
  if (mpi::size(comm) > 1) MPI_Bcast(&answer, 1, MPI_INT, 0, comm);
  if (answer) last_ = now;
  return answer != 0;
}

}  // namespace valsalva::state
