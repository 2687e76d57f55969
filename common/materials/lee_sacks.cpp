#include "materials/lee_sacks.hpp"

#include <algorithm>

#include "materials/checks.hpp"
#include "materials/fibre_exponential.hpp"

namespace valsalva::materials {

HgoParameters as_hgo(const LeeSacksParameters& p) {
  require(p.w == 1, "lee-sacks", "w", p.w, "1: only the isotropic law is one of evenly dispersed fibres");
  constexpr double almost_linear = 1e-3;
  return {p.c0_Pa / (2 * almost_linear), almost_linear, 9 * p.c1_Pa * p.c2, 9 * p.c2, 1.0 / 3.0};
}

LeeSacks::LeeSacks(const LeeSacksParameters& parameters) : p_(parameters) {
  require_positive("lee-sacks", "c0 (Pa)", p_.c0_Pa);
  require_not_negative("lee-sacks", "c1 (Pa)", p_.c1_Pa);
  require_positive("lee-sacks", "c2", p_.c2);
  require_positive("lee-sacks", "c3", p_.c3);
  require(p_.w >= 0 && p_.w <= 1, "lee-sacks", "w", p_.w, "a number in [0, 1]");
}

InvariantResponse LeeSacks::derivatives(const Invariants& at, int families, double factor) const {
  // c1/2 exp(c x^2) is the squared exponential with k1 = c1 c.
  InvariantResponse r;
  const FibreExponential matrix =
      squared_exponential<double>(factor * p_.w * p_.c1_Pa * p_.c2, p_.c2, at.i1 - 3);
  r.energy = 0.5 * factor * p_.c0_Pa * (at.i1 - 3) + matrix.energy;
  r.d1 = 0.5 * factor * p_.c0_Pa + matrix.first;
  r.d11 = matrix.second;
  r.exponent = matrix.exponent;
  for (int i = 0; i < families; ++i) {
    const FibreExponential w =
        fibre_exponential<double>((1 - p_.w) * p_.c1_Pa * p_.c3 / families, p_.c3, at.i4[i] - 1);
    r.energy += w.energy;
    r.d4[i] = w.first;
    r.d44[i] = w.second;
    r.exponent = std::max(r.exponent, w.exponent);
  }
  return r;
}

}  // namespace valsalva::materials
