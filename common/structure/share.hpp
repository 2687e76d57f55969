// What a rank has of things that are divided among ranks.
#pragma once

#include "structure/shell.hpp"

namespace valsalva::structure {

struct Range {
  int begin, end;
};

/// What `part` has of `count` things.
inline Range share(int count, Part part) {
  const auto at = [&](int index) { return static_cast<int>(static_cast<long>(count) * index / part.count); };
  return {at(part.index), at(part.index + 1)};
}

}  // namespace valsalva::structure
