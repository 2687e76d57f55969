// Mooney-Rivlin matrix with one fibre family that straightens,
//   W = C1 (I1 - 3) + C2 (I2 - 3) + F(l),  l = sqrt(I4),
//   dF/dl = 0                              l <  1        fibres bear no compression
//           C3/l {exp[C4 (l - 1)] - 1}     1 <= l < l*   crimped collagen
//           (C5 l + C6)/l                  l >= l*       straight collagen
// Source: Joda et al. 2016 (thickness-anisotropy), eqs. 6 and 7; Weiss et al. 1996, Puso and Weiss 1998
// (*MAT_SOFT_TISSUE). The paper prints the right-hand sides as F itself; taken so, the fibre would pull at
// rest (F'(1) = C3 C4), so they are read as dF/dl, as in Weiss et al. C6 follows from continuity of dF/dl at
// l*, and C5, when not given, from continuity of its slope. The paper states neither l* nor C5.
// The energy has a closed form with the exponential integral: F = C3 {exp(-C4) [Ei(C4 l) - Ei(C4)] - ln l}.
// Beyond C4 (l - 1) = 6: capped_exponential.hpp. Beyond l* the tangent in I4 turns negative (a linear force
// per stretch is concave in l^2), so the tangent is not positive semi-definite there.
#pragma once

#include <limits>
#include <optional>

#include "materials/invariant_law.hpp"
#include "materials/mooney_rivlin.hpp"

namespace valsalva::materials {

struct StraightenedFibreParameters {
  double c1_Pa = 0;
  double c2_Pa = 0;
  double c3_Pa = 0;
  double c4 = 0;
  double straightening_stretch = std::numeric_limits<double>::infinity();  ///< l*
  std::optional<double> c5_Pa;                                             ///< slope beyond l*
};

class StraightenedFibre : public InvariantLaw {
 public:
  /// InputError when C1 or C4 is not positive, C2 or C3 negative, C4 above 300, or l* not above 1.
  explicit StraightenedFibre(const StraightenedFibreParameters& parameters);
  std::string name() const override { return "straightened-fibre"; }
  InvariantResponse derivatives(const Invariants& at, int families, double factor) const override;

 private:
  struct Fibre {
    double energy, first, second;  // F and its derivatives with respect to l
  };
  Fibre crimped(double stretch) const;
  Fibre fibre(double stretch) const;

  StraightenedFibreParameters p_;
  MooneyRivlin matrix_;
  double c5_ = 0, c6_ = 0, energy_at_straight_ = 0;
};

}  // namespace valsalva::materials
