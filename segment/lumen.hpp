// From an image to the level set of the blood-filled root, in the annulus frame.
//
// Lumen: brighter than a threshold half way between blood and soft tissue (the place of a sharp edge in a
// blurred image), connected to the seeds, below the annulus within a channel around its contour (this parts
// it from the ventricle and the left atrium), leaflets and gaps narrower than twice the closing radius
// filled, side vessels and leaks narrower than twice the opening radius removed, smoothed by mean curvature
// flow at constant volume, then cut and continued straight beyond both cuts: an open-ended vessel.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "frame.hpp"
#include "geometry/grid_sdf.hpp"
#include "image.hpp"

namespace valsalva::segment {

struct LumenOptions {
  double spacing_mm = 0.5;
  double lower_cut_mm = 15, upper_cut_mm = 45;  ///< below, above the annulus
  double half_width_mm = 50;                    ///< of the working box
  double channel_margin_mm = 2.5;               ///< of the outflow tract beyond the annulus contour
  double closing_mm = 3, opening_mm = 2.5;      ///< radii
  double smoothing_mm = 1;
  int denoise_steps = 4;
  std::optional<double> lumen_threshold;  ///< in the image's values; absent: from the statistics
  std::optional<double> calcium_threshold;
  double metal_threshold = 2000;  ///< bright pieces that reach it are metal, not calcium
  double min_calcium_mm3 = 3;
};

struct Statistics {
  double blood = 0, noise = 0, tissue = 0;  ///< median and robust deviation near the seeds; soft tissue
  double lumen_threshold = 0, calcium_threshold = 0;
};

struct Lumen {
  Frame frame;
  geometry::GridSdf distance;                ///< open-ended, in the annulus frame
  std::optional<geometry::GridSdf> calcium;  ///< same grid; absent: none found
  double z_lower_mm = 0, z_upper_mm = 0;     ///< the cuts
  double smoothing_volume_change_pct = 0;
  double wall_strictness =
      0;  ///< where walls were looked for: 0 at the lumen's edge, 1 at the brightness of blood
  Statistics statistics;  ///< zero where no image values were used
  std::string cut_note;   ///< why the upper cut is lower than asked for; empty when it is not
};

/// Statistics near the seeds (LPS; upstream and downstream of the valve). InputError when a seed lies outside
/// the image or in no contrast, with what was found there.
Statistics statistics_of(const Image& image, const std::vector<Vec3>& seeds, const LumenOptions& options);

/// Contrast CT. seeds as above; frame: the annulus plane.
Lumen lumen_of_contrast(const Image& image, const Frame& frame, const std::vector<Vec3>& seeds,
                        const LumenOptions& options);

/// Label map: the inside is any of `labels`.
Lumen lumen_of_labels(const Image& image, const Frame& frame, const std::vector<double>& labels,
                      const LumenOptions& options);

/// A distance field of any origin (closed surface): only cut, continued and smoothed. `inside` is negative
/// inside, in scanner coordinates.
Lumen lumen_of_field(const std::function<double(const Vec3&)>& inside, const Frame& frame,
                     const LumenOptions& options);

}  // namespace valsalva::segment
