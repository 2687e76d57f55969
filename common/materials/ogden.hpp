// Ogden law in the principal stretches l_i, any number of terms (by name in law_catalogue.hpp: three),
//   W = sum_p mu_p/alpha_p (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3).
// Small-strain shear modulus: sum_p mu_p alpha_p / 2. Sources: Ogden 1972; one term in Joda et al. 2016
// (thickness-anisotropy), eq. 5, with modified stretches. (Other texts write 2 mu/alpha^2 or mu alpha/2:
// check.) S = sum_i g(c_i) N_i N_i with c_i = l_i^2 and g(c) = sum_p mu_p c^(alpha_p/2 - 1): an isotropic
// function of C, so that the tangent needs only g' and the divided differences [g(a) - g(b)]/(a - b), which
// are evaluated without cancellation at equal and nearly equal stretches (expm1, log1p): no threshold, no
// perturbation.
#pragma once

#include <vector>

#include "materials/elastic_law.hpp"

namespace valsalva::materials {

struct OgdenTerm {
  double mu_Pa = 0;
  double alpha = 0;
};

class Ogden : public ElasticLaw {
 public:
  /// InputError without a term, with a term where alpha = 0, or with a small-strain modulus not positive.
  explicit Ogden(std::vector<OgdenTerm> terms);
  std::string name() const override { return "ogden"; }
  ElasticResponse respond(const Mat3& c, const Fibres& fibres, double factor,
                          Derivatives wanted) const override;

 private:
  std::vector<OgdenTerm> terms_;
};

}  // namespace valsalva::materials
