// What a Kirchhoff-Love shell's section answers to the stretch and the curvature of the middle surface.
//
// In an orthonormal basis of the reference tangent plane, with c the metric and k the curvature b of the
// present middle surface (k0 that of the reference), strain eps = (c - 1)/2 and kappa = k - k0:
//
//   laws       C(zeta) = S^-1 (c - 2 zeta k) S^-1,  S^2 = 1 - 2 zeta k0,
//              W = sum over the thickness (Gauss) of w det S  W_plane(C(zeta))
//              with any plane-stress law of the materials (Cirak and Ortiz 2001; Kiendl et al. 2015).
//              The change of thickness acts on the stress (C33), not on the distance zeta.
//   koiter     W = t/2 eps:H:eps + t^3/24 kappa:H:kappa,  H = E/(1 - nu^2) [(1 - nu) 1 + nu 1x1],
//              so that D = E t^3/(12 (1 - nu^2)) exactly (Koiter 1966): large rotation, small strain.
//
// Membrane and flexure apart (leaflet-flutter-2022, equations 15-24): the membrane part is one-point
// quadrature at zeta = 0, the flexural part full quadrature minus that. Each has its own thickness
// t times a factor: W = W_1(m t) + [W_full(f t) - W_1(f t)].
// Units: stress Pa, resultant Pa mm, moment Pa mm2, energy Pa mm.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "materials/plane_law.hpp"

namespace valsalva::structure {

struct SectionScales {
  double membrane_thickness = 1;  ///< m
  double flexural_thickness = 1;  ///< f
};

struct SectionPoint {
  double thickness;           ///< mm
  Eigen::Matrix2d curvature;  ///< k0
  materials::PlaneFibres fibres;
  double factor;  ///< of the law's matrix part
};

using Section6 = Eigen::Matrix<double, 6, 6>;

struct SectionResponse {
  double energy = 0;                                 ///< per reference area
  double exponent = 0;                               ///< the largest Q of the law's exp(Q)
  Eigen::Matrix2d force = Eigen::Matrix2d::Zero();   ///< dW/deps
  Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();  ///< dW/dk
  Section6 tangent = Section6::Zero();  ///< of (force, moment) by (eps, k), Voigt 11 22 12, 2 eps12
};

struct SectionStress {
  Eigen::Matrix2d c;       ///< in-plane right Cauchy-Green
  Eigen::Matrix2d stress;  ///< second Piola-Kirchhoff
  double exponent;
};

class SectionModel {
 public:
  virtual ~SectionModel() = default;
  /// InputError when the point's curvature is too large for its thickness.
  virtual void check(const SectionPoint&) const {}
  virtual SectionResponse respond(const SectionPoint& at, const Eigen::Matrix2d& c, const Eigen::Matrix2d& k,
                                  bool tangent) const = 0;
  /// At zeta = height t.
  virtual SectionStress stress(const SectionPoint& at, const Eigen::Matrix2d& c, const Eigen::Matrix2d& k,
                               double height) const = 0;
};

/// points: 1 to 5 Gauss points through the thickness (1: a membrane).
std::shared_ptr<const SectionModel> law_section(std::shared_ptr<const materials::PlaneLaw> law,
                                                int points = 3, const SectionScales& scales = {});

/// InputError unless modulus > 0 and -1 < nu <= 0.5.
std::shared_ptr<const SectionModel> koiter_section(double modulus_Pa, double poisson,
                                                   const SectionScales& scales = {});

}  // namespace valsalva::structure
