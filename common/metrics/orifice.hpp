// Geometric orifice area: the opening that one sees when looking along z through the leaflets.
//
// Leaflet triangles are projected along z onto pixels within the outline of the attached edge, seen along z;
// the orifice is the uncovered part of the outline that is connected with its inner third. Error about half a
// pixel times the orifice's perimeter.
#pragma once

#include <vector>

#include "core/types.hpp"

namespace valsalva::metrics {

struct OrificeOutline {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< mm
  std::vector<double> radius_mm;  ///< in sectors of equal angle from -pi on, each constant; all > 0
  double pixel_mm = 0.2;          ///< > 0
  double largest_radius() const;
  double radius_at(double x, double y) const;  ///< in the direction (x, y) from the centre
};

/// The outline of a valve's attached nodes; sectors without a node are interpolated.
OrificeOutline outline_of(const Points& attached, double pixel_mm);

/// mm2.
double orifice_area(const Points& x, const std::vector<Triangle>& triangles, const OrificeOutline& outline);

}  // namespace valsalva::metrics
