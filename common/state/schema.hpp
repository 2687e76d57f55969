// The name and version of the state file format.
#pragma once

#include <cstdint>

namespace valsalva::state {

inline constexpr const char* schema_name = "valsalva-state";
inline constexpr std::int64_t schema_version = 1;

}  // namespace valsalva::state
