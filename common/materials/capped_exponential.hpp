// exp(Q), continued beyond Q = 6 by its second-order Taylor polynomial there: twice continuously
// differentiable, and finite in unstable transients. In sound runs Q stays below 6;
// `InvariantResponse::exponent` tells.
#pragma once

#include <cmath>

namespace valsalva::materials {

inline constexpr double exponent_cap = 6.0;

struct CappedExponential {
  double value, first, second;  ///< the function and its first two derivatives with respect to Q
};

inline CappedExponential capped_exponential(double q) {
  if (q <= exponent_cap) {
    const double e = std::exp(q);
    return {e, e, e};
  }
  static const double at_cap = std::exp(exponent_cap);
  const double d = q - exponent_cap;
  return {at_cap * (1 + d + 0.5 * d * d), at_cap * (1 + d), at_cap};
}

}  // namespace valsalva::materials
