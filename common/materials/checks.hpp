// The check that every law makes of its parameters.
#pragma once

#include <cmath>

#include "core/errors.hpp"

namespace valsalva::materials {

/// InputError naming law, parameter, what was found and what is expected.
inline void require(bool holds, const char* law, const char* parameter, double found, const char* expected) {
  if (!(holds && std::isfinite(found)))
    throw InputError("material {}: {} = {}; expected {}", law, parameter, found, expected);
}

inline void require_positive(const char* law, const char* parameter, double found) {
  require(found > 0, law, parameter, found, "a positive number");
}

inline void require_not_negative(const char* law, const char* parameter, double found) {
  require(found >= 0, law, parameter, found, "a number that is not negative");
}

}  // namespace valsalva::materials
