#include "materials/straightened_fibre.hpp"

#include <algorithm>
#include <cmath>

#include "materials/capped_exponential.hpp"
#include "materials/checks.hpp"

namespace valsalva::materials {

StraightenedFibre::StraightenedFibre(const StraightenedFibreParameters& parameters)
    : p_(parameters), matrix_(parameters.c1_Pa, parameters.c2_Pa) {
  const char* law = "straightened-fibre";
  require_not_negative(law, "C3 (Pa)", p_.c3_Pa);
  require(p_.c4 > 0 && p_.c4 <= 300, law, "C4", p_.c4, "a number in (0, 300]");
  const double straight = p_.straightening_stretch;
  if (std::isinf(straight)) return;
  require(straight > 1, law, "straightening stretch", straight, "a number above 1");
  const CappedExponential e = capped_exponential<double>(p_.c4 * (straight - 1));
  c5_ = p_.c5_Pa.value_or(p_.c3_Pa * p_.c4 * e.first);
  require_not_negative(law, "C5 (Pa)", c5_);
  c6_ = p_.c3_Pa * (e.value - 1) - c5_ * straight;
  energy_at_straight_ = crimped(straight).energy;
}

StraightenedFibre::Fibre StraightenedFibre::crimped(double l) const {
  const double c3 = p_.c3_Pa, c4 = p_.c4;
  const CappedExponential e = capped_exponential<double>(c4 * (l - 1));
  const auto exponential_energy = [&](double to) {
    return std::exp(-c4) * (std::expint(c4 * to) - std::expint(c4)) - std::log(to);
  };
  const double cap = 1 + exponent_cap / c4;
  double energy = c3 * exponential_energy(std::min(l, cap));
  if (l > cap) {
    // The Taylor polynomial in l over l: a0 / l + a1 + a2 l.
    const double top = std::exp(exponent_cap), shift = c4 + exponent_cap;
    const double a0 = top * (1 - shift + 0.5 * shift * shift) - 1, a1 = top * c4 * (1 - shift),
                 a2 = 0.5 * top * c4 * c4;
    energy += c3 * (a0 * std::log(l / cap) + a1 * (l - cap) + 0.5 * a2 * (l * l - cap * cap));
  }
  const double first = c3 / l * (e.value - 1);
  return {energy, first, c3 * c4 / l * e.first - first / l};
}

StraightenedFibre::Fibre StraightenedFibre::fibre(double l) const {
  const double straight = p_.straightening_stretch;
  if (l <= 1) return {0, 0, 0};
  if (l < straight) return crimped(l);
  return {energy_at_straight_ + c5_ * (l - straight) + c6_ * std::log(l / straight), c5_ + c6_ / l,
          -c6_ / (l * l)};
}

InvariantResponse StraightenedFibre::derivatives(const Invariants& at, int families, double factor) const {
  InvariantResponse r = matrix_.derivatives(at, families, factor);
  for (int i = 0; i < families; ++i) {
    const double l = std::sqrt(at.i4[i]);
    const Fibre f = fibre(l);
    r.energy += f.energy;
    r.d4[i] = f.first / (2 * l);
    r.d44[i] = (f.second - f.first / l) / (4 * l * l);
    r.exponent = std::max(r.exponent, p_.c4 * (std::min(l, p_.straightening_stretch) - 1));
  }
  return r;
}

}  // namespace valsalva::materials
