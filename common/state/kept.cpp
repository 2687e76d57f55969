#include "state/kept.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace valsalva::state {

namespace fs = std::filesystem;

fs::path kept_path(const fs::path& folder, long index) {
  return folder / fmt::format("kept_{:06d}.h5", index);
}

std::map<long, fs::path> kept_states(const fs::path& folder) {
  std::map<long, fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    if (!stem.starts_with("kept_") || entry.path().extension() != ".h5") continue;
    const std::string digits = stem.substr(5);
    if (!digits.empty() &&
        std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); }))
      found[std::stol(digits)] = entry.path();
  }
  return found;
}

}  // namespace valsalva::state
