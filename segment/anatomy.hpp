// From a case's [anatomy] table to the lumen: reads the input, finds the annulus plane, calls the
// segmentation.
#pragma once

#include <functional>

#include "core/case.hpp"
#include "lumen.hpp"

namespace valsalva::segment {

/// What can be said before anything is read. InputError names the key.
void check_anatomy(const Case& scene);

struct Anatomy {
  Lumen lumen;
  std::function<double(const Vec3&)> brightness;  ///< image value at a position of the annulus frame
  double window_low = -150, window_high = 750;    ///< for pictures
  std::string plane_note;                         ///< where the annulus plane comes from
};

/// input: the image or surface file (for a phantom: the file made from it). The origin of the lumen's frame
/// is the centroid of its section by the annulus plane.
Anatomy anatomy_of(const Case& scene, const std::filesystem::path& input);

}  // namespace valsalva::segment
