#include "geometry/surface_fill.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

namespace valsalva::geometry {
namespace {

constexpr double edge_weight = 1e-4;

double cost(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * (b - a).cross(c - a).norm() +
         edge_weight * ((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm());
}

}  // namespace

std::vector<Triangle> filled_loop(const Points& points, const std::vector<int>& loop,
                                  const std::set<Edge>& taken) {
  const int n = static_cast<int>(loop.size());
  if (n < 3) return {};
  const auto at = [&](int i) -> const Vec3& { return points[loop[i]]; };
  // best[i][j]: cheapest triangulation of the polygon i, i+1, ..., j closed by the edge j-i.
  std::vector<std::vector<double>> best(n, std::vector<double>(n, 0.0));
  std::vector<std::vector<int>> apex(n, std::vector<int>(n, -1));
  for (int span = 2; span < n; ++span)
    for (int i = 0; i + span < n; ++i) {
      const int j = i + span;
      best[i][j] = std::numeric_limits<double>::infinity();
      if (span < n - 1 && taken.count({std::min(loop[i], loop[j]), std::max(loop[i], loop[j])})) continue;
      for (int k = i + 1; k < j; ++k) {
        const double total = best[i][k] + best[k][j] + cost(at(i), at(k), at(j));
        if (total < best[i][j]) {
          best[i][j] = total;
          apex[i][j] = k;
        }
      }
    }
  if (apex[0][n - 1] < 0) return {};
  std::vector<Triangle> triangles;
  std::vector<Edge> open{{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = apex[i][j];
    triangles.push_back({loop[j], loop[k], loop[i]});
    open.push_back({i, k});
    open.push_back({k, j});
  }
  return triangles;
}

}  // namespace valsalva::geometry
