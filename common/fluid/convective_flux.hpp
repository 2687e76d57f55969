// The flux of a velocity component q through the side between q[-s] and q[0]; a: the velocity along that
// direction, at two places a stride sd apart (its mean advects). Equations: momentum.hpp.
#pragma once

#include <cmath>
#include <cstddef>

namespace valsalva::fluid {

/// Four points, fixed weights: F = a [ c1 (q0 + q1) - c2 (q-1 + q2) ] + s |a| [ 3 (q0 - q1) + (q2 - q-1) ].
struct LinearFlux {
  double c1, c2, s12;

  double operator()(const double* q, std::ptrdiff_t s, const double* a, std::ptrdiff_t sd) const {
    const double speed = 0.5 * (a[0] + a[-sd]);
    const double near = q[-s] + q[0], far = q[-2 * s] + q[s];
    const double jump = 3 * (q[-s] - q[0]) + (q[s] - q[-2 * s]);
    return speed * (c1 * near - c2 * far) + s12 * std::abs(speed) * jump;
  }
};

/// Six points: fifth-order upwind-biased face value from three parabolas, weighted by their smoothness with
/// the weights of WENO-Z (Borges et al. 2008, J. Comput. Phys. 227, eqs. 25 to 28, p = 2).
struct WenoFlux {
  /// Value on the side between c and d; the flow comes from the side of a.
  static double face_value(double a, double b, double c, double d, double e) {
    const double parabola0 = 2 * a - 7 * b + 11 * c, parabola1 = 5 * c - b + 2 * d,
                 parabola2 = 2 * c + 5 * d - e;
    const auto square = [](double x) { return x * x; };
    const double beta0 = 13.0 / 12 * square(a - 2 * b + c) + 0.25 * square(a - 4 * b + 3 * c);
    const double beta1 = 13.0 / 12 * square(b - 2 * c + d) + 0.25 * square(b - d);
    const double beta2 = 13.0 / 12 * square(c - 2 * d + e) + 0.25 * square(3 * c - 4 * d + e);
    const double tau = std::abs(beta0 - beta2);
    constexpr double still = 1e-40;  // keeps 0 / 0 out where nothing changes
    const double w0 = 0.1 * (1 + square(tau / (beta0 + still)));
    const double w1 = 0.6 * (1 + square(tau / (beta1 + still)));
    const double w2 = 0.3 * (1 + square(tau / (beta2 + still)));
    return (w0 * parabola0 + w1 * parabola1 + w2 * parabola2) / (6 * (w0 + w1 + w2));
  }

  double operator()(const double* q, std::ptrdiff_t s, const double* a, std::ptrdiff_t sd) const {
    const double speed = 0.5 * (a[0] + a[-sd]);
    const bool up = speed >= 0;
    return speed * face_value(up ? q[-3 * s] : q[2 * s], up ? q[-2 * s] : q[s], up ? q[-s] : q[0],
                              up ? q[0] : q[-s], up ? q[s] : q[-2 * s]);
  }
};

}  // namespace valsalva::fluid
