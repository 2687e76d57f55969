// Lee-Sacks law: neo-Hookean matrix, isotropic and fibre exponentials weighted by w,
//   W = c0/2 (I1 - 3) + c1/2 { w exp[c2 (I1 - 3)^2] + (1 - w) exp[c3 (max(I4, 1) - 1)^2] - 1 }.
// Source: the law that Johnson et al. 2022 (leaflet-flutter) name and Wu et al. 2018 (J Biomech 74:23-31)
// give after Lee et al. 2014; w = 1 is the isotropic form, whose printed equation is checked against the
// manual of FEBio ("isotropic Lee-Sacks"). The anisotropic form is rebuilt from memory of that paper and the
// public model zoos, and the fibre term is switched off in compression, which the source does not state. One
// fibre family; with two, each takes half of the fibre term. Plane-stress tangent: positive semi-definite.
#pragma once

#include "materials/invariant_law.hpp"

namespace valsalva::materials {

struct LeeSacksParameters {
  double c0_Pa = 0;
  double c1_Pa = 0;
  double c2 = 0;
  double c3 = 0;
  double w = 1;
};

class LeeSacks : public InvariantLaw {
 public:
  /// InputError when c0, c2 or c3 is not positive, c1 negative, or w outside [0, 1].
  explicit LeeSacks(const LeeSacksParameters& parameters);
  std::string name() const override { return "lee-sacks"; }
  InvariantResponse derivatives(const Invariants& at, int families, double factor) const override;

 private:
  LeeSacksParameters p_;
};

}  // namespace valsalva::materials
