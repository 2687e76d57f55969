// The crown in space and unrolled into the leaflet's pattern, by dense sampling (see tissue.hpp).
#pragma once

#include "crown.hpp"
#include "plane_mesh.hpp"

namespace valsalva::stent {

class CrownPath {
 public:
  /// inset_mm: neighbouring leaflets stand this far apart at a commissure. e: the pattern's width parameter.
  CrownPath(const Crown& crown, const Profile& surface, double inset_mm, double e);

  /// Arc length from the left commissure (phi = -60 degrees), and its inverse.
  double arc(double phi) const;
  double phi_at_arc(double arc_mm) const;
  /// In the pattern: u from the middle, v from the nadir.
  Vec2 flat(double phi) const;
  double phi_at_u(double u) const;
  /// Where the crown is sewn, the leaflet's middle towards +x.
  Vec3 mounted(double phi) const;
  /// The angle at which it is sewn: a little less than phi, because of the inset.
  double mounted_angle(double phi) const { return phi * shrink_; }
  Vec2 end() const { return {u_.back(), v_.back()}; }

 private:
  double sampled(const std::vector<double>& values, double phi) const;
  static double inverse(const std::vector<double>& values, double wanted);
  Crown crown_;
  Profile surface_;
  double shrink_;
  std::vector<double> arc_, u_, v_;  ///< from phi = 0 to the commissure, evenly spaced
};

}  // namespace valsalva::stent
