// Modified Holzapfel-Gasser-Ogden law: exponential neo-Hookean matrix and up to two fibre families that bear
// no compression, each with the angular dispersion kappa about its mean direction,
//   W = C10 {exp[C01 (I1 - 3)] - 1} + k1/(2 k2) sum_i {exp[k2 E_i^2] - 1},
//   E_i = kappa (I1 - 3) + (1 - 3 kappa) (max(I4_i, 1) - 1).
// Sources: without dispersion Brown et al. 2022 (tavr-ifed), eq. 3 and table 1, after Murdock et al. 2018;
// with dispersion and one family Lee et al. 2020 (pulse-duplicator), eqs. 4 and 5: their E is the same number
// written as kappa I1 + (1 - 3 kappa) I4 - 1. kappa = 0: aligned; kappa = 1/3: isotropic. Both papers use
// modified invariants. k1 = 0: the exponential neo-Hookean law.
// Small-strain Young's modulus of the matrix: 6 C10 C01. Beyond an exponent of 6: capped_exponential.hpp.
// The plane-stress tangent is positive semi-definite. Limit: with 0 < kappa < 1/3 the published switch on I4
// makes the stress jump at I4 = 1 where I1 > 3, by 2 k1 (1 - 3 kappa) kappa (I1 - 3) exp(...): kept as
// published.
#pragma once

#include "materials/invariant_law.hpp"

namespace valsalva::materials {

struct HgoParameters {
  double c10_Pa = 0;
  double c01 = 0;
  double k1_Pa = 0;
  double k2 = 0;
  double kappa = 0;
};

/// Table 1 of Brown et al. 2022: healthy native leaflets (fibres at +-26.21 degrees from commissure to
/// commissure).
inline constexpr HgoParameters native_leaflet_healthy{146.3, 26.21, 7072.0, 147.5};
inline constexpr double native_leaflet_fibre_angle_deg = 26.21;
/// Table 1 of Brown et al. 2022: glutaraldehyde-fixed porcine pericardium (+-7.81 degrees from the mean).
inline constexpr HgoParameters porcine_pericardium{15140.0, 13.48, 152600.0, 107.3};
inline constexpr double porcine_pericardium_fibre_angle_deg = 7.81;

class Hgo : public InvariantLaw {
 public:
  /// InputError when C10, C01 or k2 is not positive, k1 negative, or kappa outside [0, 1/3].
  explicit Hgo(const HgoParameters& parameters);
  std::string name() const override { return "hgo"; }
  InvariantResponse derivatives(const Invariants& at, int families, double factor) const override;
  InvariantResponseOf<Lanes> lane_derivatives(const InvariantsOf<Lanes>& at, int families,
                                              const Lanes& factor) const override;
  double matrix_modulus_Pa() const { return 6 * p_.c10_Pa * p_.c01; }

 private:
  template <class T>
  InvariantResponseOf<T> of(const InvariantsOf<T>& at, int families, const T& factor) const;
  HgoParameters p_;
};

}  // namespace valsalva::materials
