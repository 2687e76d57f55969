// Plane stress of an incompressible law: C33 = 1/det C of the in-plane 2x2 C, hence for W(I1, I4)
//   S = 2 W1 (1 - C^-1/det C) + sum_i 2 W4i a_i a_i,      D = 4 d2W/dC2.
// D is positive semi-definite where W1, W11, W4i, W44i >= 0 and W11 W44i >= W14i^2, because 1/det C is
// convex. Any other elastic law W(C) is reduced in the same way,
//   S_ab = S3_ab + S3_33 dC33/dC_ab   with S3 the stress in space at (C, C33),
// and its tangent by the chain rule. Below det C = 1e-4 see thickness_stretch.hpp.
// Compressible laws: SolidLaw in solid_law.hpp. All of them are PlaneLaws, and these two functions serve all.
#pragma once

#include "materials/elastic_law.hpp"
#include "materials/invariant_law.hpp"

namespace valsalva::materials {

inline PlaneStress plane_stress(const PlaneLaw& law, const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                double factor) {
  return law.plane_stress(c, fibres, factor);
}

inline PlaneTangent plane_tangent(const PlaneLaw& law, const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                  double factor) {
  return law.plane_tangent(c, fibres, factor);
}

}  // namespace valsalva::materials
