// C33 = 1/det C of the in-plane 2x2 C (incompressible), with its first two derivatives with respect to det C;
// below det C = 1e-4 (a stretch of 0.1 both ways) continued by its tangent: finite and still repelling.
#pragma once

#include <Eigen/Core>

#include "materials/lanes.hpp"

namespace valsalva::materials {

inline constexpr double determinant_floor = 1e-4;

struct ThicknessStretch {
  double value, first, second;
};

inline ThicknessStretch thickness_stretch(double det) {
  constexpr double f = determinant_floor;
  if (det < f) return {2 / f - det / (f * f), -1 / (f * f), 0};
  return {1 / det, -1 / (det * det), 2 / (det * det * det)};
}

struct ThicknessStretchLanes {
  Lanes value, first;
};

inline ThicknessStretchLanes thickness_stretch_lanes(const Lanes& det) {
  constexpr double f = determinant_floor;
  const Lanes inverse = det.max(f).inverse();
  return {if_above(det, f, inverse, 2 / f - det / (f * f)), -inverse * inverse};
}

/// Second derivative of det C = C11 C22 - C12 C21 in Voigt order 11, 22, 12.
inline Eigen::Matrix3d plane_determinant_hessian() {
  return (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -0.5).finished();
}

}  // namespace valsalva::materials
