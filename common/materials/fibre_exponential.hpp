// The stored energy of one fibre family in the laws of Holzapfel's kind,
//   w(e) = k1/(2 k2) {exp(k2 e^2) - 1}   for e > 0, else 0: fibres bear no compression.
// w, w' are continuous at e = 0, w'' jumps there from 0 to k1. Beyond k2 e^2 = 6: capped_exponential.hpp.
#pragma once

#include "materials/capped_exponential.hpp"

namespace valsalva::materials {

struct FibreExponential {
  double energy = 0, first = 0, second = 0;  ///< w, dw/de, d2w/de2
  double exponent = 0;                       ///< k2 e^2
};

/// Without the switch.
inline FibreExponential squared_exponential(double k1, double k2, double e) {
  const double q = k2 * e * e;
  const CappedExponential x = capped_exponential(q);
  return {k1 / (2 * k2) * (x.value - 1), k1 * e * x.first, k1 * (x.first + 2 * k2 * e * e * x.second), q};
}

inline FibreExponential fibre_exponential(double k1, double k2, double e) {
  return e > 0 ? squared_exponential(k1, k2, e) : FibreExponential{};
}

}  // namespace valsalva::materials
