// Transversely isotropic Fung law in the Green-Lagrange strain, direction 1 along the fibre a,
//   W = Ch/2 (exp Q - 1),
//   Q = b1 E11^2 + b2 (E22^2 + E33^2 + E23^2 + E32^2) + b3 (E12^2 + E21^2 + E13^2 + E31^2),
// evaluated without a frame across the fibre: with e = a.E a and |E a|^2,
//   Q = b1 e^2 + b2 (E:E - 2 |E a|^2 + e^2) + 2 b3 (|E a|^2 - e^2).
// Source: Joda et al. 2016 (thickness-anisotropy), eq. 8, after Guccione et al. 1991 (*MAT_HEART_TISSUE).
// The strain is the full one, as printed, so SolidLaw takes it with Split::full; in an incompressible shell
// C33 = 1/det C. One fibre family (a second is ignored). The law has no fibre term of its own: it is
// symmetric in tension and compression, as published.
// Beyond Q = 6: capped_exponential.hpp. The tangent is positive definite for positive constants.
#pragma once

#include "materials/elastic_law.hpp"

namespace valsalva::materials {

struct FungParameters {
  double ch_Pa = 0;
  double b1 = 0;
  double b2 = 0;
  double b3 = 0;
};

class Fung : public ElasticLaw {
 public:
  /// InputError when a constant is not positive.
  explicit Fung(const FungParameters& parameters);
  std::string name() const override { return "fung"; }
  /// InputError when the body has no fibre direction.
  ElasticResponse respond(const Mat3& c, const Fibres& fibres, double factor,
                          Derivatives wanted) const override;

 private:
  FungParameters p_;
};

}  // namespace valsalva::materials
