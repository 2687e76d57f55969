// The stored energy of one fibre family in the laws of Holzapfel's kind,
//   w(e) = k1/(2 k2) {exp(k2 e^2) - 1}   for e > 0, else 0: fibres bear no compression.
// w, w' are continuous at e = 0, w'' jumps there from 0 to k1. Beyond k2 e^2 = 6: capped_exponential.hpp. T:
// lanes.hpp.
#pragma once

#include "materials/capped_exponential.hpp"

namespace valsalva::materials {

template <class T = double>
struct FibreExponential {
  T energy, first, second;  ///< w, dw/de, d2w/de2
  T exponent;               ///< k2 e^2
};

/// Without the switch.
template <class T>
FibreExponential<T> squared_exponential(double k1, double k2, const T& e) {
  const T q = k2 * e * e;
  const CappedExponential<T> x = capped_exponential<T>(q);
  return {k1 / (2 * k2) * (x.value - 1), k1 * e * x.first, k1 * (x.first + 2 * k2 * e * e * x.second), q};
}

template <class T>
FibreExponential<T> fibre_exponential(double k1, double k2, const T& e) {
  FibreExponential<T> w = squared_exponential<T>(k1, k2, larger(e, constant<T>(0)));
  w.second = if_above(e, 0, w.second, constant<T>(0));
  return w;
}

}  // namespace valsalva::materials
