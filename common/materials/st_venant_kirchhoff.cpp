#include "materials/st_venant_kirchhoff.hpp"

#include "materials/checks.hpp"
#include "materials/voigt.hpp"

namespace valsalva::materials {

StVenantKirchhoff::StVenantKirchhoff(double lambda_Pa, double mu_Pa) : lambda_(lambda_Pa), mu_(mu_Pa) {
  const char* law = "st-venant-kirchhoff";
  require_positive(law, "mu (Pa)", mu_);
  require(3 * lambda_ + 2 * mu_ > 0, law, "lambda (Pa)", lambda_, "a number above -2/3 mu");
}

ElasticResponse StVenantKirchhoff::respond(const Mat3& c, const Fibres&, double factor,
                                           Derivatives wanted) const {
  const Mat3 e = 0.5 * (c - Mat3::Identity());
  const double lambda = factor * lambda_, mu = factor * mu_, trace = e.trace();
  ElasticResponse r;
  r.energy = 0.5 * lambda * trace * trace + mu * e.squaredNorm();
  r.stress = lambda * trace * Mat3::Identity() + 2 * mu * e;
  if (wanted == Derivatives::stress) return r;
  const Voigt6 one = voigt(Mat3::Identity());
  r.tangent = lambda * one * one.transpose() + 2 * mu * symmetric_square(Mat3::Identity());
  return r;
}

}  // namespace valsalva::materials
