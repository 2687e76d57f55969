// Signed distances of rigid shapes, mm, negative inside; exact, except where said. `x` is given in the
// shape's own frame: centre in the origin, axis along the third direction.
#pragma once

#include <vector>

#include "core/types.hpp"

namespace valsalva::flow_scene {

/// length 0: endless.
double distance_to_cylinder(const Vec3& x, double radius, double length);
double distance_to_box(const Vec3& x, const Vec3& half);
double distance_to_torus(const Vec3& x, double radius, double tube);
/// To first order near the surface.
double distance_to_ellipsoid(const Vec3& x, const Vec3& half);

/// A body of revolution: s and radius by turns, s ascending, equal s for a step. Between them cones. endless:
/// the first and last radius continue; otherwise flat ends.
class Revolution {
 public:
  Revolution(std::vector<double> s, std::vector<double> radius, bool endless);
  double distance(const Vec3& x) const;

 private:
  std::vector<double> s_, r_;
  bool endless_;
};

}  // namespace valsalva::flow_scene
