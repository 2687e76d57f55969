// A picture of the contours over the slices: four panels, left to right and top to bottom: section through
// the annulus plane, section through the sinuses (both seen from downstream, x right, y up), and the two
// longitudinal sections x-z and y-z (downstream up). Lumen red, outer wall orange, calcium yellow, annulus
// and cuts blue.
#pragma once

#include <filesystem>
#include <functional>

#include "lumen.hpp"

namespace valsalva::segment {

struct PictureOptions {
  double z_sinus_mm = 12;
  double wall_mm = 1;
  double half_width_mm = 40;
  double pixels_per_mm = 6;
  double window_low = -150, window_high = 750;  ///< image values shown as black, white
};

/// brightness: image value at a position of the annulus frame. EnvironmentError when it cannot be written.
void write_contours(const std::filesystem::path& png, const Lumen& lumen,
                    const std::function<double(const Vec3&)>& brightness, const PictureOptions& options);

}  // namespace valsalva::segment
