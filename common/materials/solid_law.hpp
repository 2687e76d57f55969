// A compressible or nearly incompressible solid: an elastic law plus a volumetric term,
//   modified (default)  Psi = W(C~) + U(J),  C~ = J^(-2/3) C   the law sees shape change only: I1~, I4~ ...
//   full                Psi = W(C) - s0 ln J + U(J)            s0 = the law's own stress at C = 1 (mu for the
//                                                              neo-Hookean solid), so that rest is stress
//                                                              free
// For W(E) laws (St. Venant-Kirchhoff, Fung) s0 is zero and `full` without a volumetric term is the law
// itself.
//
// For a displacement element:   SolidLaw::respond(C, fibres, factor, Derivatives::tangent): S and dS/dE.
// For a mixed u-p element:      SolidLaw::distortional(...) and SolidLaw::volumetric(J), kept apart, so that
//                               the pressure field p replaces U'(J): S = S_dist + p J C^-1, p = U'(J) weakly,
//                               1/kappa = 1/modulus (0: incompressible), volumetric_stress for the C^-1
//                               terms.
// For F-bar:                    respond at the C of F-bar = (J0/J)^(1/3) F.
// First Piola-Kirchhoff: P = F S; Cauchy: F S F^T / J (cauchy_stress below).
//
// NumericalFailure when det C is not positive or J overflows the powers: the caller adds the element. Law,
// fibres and `factor` as in elastic_law.hpp. The tangent is symmetric; it is positive semi-definite in no law
// by construction (the volumetric and the isochoric parts trade): clip or line-search in the element.
#pragma once

#include <memory>

#include "materials/elastic_law.hpp"
#include "materials/volumetric.hpp"

namespace valsalva::materials {

enum class Split { modified, full };

class SolidLaw : public PlaneLaw {
 public:
  /// InputError when a volumetric form comes without a positive modulus.
  SolidLaw(std::shared_ptr<const ElasticLaw> law, Volumetric volumetric, Split split = Split::modified);
  std::string name() const override;
  const ElasticLaw& law() const { return *law_; }
  Split split() const { return split_; }
  double bulk_modulus_Pa() const { return volumetric_.modulus_Pa; }
  /// False: the law sees shape change only and there is no U(J); a body of it needs another that keeps its
  /// volume.
  bool resists_volume_change() const {
    return split_ == Split::full || volumetric_.form != Volumetric::Form::none;
  }

  /// Psi, S and dS/dE.
  ElasticResponse respond(const Mat3& c, const Fibres& fibres, double factor, Derivatives wanted) const;
  /// The same without U(J).
  ElasticResponse distortional(const Mat3& c, const Fibres& fibres, double factor, Derivatives wanted) const;
  /// U, U', U''.
  VolumetricResponse volumetric(double j) const { return volumetric_.respond(j); }

  /// Plane stress: the C33 with S33 = 0 by Newton in ln C33, and the condensed consistent tangent
  /// D_ab - D_a3 D_3b / D_33. NumericalFailure when no such C33 exists.
  PlaneStress plane_stress(const Eigen::Matrix2d& c, const PlaneFibres& fibres, double factor) const override;
  PlaneTangent plane_tangent(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                             double factor) const override;

 private:
  std::shared_ptr<const ElasticLaw> law_;
  Volumetric volumetric_;
  Split split_;
  double rest_stress_ = 0;  // s0 at factor 1
};

/// S = p J C^-1 and dS/dE at fixed p: p J (C^-1 x C^-1 - 2 C^-1 o C^-1).
struct PressureStress {
  Mat3 stress;
  Tangent6 tangent;
  Voigt6 per_pressure;  ///< dS/dp = J C^-1, also dJ/dE
};
PressureStress volumetric_stress(const Mat3& c, double pressure_Pa);

/// sigma = F S F^T / det F.
Mat3 cauchy_stress(const Mat3& f, const Mat3& second_piola);

}  // namespace valsalva::materials
