// Library of devices: self-expanding supra-annular frames in four sizes, and a plain cylinder for tests.
//
// The numbers are secondary figures of published descriptions, not a maker's drawing: every one of them is
// assumed, each with its reason in library.cpp and in docs/stent.md. A real frame enters as a graph file.
#pragma once

#include <array>
#include <string>

#include "frame.hpp"

namespace valsalva::stent {

struct Device {
  std::string name;
  double nominal_size_mm = 0;
  FrameDesign frame;
  double nadir_mm = 0;       ///< lowest point of the leaflets' attachment above the inflow
  double commissure_mm = 0;  ///< top of the attachment: a row of crossings
};

inline constexpr std::array<double, 4> library_sizes_mm{23, 26, 29, 34};

/// InputError names the sizes that exist.
Device supra_annular(double size_mm);

/// Constant outer diameter; 12 cells, 5 rows of crossings 5 mm apart.
Device cylinder(double diameter_mm);

}  // namespace valsalva::stent
