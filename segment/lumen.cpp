#include "lumen.hpp"

#include <algorithm>
#include <cmath>

#include "calcium.hpp"
#include "core/errors.hpp"
#include "core/log.hpp"
#include "geometry/level_set.hpp"
#include "lumen_field.hpp"
#include "vessel.hpp"

namespace valsalva::segment {
namespace {

using geometry::GridSdf;

constexpr double margin_mm = 8;  // real data beyond the cuts, for the morphology
constexpr double kept_mm = 6;    // of which so much stays in the result, on every side

/// Keeps what a fluid box and a wall need around the lumen.
void trim(Lumen& lumen) {
  const GridSdf& field = lumen.distance;
  const auto [nx, ny, nz] = field.dimensions;
  std::array<int, 3> low{nx, ny, 0}, high{0, 0, nz - 1};
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        if (field.at(i, j, k) < kept_mm) {
          low = {std::min(low[0], i), std::min(low[1], j), 0};
          high = {std::max(high[0], i), std::max(high[1], j), nz - 1};
        }
  low[2] = std::max(0, int((lumen.z_lower_mm - kept_mm - field.origin.z()) / field.spacing));
  high[2] = std::min(nz - 1, int(std::ceil((lumen.z_upper_mm + kept_mm - field.origin.z()) / field.spacing)));
  lumen.distance = geometry::cropped(field, low, high);
}

}  // namespace

Lumen lumen_of_contrast(const Image& image, const Frame& frame, const std::vector<Vec3>& seeds,
                        const LumenOptions& options) {
  Image part = cropped(image, frame.origin,
                       1.5 * std::max(options.half_width_mm, options.upper_cut_mm + vessel_ends_mm));
  const Statistics found = statistics_of(part, seeds, options);
  log::info("blood {:.0f} HU, noise {:.0f}, soft tissue {:.0f}; lumen above {:.0f}, calcium above {:.0f}",
            found.blood, found.noise, found.tissue, found.lumen_threshold, found.calcium_threshold);
  for (float& value : part.values) value = std::min(value, float(options.metal_threshold));
  denoise(part, std::max(2.5 * found.noise, 1.0), options.denoise_steps);

  GridSdf field = working_grid(options, [&](const Vec3& x) { return part.sample(frame.to_scanner(x)); });
  // Calcium and metal cannot pull the edge: what is brighter than blood counts as blood.
  const double contrast = found.blood - found.lumen_threshold;
  for (float& value : field.values)
    value = float(options.spacing_mm * std::clamp((found.lumen_threshold - value) / contrast, -1.0, 1.0));
  const double low = -options.lower_cut_mm - margin_mm, high = options.upper_cut_mm + margin_mm;
  continue_straight(field, low, high);
  Lumen lumen = vessel_of(std::move(field), frame, seeds, options, found);
  trim(lumen);
  GridSdf brightness = lumen.distance;
  std::size_t n = 0;
  for (int k = 0; k < brightness.dimensions[2]; ++k)
    for (int j = 0; j < brightness.dimensions[1]; ++j)
      for (int i = 0; i < brightness.dimensions[0]; ++i)
        brightness.values[n++] =
            float(part.sample(frame.to_scanner(brightness.origin + brightness.spacing * Vec3(i, j, k))));
  lumen.calcium = calcium_of(brightness, lumen.distance,
                             {found.calcium_threshold, options.metal_threshold, options.min_calcium_mm3});
  return lumen;
}

Lumen lumen_of_labels(const Image& image, const Frame& frame, const std::vector<double>& labels,
                      const LumenOptions& options) {
  Image part = cropped(image, frame.origin,
                       1.5 * std::max(options.half_width_mm, options.upper_cut_mm + vessel_ends_mm));
  bool any = false;
  for (float& value : part.values) {
    const bool inside = std::find(labels.begin(), labels.end(), double(value)) != labels.end();
    any |= inside;
    value = inside ? 1 : 0;
  }
  if (!any)
    throw InputError(
        "segmentation is empty: none of anatomy.labels occurs near the annulus {}; correct the labels or "
        "the annulus plane",
        text_of(frame.origin));
  GridSdf field = working_grid(options, [&](const Vec3& x) {
    return options.spacing_mm * (1 - 2 * part.sample(frame.to_scanner(x)));
  });
  continue_straight(field, -options.lower_cut_mm - margin_mm, options.upper_cut_mm + margin_mm);
  Lumen lumen = vessel_of(std::move(field), frame, {}, options, {});
  trim(lumen);
  return lumen;
}

Lumen lumen_of_field(const std::function<double(const Vec3&)>& inside, const Frame& frame,
                     const LumenOptions& options) {
  GridSdf field = working_grid(options, [&](const Vec3& x) { return inside(frame.to_scanner(x)); });
  Lumen lumen = vessel_of(std::move(field), frame, {}, options, {});
  trim(lumen);
  return lumen;
}

}  // namespace valsalva::segment
