#include "materials/neo_hookean.hpp"

#include <cmath>

#include "core/errors.hpp"

namespace valsalva::materials {

NeoHookean::NeoHookean(double shear_modulus_Pa) : mu_(shear_modulus_Pa) {
  if (!(std::isfinite(mu_) && mu_ > 0))
    throw InputError("material neo-hookean: shear modulus (Pa) = {}; expected a positive number", mu_);
}

InvariantResponse NeoHookean::derivatives(const Invariants& at, int, double factor) const {
  InvariantResponse r;
  r.energy = 0.5 * factor * mu_ * (at.i1 - 3);
  r.d1 = 0.5 * factor * mu_;
  return r;
}

}  // namespace valsalva::materials
