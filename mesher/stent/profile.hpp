// The radius of a surface of revolution along its axis.
//
// Shape-preserving cubic Hermite interpolation (Fritsch and Carlson 1980, SIAM J. Numer. Anal. 17:238, with
// the harmonic-mean slopes of Fritsch and Butland 1984): once continuously differentiable, no overshoot, a
// given smallest or largest value is attained exactly where it is given. Constant beyond both ends. Lengths
// mm.
#pragma once

#include <string>
#include <vector>

namespace valsalva::stent {

class Profile {
 public:
  Profile() = default;
  /// Heights strictly ascending, at least one point, all finite, radii positive; otherwise InputError with
  /// `what`.
  Profile(std::vector<double> heights_mm, std::vector<double> radii_mm, const std::string& what);

  double radius(double z_mm) const;
  double slope(double z_mm) const;
  const std::vector<double>& heights() const { return z_; }
  const std::vector<double>& radii() const { return r_; }
  /// The same profile, everywhere smaller by `inwards_mm`.
  Profile offset(double inwards_mm, const std::string& what) const;

 private:
  std::size_t interval(double z) const;
  std::vector<double> z_, r_, slope_;
};

}  // namespace valsalva::stent
