// Mooney-Rivlin law: W = C1 (I1 - 3) + C2 (I2 - 3). Small-strain shear modulus 2 (C1 + C2).
// Source: Rivlin 1948; in Joda et al. 2016 (thickness-anisotropy) the aortic root with C1 = 0.1 MPa, and the
// matrix of eq. 6. The plane-stress tangent is positive semi-definite for C2 = 0; with C2 > 0 it is so in
// tension.
#pragma once

#include "materials/invariant_law.hpp"

namespace valsalva::materials {

class MooneyRivlin : public InvariantLaw {
 public:
  /// InputError when C1 is not positive or C2 negative.
  MooneyRivlin(double c1_Pa, double c2_Pa);
  std::string name() const override { return "mooney-rivlin"; }
  InvariantResponse derivatives(const Invariants& at, int families, double factor) const override;

 private:
  double c1_, c2_;
};

}  // namespace valsalva::materials
