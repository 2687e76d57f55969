// Geometric orifice area: the opening that one sees when looking along z through the leaflets.
//
// Leaflet triangles are projected along z onto pixels within a disc around the valve's axis; the orifice is
// the uncovered part of the disc that is connected with its inner third. Error about half a pixel times the
// orifice's perimeter.
#pragma once

#include "core/types.hpp"

namespace valsalva::metrics {

struct OrificeDisc {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< mm
  double radius_mm = 0;                              ///< > 0
  double pixel_mm = 0.2;                             ///< > 0
};

/// mm2.
double orifice_area(const Points& x, const std::vector<Triangle>& triangles, const OrificeDisc& disc);

/// The disc of a valve: centre and largest distance of the given (attached) nodes, seen along z.
OrificeDisc disc_of(const Points& attached, double pixel_mm);

}  // namespace valsalva::metrics
