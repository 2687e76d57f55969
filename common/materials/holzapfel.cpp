#include "materials/holzapfel.hpp"

#include <algorithm>

#include "materials/checks.hpp"
#include "materials/fibre_exponential.hpp"

namespace valsalva::materials {

HgoParameters as_hgo(const HolzapfelParameters& p) {
  require(p.a_Pa[0] == p.a_Pa[1] && p.b[0] == p.b[1], "holzapfel", "a2, b2", p.a_Pa[1],
          "those of family 1, as an HGO law has");
  constexpr double almost_linear = 1e-3;
  return {p.mu_Pa / (2 * almost_linear), almost_linear, p.a_Pa[0], p.b[0], 0};
}

Holzapfel::Holzapfel(const HolzapfelParameters& parameters) : p_(parameters) {
  require_positive("holzapfel", "mu (Pa)", p_.mu_Pa);
  for (double a : p_.a_Pa) require_not_negative("holzapfel", "a (Pa)", a);
  for (double b : p_.b) require_positive("holzapfel", "b", b);
}

InvariantResponse Holzapfel::derivatives(const Invariants& at, int families, double factor) const {
  InvariantResponse r;
  r.energy = 0.5 * factor * p_.mu_Pa * (at.i1 - 3);
  r.d1 = 0.5 * factor * p_.mu_Pa;
  for (int i = 0; i < families; ++i) {
    const FibreExponential w = fibre_exponential<double>(p_.a_Pa[i], p_.b[i], at.i4[i] - 1);
    r.energy += w.energy;
    r.d4[i] = w.first;
    r.d44[i] = w.second;
    r.exponent = std::max(r.exponent, w.exponent);
  }
  return r;
}

}  // namespace valsalva::materials
