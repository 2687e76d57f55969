#include "contact/pressure_law.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::contact {

Pressure normal_pressure(Law law, double modulus_Pa, double distance_mm, double contact_distance_mm) {
  if (distance_mm >= contact_distance_mm) return {};
  const double h = contact_distance_mm, K = modulus_Pa;
  if (law == Law::penalty) {
    const double u = 1 - distance_mm / h;
    return {0.5 * K * h * u * u, K * u, K / h};
  }
  const double s = std::max(distance_mm / h, 1e-3), u = s - 1, ln_s = std::log(s), r = u / s;
  return {-K * h * u * u * ln_s, K * (2 * u * ln_s + u * r), K / h * (r * r - 4 * r - 2 * ln_s)};
}

}  // namespace valsalva::contact
