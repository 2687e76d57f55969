// Plane sections of a level set: closed contours by marching squares on a regular lattice in the plane.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "geometry/grid_sdf.hpp"

namespace valsalva::geometry {

using Vec2 = Eigen::Vector2d;

/// u, v, normal: right-handed, unit length.
struct Plane {
  Vec3 origin = Vec3::Zero();
  Vec3 u = Vec3::UnitX(), v = Vec3::UnitY(), normal = Vec3::UnitZ();
  /// u is the part of `towards` that lies in the plane (any other direction when that part vanishes).
  static Plane at(const Vec3& origin, const Vec3& normal, const Vec3& towards = Vec3::UnitX());
  Vec3 point(const Vec2& p) const { return origin + p.x() * u + p.y() * v; }
};

/// A closed polygon in plane coordinates, counter-clockwise around the inside; last point not repeated.
using Loop = std::vector<Vec2>;

/// The zero contours inside the square |u|, |v| <= half_width_mm around the plane's origin, lattice step
/// `step_mm`; what reaches the square's edge is closed along it. Second order in the step.
std::vector<Loop> section(const GridSdf& field, const Plane& plane, double half_width_mm, double step_mm);

/// The loop that encloses the plane's origin, else the one with the nearest centroid; empty when there is
/// none.
Loop loop_at_origin(const std::vector<Loop>& loops);

bool encloses(const Loop& loop, const Vec2& point);

/// Signed distance to the loop, negative inside.
double distance_to(const Loop& loop, const Vec2& point);

}  // namespace valsalva::geometry
