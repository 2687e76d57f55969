// St. Venant-Kirchhoff law: W = lambda/2 (tr E)^2 + mu E:E, S = lambda tr E 1 + 2 mu E.
// Source: Kirchhoff 1852; in Nestola et al. 2021 (contact-fsi), eq. 3, the stent (the equation is lost in the
// text that we have; the law has one form only). Use it as SolidLaw with Split::full and no volumetric term.
// Limit: large rotation, small strain. Under compression it softens, and at a stretch below 1/sqrt(3) in
// uniaxial strain it has no stiffness left; the tangent dS/dE is constant and positive definite.
#pragma once

#include "materials/elastic_law.hpp"

namespace valsalva::materials {

class StVenantKirchhoff : public ElasticLaw {
 public:
  /// InputError when mu is not positive or 3 lambda + 2 mu is not.
  StVenantKirchhoff(double lambda_Pa, double mu_Pa);
  std::string name() const override { return "st-venant-kirchhoff"; }
  ElasticResponse respond(const Mat3& c, const Fibres& fibres, double factor,
                          Derivatives wanted) const override;

 private:
  double lambda_, mu_;
};

}  // namespace valsalva::materials
