// Lee-Sacks law: neo-Hookean matrix, isotropic and fibre exponentials weighted by w,
//   W = c0/2 (I1 - 3) + c1/2 { w exp[c2 (I1 - 3)^2] + (1 - w) exp[c3 (max(I4, 1) - 1)^2] - 1 }.
// Source: the law that Johnson et al. 2022 (leaflet-flutter) name, after Wu et al. 2018 (J Biomech 74:23-31)
// and Lee et al. 2014. Neither text is at hand; the equation is the one that the same groups publish in the
// heart-valve demonstration of CouDALFISh (anisotropic, and with w = 1 isotropic), and the isotropic form
// agrees with FEBio's manual. They do not switch the fibre term off in compression; here it is, as in all
// other laws. One fibre family; with two, each takes half of the fibre term. The plane-stress tangent is
// positive semi-definite.
#pragma once

#include "materials/hgo.hpp"
#include "materials/invariant_law.hpp"

namespace valsalva::materials {

struct LeeSacksParameters {
  double c0_Pa = 0;
  double c1_Pa = 0;
  double c2 = 0;
  double c3 = 0;
  double w = 1;
};

/// With w = 1 the law is that of Holzapfel, Gasser and Ogden for one family of evenly dispersed fibres
/// (kappa = 1/3) in an all but linear matrix: C10 (exp(C01 I) - 1) = c0/2 I (1 + C01 I/2 ...), I = I1 - 3,
/// C01 = 1e-3. Stresses agree within 1e-3 below I = 1. InputError when w is not 1.
HgoParameters as_hgo(const LeeSacksParameters& parameters);

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
