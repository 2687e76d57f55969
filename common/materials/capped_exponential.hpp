// exp(Q), continued beyond Q = 6 by its second-order Taylor polynomial there: twice continuously
// differentiable, and finite in unstable transients. In sound runs Q stays below 6;
// `InvariantResponse::exponent` tells. T: lanes.hpp.
#pragma once

#include "materials/lanes.hpp"

namespace valsalva::materials {

inline constexpr double exponent_cap = 6.0;

template <class T = double>
struct CappedExponential {
  T value, first, second;  ///< the function and its first two derivatives with respect to Q
};

template <class T>
CappedExponential<T> capped_exponential(const T& q) {
  const T e = exponential(smaller(q, constant<T>(exponent_cap)));
  const T beyond = larger(q - exponent_cap, constant<T>(0));
  return {e * (1 + beyond * (1 + 0.5 * beyond)), e * (1 + beyond), e};
}

}  // namespace valsalva::materials
