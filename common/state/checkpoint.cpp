#include "state/checkpoint.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

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
  for (const auto& [path, digest] : context.summary.inputs)
    state.parents.push_back(fmt::format("{} {}", path, digest));
  state.time_s = time_s;
  state.step = step;
  return state;
}

std::filesystem::path save(const StageContext& context, const State& state) {
  std::filesystem::path path = context.run.state_path(state.step);
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

namespace {

/// Keys of the stage's tables: value, of lines "key = value".
std::map<std::string, std::string> values_of(const std::string& text, const std::set<std::string>& tables) {
  std::map<std::string, std::string> values;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find(" = ");
    if (equals != std::string::npos && tables.count(line.substr(0, line.find_first_of(".["))))
      values[line.substr(0, equals)] = line.substr(equals + 3);
  }
  return values;
}

/// "key was a, is b" of all keys that differ but those that may.
std::vector<std::string> differences(const std::string& before, const std::string& now,
                                     const std::set<std::string>& tables,
                                     const std::set<std::string>& may_differ) {
  std::map<std::string, std::array<std::string, 2>> both;
  for (const auto& [key, value] : values_of(before, tables)) both[key][0] = value;
  for (const auto& [key, value] : values_of(now, tables)) both[key][1] = value;
  const auto said = [](const std::string& value) { return value.empty() ? std::string("absent") : value; };
  std::vector<std::string> found;
  for (const auto& [key, values] : both)
    if (values[0] != values[1] && !may_differ.count(key))
      found.push_back(fmt::format("{} was {}, is {}", key, said(values[0]), said(values[1])));
  return found;
}

}  // namespace

std::optional<State> resume(const StageContext& context, const std::set<std::string>& may_differ) {
  if (!context.resume) return std::nullopt;
  const auto newest = context.run.latest_state();
  if (!newest)
    throw InputError("--resume: {} holds no state to continue from; run without --resume",
                     context.run.path().string());
  State state = read(*newest, context.summary.stage);
  if (state.parameters_sha256 != context.summary.parameters_sha256) {
    const std::vector<std::string> found =
        differences(state.parameters, context.scene.effective(), context.tables, may_differ);
    const std::size_t shown = std::min<std::size_t>(found.size(), 5);
    const bool known = state.parameters.find(" = ") != std::string::npos;
    if (!found.empty() || !known)
      throw InputError(
          "--resume: {} was computed with other parameters{}{}{}; run without --resume, or restore them",
          newest->string(), found.empty() ? "" : ": ",
          fmt::join(found.begin(), found.begin() + static_cast<long>(shown), "; "),
          found.size() > shown ? fmt::format(" and {} more", found.size() - shown) : std::string());
  }
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
