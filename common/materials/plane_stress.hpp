// Plane stress of an incompressible law: C33 = 1/det C of the in-plane 2x2 C, hence I1 = tr C + 1/det C and
//   S = 2 W1 (1 - C^-1/det C) + sum_i 2 W4i a_i a_i,      D = 4 d2W/dC2.
// D is positive semi-definite where W1, W11, W4i, W44i >= 0 and W14i = 0, because 1/det C is convex.
// Below det C = 1e-4 (a stretch of 0.1 both ways) 1/det C is continued by its tangent: finite and still
// repelling.
#pragma once

#include <Eigen/Core>

#include "materials/invariant_law.hpp"

namespace valsalva::materials {

/// Unit fibre directions in the element's basis; count 0 to 2.
struct PlaneFibres {
  int count = 0;
  std::array<Eigen::Vector2d, 2> direction{Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)};
};

struct PlaneStress {
  double energy = 0;       ///< W per reference volume, Pa
  Eigen::Matrix2d stress;  ///< second Piola-Kirchhoff, Pa
  double exponent = 0;
};

struct PlaneTangent {
  PlaneStress at;
  Eigen::Matrix3d tangent;  ///< dS/dE in Voigt order 11, 22, 12 with engineering shear 2 E12
};

PlaneStress plane_stress(const InvariantLaw& law, const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                         double factor);
PlaneTangent plane_tangent(const InvariantLaw& law, const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                           double factor);

}  // namespace valsalva::materials
