#include "core/stage.hpp"

#include <chrono>
#include <csignal>
#include <iostream>
#include <new>

#include "core/command_line.hpp"
#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/provenance.hpp"

namespace valsalva {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t signal_arrived = 0;

extern "C" void remember_signal(int) {
  signal_arrived = 1;
}

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = remember_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

void print_help(const Stage& stage, const Schema& schema) {
  fmt::print(
      "valsalva-{}: {}\n\nUsage: valsalva-{} CASE.toml [options]\n\n{}\n\n{}\nCase-file tables this stage "
      "reads:\n\n",
      stage.name, stage.purpose, stage.name, stage.sample, options_help());
  for (const std::string& table : stage.tables) fmt::print("{}\n", schema.help_of(table));
}

void print_estimate(const Estimate& estimate) {
  fmt::print("predicted wall time: {:.0f} s\npredicted memory: {:.0f} MiB\naccuracy: {}\n", estimate.wall_s,
             estimate.memory_MiB, estimate.accuracy);
}

Summary new_summary(const Stage& stage, const Case& scene, MPI_Comm comm) {
  Summary summary;
  summary.stage = stage.name;
  summary.case_name = scene.name();
  summary.fidelity = name_of(scene.fidelity());
  summary.ranks = mpi::size(comm);
  summary.parameters_sha256 =
      sha256_of_text(name_of(scene.fidelity()) + "\n" + scene.effective(stage.tables));
  return summary;
}

/// Runs the stage and writes summary.json whatever happens; rethrows.
void run_and_summarise(const Stage& stage, StageContext& context) {
  const auto start = std::chrono::steady_clock::now();
  const auto write = [&](const std::string& status) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    context.summary.status = status;
    context.summary.wall_s += elapsed.count();  // a resumed stage has put the time spent before into wall_s
    if (mpi::rank(context.comm) == 0) context.run.write_summary(context.summary);
  };
  try {
    stage.run(context);
  } catch (const Error& error) {
    if (error.code() == ExitCode::numerical || error.code() == ExitCode::interrupted) {
      context.summary.notes["message"] = error.what();
      write(error.code() == ExitCode::numerical ? "failed" : "interrupted");
    }
    throw;
  }
  write("ok");
}

/// The folders on the way to a result that are not there yet. They are made before the stage starts, which
/// proves that results can be written, and taken away again when the input turns out to be bad.
class MissingFolders {
 public:
  explicit MissingFolders(const fs::path& folder) {
    std::error_code unreadable;
    for (fs::path p = fs::absolute(folder); !fs::exists(p, unreadable) && p.has_relative_path();
         p = p.parent_path())
      missing_.push_back(p);
  }
  void remove_empty() const {
    std::error_code not_empty;
    for (const fs::path& p : missing_) fs::remove(p, not_empty);
  }

 private:
  std::vector<fs::path> missing_;  // innermost first
};

void run_stage(const Stage& stage, const Schema& schema, const CommandLine& line, MPI_Comm comm) {
  const bool first = mpi::rank(comm) == 0;
  log::configure(line.quiet, first);

  // The level comes from the command line, else from the file, else standard.
  Case scene = Case::load(line.case_file, schema, line.fidelity.value_or(Fidelity::standard), line.overrides);
  const Fidelity wanted = line.fidelity.value_or(fidelity_from(scene.text("case.fidelity")));
  if (wanted != scene.fidelity()) scene = Case::load(line.case_file, schema, wanted, line.overrides);

  if (line.from && !fs::exists(*line.from))
    throw InputError("--from {}: no such file; give the state_NNNNNN.h5 of the stage before",
                     line.from->string());
  if (stage.check) stage.check(scene);
  if (line.digest) {
    if (first) fmt::print("{}\n", new_summary(stage, scene, comm).parameters_sha256);
    return;
  }
  if (line.check) {
    if (first) fmt::print("{}", scene.effective());
    return;
  }
  if (line.estimate) {
    if (first) print_estimate(stage.estimate(scene, mpi::size(comm)));
    return;
  }
  const fs::path folder = line.out.value_or(fs::path("runs") / scene.name() / stage.name);
  // The barriers: no rank makes a folder before the first has looked, none after the first has tidied up.
  const MissingFolders missing(folder);
  MPI_Barrier(comm);
  RunFolder run(folder);
  MPI_Barrier(comm);
  if (!line.resume) run.disregard_present_states();
  StageContext context{scene,       std::move(run), new_summary(stage, scene, comm),
                       line.from,   line.resume,    line.steps,
                       line.quiet,  comm,           first && !line.quiet,
                       stage.tables};
  try {
    run_and_summarise(stage, context);
  } catch (const InputError&) {
    if (first) missing.remove_empty();
    throw;
  }
}

/// What went wrong on this rank, as a code; printed once.
int report(const std::exception& error, ExitCode code) {
  log::configure(false, true);
  log::error(error.what());
  return static_cast<int>(code);
}

}  // namespace

bool interrupted() {
  return signal_arrived != 0;
}

std::filesystem::path StageContext::parent_state(const std::string& stage) {
  if (!from) return newest_state(run.path().parent_path(), stage);
  summary.inputs[from->string()] = sha256_of_path(*from);
  return *from;
}

std::filesystem::path StageContext::newest_state(const fs::path& folder, const std::string& stage) {
  std::vector<fs::path> found;
  if (fs::is_directory(folder / stage)) found = RunFolder(folder / stage).states();
  if (found.empty())
    throw InputError(
        "{}: no state of stage '{}' was found; run 'make {} CASE={}' first, or give it with --from",
        (folder / stage).string(), stage, stage, scene.file().string());
  summary.inputs[found.back().string()] = sha256_of_path(found.back());
  return found.back();
}

int stage_main(int argc, char** argv, const Stage& stage) {
  mpi::Session session(argc, argv);
  const MPI_Comm comm = MPI_COMM_WORLD;
  int code = 0;
  try {
    Schema schema;
    stage.declare(schema);
    const CommandLine line = parse_command_line(argc, argv);
    const bool first = mpi::rank(comm) == 0;
    if (line.help || line.reference || line.version) {
      if (first && line.help) print_help(stage, schema);
      if (first && line.reference) fmt::print("{}", schema.reference_page());
      if (first && line.version) fmt::print("valsalva {}\n", version());
      return 0;
    }
    catch_signals();
    run_stage(stage, schema, line, comm);
    return 0;
  } catch (const Error& error) {
    // Errors of the input and of the numerics are the same on all ranks; one voice is enough.
    code = mpi::rank(comm) == 0 ? report(error, error.code()) : static_cast<int>(error.code());
  } catch (const std::bad_alloc&) {
    code = report(EnvironmentError("out of memory; use a coarser fidelity or a larger machine"),
                  ExitCode::environment);
  } catch (const fs::filesystem_error& error) {
    code = report(error, ExitCode::environment);
  } catch (const std::exception& error) {
    code = report(error, ExitCode::numerical);
  }
  // An error that struck one rank alone would leave the others waiting for ever.
  if (mpi::size(comm) > 1) {
    std::fflush(nullptr);
    MPI_Abort(comm, code);
  }
  return code;
}

}  // namespace valsalva
