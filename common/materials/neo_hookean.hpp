// Incompressible neo-Hookean law: W = mu/2 (I1 - 3). Small-strain Young's modulus 3 mu. Source: Rivlin 1948.
#pragma once

#include "materials/invariant_law.hpp"

namespace valsalva::materials {

class NeoHookean : public InvariantLaw {
 public:
  /// InputError when the shear modulus is not positive.
  explicit NeoHookean(double shear_modulus_Pa);
  std::string name() const override { return "neo-hookean"; }
  InvariantResponse derivatives(const Invariants& at, int families, double factor) const override;

 private:
  double mu_;
};

}  // namespace valsalva::materials
