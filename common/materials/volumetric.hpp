// Volumetric energies U(J) per reference volume, J = det F, with U(1) = U'(1) = 0 and U''(1) = modulus:
//   none           0                                an exactly incompressible or a coupled law
//   j_ln_j         k (J ln J - J + 1)               Brown et al. 2022 eq. 4 and Lee et al. 2020 eq. 6 (beta)
//   quadratic      k/2 (J - 1)^2                    Joda et al. 2016, eqs. 5 and 8
//   logarithmic    k/2 (ln J)^2                     Joda et al. 2016, eq. 6; with k = lambda: Simo and Pister
//   1984 simo_taylor    k/4 (J^2 - 1 - 2 ln J)           Simo and Taylor 1982; the "dilatational penalty" of
//                                                   Wu et al. 2022
// The Kirchhoff pressure is J U'. `logarithmic` loses convexity in J above e, `j_ln_j` and `simo_taylor` are
// convex; only `simo_taylor` and `logarithmic` grow without bound as J -> 0.
#pragma once

#include <string>

namespace valsalva::materials {

struct VolumetricResponse {
  double energy = 0;  ///< U, Pa
  double first = 0;   ///< U' (the pressure, positive in tension)
  double second = 0;  ///< U''
};

struct Volumetric {
  enum class Form { none, j_ln_j, quadratic, logarithmic, simo_taylor };
  Form form = Form::none;
  double modulus_Pa = 0;  ///< the bulk modulus (beta, K, kappa)

  /// NumericalFailure when J is not positive: the element is inverted.
  VolumetricResponse respond(double j) const;
};

/// InputError with "did you mean" on an unknown name: none, j-ln-j, quadratic, logarithmic, simo-taylor.
Volumetric::Form volumetric_form(const std::string& name);
std::string name_of(Volumetric::Form form);

}  // namespace valsalva::materials
