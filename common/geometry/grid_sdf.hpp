// A signed distance sampled on a dense regular grid: what contact and fluid walls evaluate millions of times.
// Negative inside the lumen, positive in the wall and beyond. Lengths in mm.
#pragma once

#include <array>

#include "core/types.hpp"

namespace valsalva::geometry {

struct GridSdf {
  std::array<int, 3> dimensions{};  ///< samples nx, ny, nz
  Vec3 origin = Vec3::Zero();       ///< position of sample (0, 0, 0)
  double spacing = 1;
  std::vector<float> values;  ///< x fastest

  /// Trilinear; outside the grid the nearest sample's value.
  double value(const Vec3& x) const;
  /// Gradient of the trilinear interpolant of central differences, not normalised.
  Vec3 gradient(const Vec3& x) const;
  float at(int i, int j, int k) const {
    return values[(static_cast<std::size_t>(k) * dimensions[1] + j) * dimensions[0] + i];
  }
};

/// Samples any function of position.
template <class Function>
GridSdf sample(const Vec3& low, const Vec3& high, double spacing, Function&& distance) {
  GridSdf grid;
  grid.origin = low;
  grid.spacing = spacing;
  for (int d = 0; d < 3; ++d) grid.dimensions[d] = static_cast<int>((high[d] - low[d]) / spacing + 1.5);
  grid.values.reserve(static_cast<std::size_t>(grid.dimensions[0]) * grid.dimensions[1] * grid.dimensions[2]);
  for (int k = 0; k < grid.dimensions[2]; ++k)
    for (int j = 0; j < grid.dimensions[1]; ++j)
      for (int i = 0; i < grid.dimensions[0]; ++i)
        grid.values.push_back(static_cast<float>(distance(Vec3(low + spacing * Vec3(i, j, k)))));
  return grid;
}

}  // namespace valsalva::geometry
