#include "materials/hgo.hpp"

#include <algorithm>

#include "materials/checks.hpp"
#include "materials/fibre_exponential.hpp"

namespace valsalva::materials {

Hgo::Hgo(const HgoParameters& parameters) : p_(parameters) {
  require_positive("hgo", "C10 (Pa)", p_.c10_Pa);
  require_positive("hgo", "C01", p_.c01);
  require_not_negative("hgo", "k1 (Pa)", p_.k1_Pa);
  require_positive("hgo", "k2", p_.k2);
  require(p_.kappa >= 0 && p_.kappa <= 1.0 / 3.0, "hgo", "kappa", p_.kappa, "a number in [0, 1/3]");
}

template <class T>
InvariantResponseOf<T> Hgo::of(const InvariantsOf<T>& at, int families, const T& factor) const {
  InvariantResponseOf<T> r;
  const T q1 = p_.c01 * (at.i1 - 3);
  const CappedExponential<T> e1 = capped_exponential<T>(q1);
  const T c10 = factor * p_.c10_Pa;
  r.energy = c10 * (e1.value - 1);
  r.d1 = c10 * p_.c01 * e1.first;
  r.d11 = c10 * p_.c01 * p_.c01 * e1.second;
  r.exponent = q1;
  const T aligned = constant<T>(1 - 3 * p_.kappa);
  for (int i = 0; i < families; ++i) {
    const T stretched = if_above(at.i4[i], 1, aligned, constant<T>(0));  // dE/dI4
    const FibreExponential<T> w =
        fibre_exponential<T>(p_.k1_Pa, p_.k2, p_.kappa * (at.i1 - 3) + stretched * (at.i4[i] - 1));
    r.energy += w.energy;
    r.d1 += p_.kappa * w.first;
    r.d11 += p_.kappa * p_.kappa * w.second;
    r.d4[i] = stretched * w.first;
    r.d44[i] = stretched * stretched * w.second;
    r.d14[i] = p_.kappa * stretched * w.second;
    r.exponent = larger(r.exponent, w.exponent);
  }
  return r;
}

InvariantResponse Hgo::derivatives(const Invariants& at, int families, double factor) const {
  return of(at, families, factor);
}

InvariantResponseOf<Lanes> Hgo::lane_derivatives(const InvariantsOf<Lanes>& at, int families,
                                                 const Lanes& factor) const {
  return of(at, families, factor);
}

}  // namespace valsalva::materials
