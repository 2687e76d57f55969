// Calcium of leaflets and annulus by threshold: pieces brighter than the blood, at most 2.5 mm outside the
// lumen, between 6 mm below and 25 mm above the annulus. Pieces that reach the metal threshold are metal;
// pieces below the least volume are noise.
#pragma once

#include <optional>

#include "geometry/grid_sdf.hpp"

namespace valsalva::segment {

struct CalciumOptions {
  double threshold = 0, metal_threshold = 2000;
  double least_mm3 = 3;
};

/// brightness: image values on the lumen's grid. The result is a signed distance, negative inside calcium;
/// absent when there is none.
std::optional<geometry::GridSdf> calcium_of(const geometry::GridSdf& brightness,
                                            const geometry::GridSdf& lumen, const CalciumOptions& options);

}  // namespace valsalva::segment
