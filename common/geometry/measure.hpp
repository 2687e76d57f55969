// Figures of a closed plane contour, as read in planning of transcatheter valves.
#pragma once

#include "geometry/planes.hpp"

namespace valsalva::geometry {

/// Shoelace formula; positive for a counter-clockwise loop. mm2.
double area(const Loop& loop);
double perimeter(const Loop& loop);
Vec2 centroid(const Loop& loop);

struct Caliper {
  double least_mm = 0;     ///< smallest distance of two parallel tangents
  double greatest_mm = 0;  ///< largest distance of two points
};
/// Widths in 180 directions, one degree apart: the greatest is short by at most 4e-5 of itself.
Caliper caliper(const Loop& loop);

struct SectionFigures {
  double area_mm2 = 0;
  double perimeter_mm = 0;
  double least_mm = 0, greatest_mm = 0;  ///< calipers
  Vec3 centre = Vec3::Zero();
  double area_diameter_mm() const;       ///< of the circle of equal area
  double perimeter_diameter_mm() const;  ///< of the circle of equal perimeter
};
SectionFigures figures(const Loop& loop, const Plane& plane);

/// Distance from `from` to the loop along each of `count` directions, from u towards v; the farthest
/// crossing.
std::vector<double> radii(const Loop& loop, const Vec2& from, int count);

}  // namespace valsalva::geometry
