#include "tissue_damping.hpp"

#include <algorithm>
#include <map>

namespace valsalva::crimp {

TissueDamping::TissueDamping(std::string name, const std::vector<Triangle>& triangles,
                             const std::vector<double>& mass, int offset, double beta_per_s)
    : name_(std::move(name)) {
  std::map<std::array<int, 2>, std::vector<int>> opposite;  // of each edge
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      opposite[{std::min(a, b), std::max(a, b)}].push_back(t[(k + 2) % 3]);
    }
  const auto add = [&](int a, int b) {
    dashpots_.push_back({offset + a, offset + b, beta_per_s * std::min(mass[a], mass[b])});
  };
  for (const auto& [edge, corners] : opposite) {
    add(edge[0], edge[1]);
    if (corners.size() == 2) add(corners[0], corners[1]);
  }
}

double TissueDamping::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  for (const auto& [i, j, c] : dashpots_) {
    const Vec3 line = now.x[i] - now.x[j];
    const double length2 = line.squaredNorm();
    if (length2 <= 0) continue;
    const Vec3 force = (c * (now.v[i] - now.v[j]).dot(line) / length2) * line;
    out.force[i] -= force;
    out.force[j] += force;
  }
  return 0;
}

}  // namespace valsalva::crimp
