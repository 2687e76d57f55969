// How parameter values and ranges are written: in --check, in the reference page, and in what is digested.
#pragma once

#include <string>

#include "core/schema.hpp"

namespace valsalva {

/// TOML notation; numbers in the shortest form that reads back to the same bits.
std::string text_of(const Value& value);
/// " in [0, 5]", " > 0", or nothing for an unlimited range.
std::string text_of(const Range& range);
/// Is the number finite and inside the range?
bool contains(const Range& range, double number);

}  // namespace valsalva
