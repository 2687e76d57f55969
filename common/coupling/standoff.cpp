#include "coupling/standoff.hpp"

#include <algorithm>

namespace valsalva::coupling {

void stand_off(double standoff_mm, const Points& x, const Points& normal, const std::vector<NearPair>& near,
               Points& out) {
  constexpr double oblique = 0.3;
  Points away(x.size(), Vec3::Zero());
  std::vector<double> lacking(x.size(), 0.0);
  for (const NearPair& pair : near) {
    const double d = pair.distance_mm;
    if (d >= standoff_mm) continue;
    const double closeness = 1 - d / standoff_mm;
    const Vec3 part = closeness * closeness / d * (x[pair.a] - x[pair.b]);
    away[pair.a] += part;
    away[pair.b] -= part;
    const double lack = std::min(standoff_mm, pair.rest_distance_mm) - d;
    for (int node : {pair.a, pair.b}) lacking[node] = std::max(lacking[node], lack);
  }
  out = x;
  for (std::size_t a = 0; a < x.size(); ++a) {
    if (!(lacking[a] > 0)) continue;
    const Vec3 m = normal[a].normalized();
    out[a] += 0.5 * lacking[a] * std::clamp(m.dot(away[a].normalized()) / oblique, -1.0, 1.0) * m;
  }
}

}  // namespace valsalva::coupling
