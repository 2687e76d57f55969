// Two-direction Holzapfel law: neo-Hookean matrix and two fibre families with their own constants,
//   W = mu/2 (I1 - 3) + sum_i a_i/(2 b_i) {exp[b_i (max(I4_i, 1) - 1)^2] - 1},
// families along the radial and the circumferential direction. Source: Nestola et al. 2021 (contact-fsi),
// eq. 4. The equation itself is lost in the text that we have; it is rebuilt from its parameters (mu_H, a_i,
// b_i, k_H), the description of the two families and the law it is named after (Holzapfel, Gasser and Ogden
// 2000; Holzapfel 2000). The plane-stress tangent is positive semi-definite.
#pragma once

#include "materials/hgo.hpp"
#include "materials/invariant_law.hpp"

namespace valsalva::materials {

struct HolzapfelParameters {
  double mu_Pa = 0;
  std::array<double, 2> a_Pa{};
  std::array<double, 2> b{};
};

/// The same as an HGO law (a = 0: neo-Hookean), its matrix up to 5e-4 (I1 - 3) of itself. InputError where
/// the families have different constants.
HgoParameters as_hgo(const HolzapfelParameters& parameters);

class Holzapfel : public InvariantLaw {
 public:
  /// InputError when mu or a b is not positive, or an a negative.
  explicit Holzapfel(const HolzapfelParameters& parameters);
  std::string name() const override { return "holzapfel"; }
  InvariantResponse derivatives(const Invariants& at, int families, double factor) const override;

 private:
  HolzapfelParameters p_;
};

}  // namespace valsalva::materials
