// Landmarks and measurements of the root from its level set, as planning of a transcatheter valve reads them.
#pragma once

#include <array>

#include "geometry/centreline.hpp"

namespace valsalva::segment {

struct Root {
  geometry::SectionFigures annulus, lvot, sinus, junction;
  double z_lvot_mm = 0, z_sinus_mm = 0, z_junction_mm = 0;
  std::array<double, 3> commissure_angles{};  ///< rad, ascending, in the annulus plane from x towards y
  double lobe_mm = 0;                         ///< amplitude of the three-lobed part of the sinus radius
  std::vector<geometry::CentrelinePoint> centreline;  ///< from the lower to the upper cut
};

/// annulus: section by z = 0. lvot: normal to the axis, lvot_below_mm below. sinus: widest normal section (by
/// area) of the centreline up to 1.2 annulus diameters above the annulus. junction: the narrowest after it,
/// within one annulus diameter. Commissures: least radii of the sinus section, one near each minimum of its
/// third harmonic. InputError when the level set has no such sections.
Root measure_root(const geometry::GridSdf& lumen, double z_lower_mm, double z_upper_mm, double lvot_below_mm);

struct DeviceSize {
  double nominal_mm = 0;
  bool in_range = false;
};
/// Self-expanding supra-annular frames, annulus perimeter (mm): 23: 56.5-62.8; 26: 62.8-72.3; 29: 72.3-81.7;
/// 34: 81.7-94.2. Outside of all: the nearest, and in_range is false.
DeviceSize recommended_device(double annulus_perimeter_mm);

}  // namespace valsalva::segment
