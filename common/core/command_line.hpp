// The command line that all stages share.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/fidelity.hpp"

namespace valsalva {

struct CommandLine {
  std::filesystem::path case_file;
  std::vector<std::string> overrides;  ///< --set table.key=value
  std::optional<Fidelity> fidelity;
  std::optional<std::filesystem::path> out, from;
  bool help = false, reference = false, version = false;
  bool check = false, digest = false, estimate = false, resume = false, quiet = false;
  std::optional<long> steps;
};

/// InputError on an unknown option, a missing value, or no case file.
CommandLine parse_command_line(int argc, char** argv);

/// The options as --help shows them.
std::string options_help();

}  // namespace valsalva
