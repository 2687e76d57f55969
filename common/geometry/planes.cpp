#include "geometry/planes.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/measure.hpp"

namespace valsalva::geometry {

Plane Plane::at(const Vec3& origin, const Vec3& normal, const Vec3& towards) {
  Plane plane;
  plane.origin = origin;
  plane.normal = normal.normalized();
  Vec3 u = towards - towards.dot(plane.normal) * plane.normal;
  if (u.norm() < 1e-6 * towards.norm()) u = plane.normal.unitOrthogonal();
  plane.u = u.normalized();
  plane.v = plane.normal.cross(plane.u);
  return plane;
}

std::vector<Loop> section(const GridSdf& field, const Plane& plane, double half_width_mm, double step_mm) {
  const int half = int(std::ceil(half_width_mm / step_mm));
  const int n = 2 * half + 1;
  std::vector<double> values(std::size_t(n) * n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const bool edge = i == 0 || j == 0 || i + 1 == n || j + 1 == n;
      const double value = field.value(plane.point({(i - half) * step_mm, (j - half) * step_mm}));
      values[std::size_t(j) * n + i] = edge ? std::max(value, 1e-3 * step_mm) : value;
    }
  const auto at = [&](int i, int j) { return values[std::size_t(j) * n + i]; };

  // A crossing lies on a lattice edge: 2 (j n + i) for the edge to the right, + 1 for the edge upward.
  const auto crossing = [&](int edge) -> Vec2 {
    const int node = edge / 2, i = node % n, j = node / n;
    const double a = at(i, j), b = edge % 2 ? at(i, j + 1) : at(i + 1, j), t = a / (a - b);
    return {(i - half + (edge % 2 ? 0 : t)) * step_mm, (j - half + (edge % 2 ? t : 0)) * step_mm};
  };
  std::map<int, int> next;  // from crossing to crossing with the inside to the left
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const std::array<double, 4> corner{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      const std::array<int, 4> edge{2 * (j * n + i), 2 * (j * n + i + 1) + 1, 2 * ((j + 1) * n + i),
                                    2 * (j * n + i) + 1};
      std::vector<int> leaving, entering;  // walking round the cell: where the walk leaves, enters the inside
      for (int c = 0; c < 4; ++c) {
        const bool here = corner[c] < 0, then = corner[(c + 1) % 4] < 0;
        if (here && !then) leaving.push_back(c);
        if (!here && then) entering.push_back(c);
      }
      if (leaving.size() == 1) {
        next[edge[leaving[0]]] = edge[entering[0]];
      } else if (leaving.size() == 2) {  // a saddle: the mean decides which corners are joined
        const bool joined = corner[0] + corner[1] + corner[2] + corner[3] < 0;
        for (int c : leaving) {
          // Cut off the single outside corner after the crossing, or the single inside corner before it.
          const int partner = joined ? (c + 1) % 4 : (c + 3) % 4;
          next[edge[c]] = edge[partner];
        }
      }
    }
  std::vector<Loop> loops;
  while (!next.empty()) {
    Loop loop;
    for (auto step = next.begin(); step != next.end();) {
      loop.push_back(crossing(step->first));
      const int to = step->second;
      next.erase(step);
      step = next.find(to);
    }
    if (loop.size() > 2) loops.push_back(std::move(loop));
  }
  return loops;
}

Loop loop_at_origin(const std::vector<Loop>& loops) {
  const Loop* best = nullptr;
  double nearest = 0;
  for (const Loop& loop : loops) {
    const double signed_area = area(loop);
    if (signed_area <= 0) continue;  // a hole
    const double away = encloses(loop, Vec2::Zero()) ? -1 / signed_area : centroid(loop).norm();
    if (!best || away < nearest) {
      best = &loop;
      nearest = away;
    }
  }
  return best ? *best : Loop{};
}

bool encloses(const Loop& loop, const Vec2& point) {
  bool inside = false;
  for (std::size_t n = 0, m = loop.size() - 1; n < loop.size(); m = n++) {
    const Vec2 &a = loop[m], &b = loop[n];
    if ((a.y() > point.y()) != (b.y() > point.y()) &&
        point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

double distance_to(const Loop& loop, const Vec2& point) {
  double squared = std::numeric_limits<double>::max();
  for (std::size_t n = 0, m = loop.size() - 1; n < loop.size(); m = n++) {
    const Vec2 along = loop[n] - loop[m];
    const double t =
        std::clamp((point - loop[m]).dot(along) / std::max(along.squaredNorm(), 1e-30), 0.0, 1.0);
    squared = std::min(squared, (point - loop[m] - t * along).squaredNorm());
  }
  return encloses(loop, point) ? -std::sqrt(squared) : std::sqrt(squared);
}

}  // namespace valsalva::geometry
