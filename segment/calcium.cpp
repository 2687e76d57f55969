#include "calcium.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/level_set.hpp"

namespace valsalva::segment {
namespace {

constexpr double below_mm = 6, above_mm = 25, outside_mm = 2.5;

enum class Voxel : char { other, candidate, seen, calcium };

}  // namespace

std::optional<geometry::GridSdf> calcium_of(const geometry::GridSdf& brightness,
                                            const geometry::GridSdf& lumen, const CalciumOptions& options) {
  const std::ptrdiff_t row = brightness.dimensions[0], layer = row * brightness.dimensions[1];
  const std::ptrdiff_t count = std::ptrdiff_t(brightness.values.size());
  std::vector<Voxel> voxels(count, Voxel::other);
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const double z = brightness.origin.z() + double(n / layer) * brightness.spacing;
    if (z > -below_mm && z < above_mm && lumen.values[n] < outside_mm &&
        brightness.values[n] > options.threshold)
      voxels[n] = Voxel::candidate;
  }
  const double voxel_mm3 = std::pow(brightness.spacing, 3);
  bool any = false;
  for (std::ptrdiff_t start = 0; start < count; ++start) {
    if (voxels[start] != Voxel::candidate) continue;
    std::vector<std::ptrdiff_t> piece{start};
    voxels[start] = Voxel::seen;
    float brightest = 0;
    for (std::size_t next = 0; next < piece.size(); ++next) {
      const std::ptrdiff_t n = piece[next];
      brightest = std::max(brightest, brightness.values[n]);
      // Candidates lie well inside the box, so that a step never leaves a row or layer.
      for (const std::ptrdiff_t step : {std::ptrdiff_t(1), std::ptrdiff_t(-1), row, -row, layer, -layer}) {
        const std::ptrdiff_t m = n + step;
        if (m < 0 || m >= count || voxels[m] != Voxel::candidate) continue;
        voxels[m] = Voxel::seen;
        piece.push_back(m);
      }
    }
    if (double(piece.size()) * voxel_mm3 < options.least_mm3 || brightest >= options.metal_threshold)
      continue;
    any = true;
    for (const std::ptrdiff_t n : piece) voxels[n] = Voxel::calcium;
  }
  if (!any) return std::nullopt;
  // The edge lies where the brightness crosses the threshold: keep the slope on both sides of it.
  geometry::GridSdf field = brightness;
  const float slope = float(brightness.spacing / 100);
  for (std::ptrdiff_t n = 0; n < count; ++n) {
    const float below = float(options.threshold) - brightness.values[n];
    field.values[n] = slope * (voxels[n] == Voxel::calcium ? below : std::max(below, 1.0f));
  }
  return geometry::redistanced(field);
}

}  // namespace valsalva::segment
