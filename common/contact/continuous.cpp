#include "contact/continuous.hpp"

#include <algorithm>

namespace valsalva::contact {

double allowed_share(PairKind kind, const std::array<Vec3, 4>& x0, const std::array<Vec3, 4>& x1,
                     double stop_mm) {
  constexpr double nearly = 0.05;  // of the way to `stop`
  constexpr int most_advances = 1000;
  std::array<Vec3, 4> motion;
  Vec3 mean = Vec3::Zero();
  for (int k = 0; k < 4; ++k) mean += 0.25 * (x1[k] - x0[k]);
  const int first = kind == PairKind::point_triangle ? 1 : 2;  // nodes of the first feature
  double one = 0, other = 0;
  for (int k = 0; k < 4; ++k) {
    motion[k] = x1[k] - x0[k] - mean;
    (k < first ? one : other) = std::max(k < first ? one : other, motion[k].norm());
  }
  const double reach = one + other;
  double distance = nearest(kind, x0).distance, share = 0;
  const double close = stop_mm + nearly * (distance - stop_mm);
  if (distance - reach > stop_mm) return 1;
  for (int advance = 0; advance < most_advances && distance > close; ++advance) {
    share += (distance - stop_mm) / reach;
    if (share >= 1) return 1;
    std::array<Vec3, 4> x;
    for (int k = 0; k < 4; ++k) x[k] = x0[k] + share * motion[k];
    distance = nearest(kind, x).distance;
  }
  return share;
}

}  // namespace valsalva::contact
