// What every hyperelastic law is: a strain energy W(C, fibres) per reference volume, its second
// Piola-Kirchhoff stress and its consistent tangent,
//   S = 2 dW/dC,   D = dS/dE = 4 d2W/dC2,   C = F^T F = 1 + 2 E.
// Voigt order 11, 22, 33, 12, 23, 13; strains with engineering shear (2 E12 ...), so that dS = D dE.
// Being functions of C, all laws are frame indifferent. Pa.
//
// Three families implement it; a new law is a small file pair with its own derivatives only:
//   InvariantLaw (invariant_law.hpp)   W(I1, I2, I4_1, I4_2)
//   Ogden (ogden.hpp)                  W(principal stretches)
//   Fung, StVenantKirchhoff            W(E)
//
// What volume change costs is not part of it:
//   incompressible thin bodies   the law itself as a PlaneLaw, C33 = 1/det C          (plane_stress.hpp)
//   solids, compressible shells  SolidLaw = law + volumetric term                      (solid_law.hpp)
//
// `factor` multiplies the isotropic matrix part only (a stenotic leaflet has C10 x 1000).
// `exponent` is the largest argument Q of an exponential at this state, 0 for laws without one; beyond 6 the
// exponential is continued by capped_exponential.hpp, and a sound run says so.
#pragma once

#include "core/types.hpp"
#include "materials/plane_law.hpp"

namespace valsalva::materials {

using Voigt6 = Eigen::Matrix<double, 6, 1>;
using Tangent6 = Eigen::Matrix<double, 6, 6>;

/// Unit fibre directions in the reference, in the basis of C; count 0 to 2.
struct Fibres {
  int count = 0;
  std::array<Vec3, 2> direction{Vec3(1, 0, 0), Vec3(0, 1, 0)};
};

enum class Derivatives { stress, tangent };

struct ElasticResponse {
  Tangent6 tangent = Tangent6::Zero();  ///< dS/dE, Pa; zero when not asked for
  double energy = 0;                    ///< W, Pa
  double exponent = 0;                  ///< the largest argument of an exponential
  Mat3 stress = Mat3::Zero();           ///< S, Pa
};

class ElasticLaw : public PlaneLaw {
 public:
  /// W and its derivatives at any symmetric positive definite C, compressible or not.
  virtual ElasticResponse respond(const Mat3& c, const Fibres& fibres, double factor,
                                  Derivatives wanted) const = 0;
  /// Plane stress of the incompressible solid: C33 = 1/det C.
  PlaneStress plane_stress(const Eigen::Matrix2d& c, const PlaneFibres& fibres, double factor) const override;
  PlaneTangent plane_tangent(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                             double factor) const override;
};

}  // namespace valsalva::materials
