// What every stage's executable shares: command line, validation, exit codes, summary, interruption.
//
//   int main(int argc, char** argv) {
//     return valsalva::stage_main(argc, argv, {"crimp", "Closes the device into its sheath", "crimp
//     CASE.toml",
//                                             declare_all, {"device", "crimp", "contact"}, run, estimate});
//   }
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/case.hpp"
#include "core/mpi.hpp"
#include "core/run_folder.hpp"

namespace valsalva {

struct Estimate {
  double wall_s = 0;
  double memory_MiB = 0;
  std::string accuracy;  ///< the expected accuracy band in words and numbers, and where they come from
};

struct StageContext {
  const Case& scene;
  RunFolder run;
  Summary summary;                            ///< the stage fills metrics, checks, inputs, notes, extra
  std::optional<std::filesystem::path> from;  ///< --from
  bool resume = false;                        ///< --resume
  std::optional<long> steps;                  ///< --steps: stop after so many, with a state
  bool quiet = false;
  MPI_Comm comm = MPI_COMM_WORLD;
  bool speaks = true;            ///< rank 0 and not quiet
  std::set<std::string> tables;  ///< of the case file, on which this stage depends

  /// The parent's newest state: --from where given, else runs/<case>/<stage>/ beside this stage's own folder.
  /// Its digest is recorded in summary.inputs. InputError when there is none (it says which command makes
  /// it).
  std::filesystem::path parent_state(const std::string& stage);
  /// The newest state in folder/<stage>/, its digest recorded; InputError when there is none.
  std::filesystem::path newest_state(const std::filesystem::path& folder, const std::string& stage);
  /// sha256 of the parameters this stage depends on.
  std::string parameters_sha256() const { return summary.parameters_sha256; }
};

struct Stage {
  std::string name;
  std::string purpose;
  std::string sample;  ///< sample runs, printed by --help
  std::function<void(Schema&)> declare;
  std::set<std::string> tables;  ///< the tables it depends on, for the parameter digest
  std::function<void(StageContext&)> run;
  std::function<Estimate(const Case&, int ranks)> estimate;
  std::function<void(const Case&)> check;  ///< further validation before anything is written; may be empty
};

int stage_main(int argc, char** argv, const Stage& stage);

/// True once SIGINT or SIGTERM has arrived: write a checkpoint, then throw Interrupted.
bool interrupted();

}  // namespace valsalva
