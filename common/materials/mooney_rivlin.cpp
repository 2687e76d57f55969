#include "materials/mooney_rivlin.hpp"

#include "materials/checks.hpp"

namespace valsalva::materials {

MooneyRivlin::MooneyRivlin(double c1_Pa, double c2_Pa) : c1_(c1_Pa), c2_(c2_Pa) {
  require_positive("mooney-rivlin", "C1 (Pa)", c1_);
  require_not_negative("mooney-rivlin", "C2 (Pa)", c2_);
}

InvariantResponse MooneyRivlin::derivatives(const Invariants& at, int, double factor) const {
  InvariantResponse r;
  r.energy = factor * (c1_ * (at.i1 - 3) + c2_ * (at.i2 - 3));
  r.d1 = factor * c1_;
  r.d2 = factor * c2_;
  return r;
}

}  // namespace valsalva::materials
