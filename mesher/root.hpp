// The aortic root as the leaflets see it: a straight axis, and the distance from it to the wall in any
// direction.
//
// The axis is the straight line fitted to the centroids of the lumen's sections between annulus and
// commissures, so that a point has coordinates (angle, radius, z) and meridional half-planes are planes.
#pragma once

#include "geometry/grid_sdf.hpp"

namespace valsalva::mesher {

class Root {
 public:
  /// Fits the axis between two heights. InputError when a section of the lumen is missing there.
  Root(const geometry::GridSdf& lumen, double low_z_mm, double high_z_mm);

  Vec3 position(double angle_rad, double radius_mm, double z_mm) const;
  /// Angle about the axis, at the same z.
  double angle_of(const Vec3& x) const;
  /// Distance from the axis, at the same z.
  double radius_of(const Vec3& x) const { return (x - base_ - x.z() * slope_).norm(); }
  /// First wall along the ray from the axis. InputError when there is none within 60 mm.
  double wall_radius(double angle_rad, double z_mm) const;

 private:
  const geometry::GridSdf& lumen_;
  Vec3 base_ = Vec3::Zero();    ///< the axis at z = 0
  Vec3 slope_ = Vec3::UnitZ();  ///< its advance for one mm of z
};

}  // namespace valsalva::mesher
