// The states that stay in a run folder beside the last two: kept_NNNNNN.h5.
#pragma once

#include <filesystem>
#include <map>

namespace valsalva::state {

std::filesystem::path kept_path(const std::filesystem::path& folder, long index);

/// All of a folder, by index.
std::map<long, std::filesystem::path> kept_states(const std::filesystem::path& folder);

}  // namespace valsalva::state
