#include "materials/hgo.hpp"

#include <algorithm>

#include "core/errors.hpp"
#include "materials/capped_exponential.hpp"

namespace valsalva::materials {
namespace {

void require(bool holds, const char* key, double found, const char* expected) {
  if (!holds) throw InputError("material hgo: {} = {}; expected {}", key, found, expected);
}

}  // namespace

Hgo::Hgo(const HgoParameters& parameters) : p_(parameters) {
  require(std::isfinite(p_.c10_Pa) && p_.c10_Pa > 0, "C10 (Pa)", p_.c10_Pa, "a positive number");
  require(std::isfinite(p_.c01) && p_.c01 > 0, "C01", p_.c01, "a positive number");
  require(std::isfinite(p_.k1_Pa) && p_.k1_Pa >= 0, "k1 (Pa)", p_.k1_Pa, "a number that is not negative");
  require(std::isfinite(p_.k2) && p_.k2 > 0, "k2", p_.k2, "a positive number");
}

InvariantResponse Hgo::derivatives(const Invariants& at, int, double factor) const {
  InvariantResponse r;
  const double q1 = p_.c01 * (at.i1 - 3);
  const CappedExponential e1 = capped_exponential(q1);
  const double c10 = factor * p_.c10_Pa;
  r.energy = c10 * (e1.value - 1);
  r.d1 = c10 * p_.c01 * e1.first;
  r.d11 = c10 * p_.c01 * p_.c01 * e1.second;
  r.exponent = q1;
  for (int i = 0; i < 2; ++i) {
    const double s = at.i4[i] - 1;
    if (s <= 0) continue;
    const double q = p_.k2 * s * s;
    const CappedExponential e = capped_exponential(q);
    r.energy += p_.k1_Pa / (2 * p_.k2) * (e.value - 1);
    r.d4[i] = p_.k1_Pa * s * e.first;
    r.d44[i] = p_.k1_Pa * (e.first + 2 * p_.k2 * s * s * e.second);
    r.exponent = std::max(r.exponent, q);
  }
  return r;
}

}  // namespace valsalva::materials
