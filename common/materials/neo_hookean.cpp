#include "materials/neo_hookean.hpp"

#include "materials/checks.hpp"

namespace valsalva::materials {

NeoHookean::NeoHookean(double shear_modulus_Pa) : mu_(shear_modulus_Pa) {
  require_positive("neo-hookean", "shear modulus (Pa)", mu_);
}

InvariantResponse NeoHookean::derivatives(const Invariants& at, int, double factor) const {
  InvariantResponse r;
  r.energy = 0.5 * factor * mu_ * (at.i1 - 3);
  r.d1 = 0.5 * factor * mu_;
  return r;
}

}  // namespace valsalva::materials
