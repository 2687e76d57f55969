// The fourth-order operators of a periodic box (Morinishi et al. 1998, J. Comput. Phys. 143, sections 4, 5).
// Along a direction with the spacing h, values half a cell to the sides of the point:
//
//   first difference   [27 (q(1/2) - q(-1/2)) - (q(3/2) - q(-3/2))] / (24 h)
//   interpolation      [ 9 (q(1/2) + q(-1/2)) - (q(3/2) + q(-3/2))] / 16
//   of sixth order     [150 (q(1/2) + q(-1/2)) - 25 (q(3/2) + q(-3/2)) + 3 (q(5/2) + q(-5/2))] / 256
//   second difference  [16 (q(1) + q(-1)) - (q(2) + q(-2)) - 30 q(0)] / (12 h^2)
#pragma once

#include <cmath>
#include <cstddef>

namespace valsalva::fluid::fourth_order {

/// h times the first difference; q[0] lies at +1/2, q[-s] at -1/2.
inline double difference(const double* q, std::ptrdiff_t s) {
  return (27.0 * (q[0] - q[-s]) - (q[s] - q[-2 * s])) * (1.0 / 24);
}

/// q[0] lies at +1/2, q[-s] at -1/2.
inline double interpolate(const double* q, std::ptrdiff_t s) {
  return 0.0625 * (9.0 * (q[0] + q[-s]) - (q[s] + q[-2 * s]));
}

inline double interpolate_sixth(const double* q, std::ptrdiff_t s) {
  return (150.0 * (q[0] + q[-s]) - 25.0 * (q[s] + q[-2 * s]) + 3.0 * (q[2 * s] + q[-3 * s])) * (1.0 / 256);
}

/// h^2 times the second difference.
inline double second_difference(const double* q, std::ptrdiff_t s) {
  return (16.0 * (q[s] + q[-s]) - (q[2 * s] + q[-2 * s]) - 30.0 * q[0]) * (1.0 / 12);
}

/// h times the factor of the first difference of e^(i angle x/h), without i.
inline double symbol(double angle) {
  return (27.0 * std::sin(0.5 * angle) - std::sin(1.5 * angle)) / 12;
}

}  // namespace valsalva::fluid::fourth_order
