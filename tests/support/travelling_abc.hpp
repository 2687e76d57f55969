// The travelling Arnold-Beltrami-Childress flow, an exact solution in the unit periodic box (rho = 1):
//   u = 1 + a (cos 2pi(y-t) + sin 2pi(z-t)), v = 1 + a (sin 2pi(x-t) + cos 2pi(z-t)),
//   w = 1 + a (cos 2pi(x-t) + sin 2pi(y-t)), a = e^(-4 pi^2 nu t)
#pragma once

#include <cmath>
#include <numbers>

#include "core/types.hpp"

namespace valsalva::test {

/// Component d at x and time t.
inline double travelling_abc(int d, const Vec3& x, double t, double nu) {
  const double k = 2 * std::numbers::pi, a = std::exp(-k * k * nu * t);
  const double X = k * (x[0] - t), Y = k * (x[1] - t), Z = k * (x[2] - t);
  if (d == 0) return 1 + a * (std::cos(Y) + std::sin(Z));
  if (d == 1) return 1 + a * (std::sin(X) + std::cos(Z));
  return 1 + a * (std::cos(X) + std::sin(Y));
}

}  // namespace valsalva::test
