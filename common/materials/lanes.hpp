// Eight numbers at a time: what is written for a type T runs with T = double for one element and with
// T = Lanes for eight, which the compiler keeps in vector registers. Every lane is computed alike, so that a
// result does not depend on where in a group of eight its element stands.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace valsalva::materials {

inline constexpr int lane_count = 8;
using Lanes = Eigen::Array<double, lane_count, 1>;

template <class T>
T constant(double value);
template <>
inline double constant<double>(double value) {
  return value;
}
template <>
inline Lanes constant<Lanes>(double value) {
  return Lanes::Constant(value);
}

inline double exponential(double x) {
  return std::exp(x);
}
inline Lanes exponential(const Lanes& x) {
  return x.exp();
}

/// The larger and the smaller of both; a where it is not a number, so that it is not hidden.
inline double larger(double a, double b) {
  return b > a ? b : a;
}
inline Lanes larger(const Lanes& a, const Lanes& b) {
  return (b > a).select(b, a);
}
inline double smaller(double a, double b) {
  return b < a ? b : a;
}
inline Lanes smaller(const Lanes& a, const Lanes& b) {
  return (b < a).select(b, a);
}

/// a > b ? yes : no
inline double if_above(double a, double b, double yes, double no) {
  return a > b ? yes : no;
}
inline Lanes if_above(const Lanes& a, double b, const Lanes& yes, const Lanes& no) {
  return (a > b).select(yes, no);
}

/// atan2(sine, cosine) to some 1e-15: tan(angle/16) by three half-angle formulas, below 0.2, then the series
/// of the arc tangent.
inline Lanes angle_of(const Lanes& sine, const Lanes& cosine) {
  const Lanes length = (sine.square() + cosine.square()).sqrt();
  // Each form is good where the other cancels; at 180 degrees the second one would divide by zero.
  constexpr double tiny = 1e-150;
  const Lanes divisor = (sine < 0).select((-sine).max(tiny) * -1, sine.max(tiny));
  Lanes x = (cosine > 0)
                .select(sine / (length + cosine).max(tiny),
                        ((length - cosine) / divisor).min(1 / tiny).max(-1 / tiny));
  for (int halving = 0; halving < 3; ++halving) x /= 1 + (1 + x.square()).sqrt();
  const Lanes z = x.square();
  Lanes series = Lanes::Zero();
  for (int n = 12; n >= 0; --n) series = 1.0 / (2 * n + 1) - z * series;
  return 16 * x * series;
}

}  // namespace valsalva::materials
