// A box as a closed surface, in the text of an .obj file.
#pragma once

#include <fmt/format.h>

#include <string>

#include "core/types.hpp"

namespace valsalva::test {

inline std::string box_obj(const Vec3& low, const Vec3& high) {
  std::string text;
  for (double z : {low.z(), high.z()})
    for (const auto& [x, y] :
         {std::pair{low.x(), low.y()}, {high.x(), low.y()}, {high.x(), high.y()}, {low.x(), high.y()}})
      text += fmt::format("v {} {} {}\n", x, y, z);
  return text + "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
}

}  // namespace valsalva::test
