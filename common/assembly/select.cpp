#include "assembly/select.hpp"

#include <cmath>

namespace valsalva::assembly {
namespace {

bool on(double distance, const Selection& s) {
  return distance <= s.tolerance && (s.inside || distance >= -s.tolerance);
}

bool chosen(const Vec3& x, const Selection& s) {
  const Vec3 n = s.direction.normalized(), d = x - s.point;
  switch (s.place) {
    case Place::box:
      return ((x - s.low).array() >= -s.tolerance).all() && ((s.high - x).array() >= -s.tolerance).all();
    case Place::plane:
      return on(n.dot(d), s);
    case Place::sphere:
      return on(d.norm() - s.radius, s);
    case Place::cylinder:
      return on((d - n.dot(d) * n).norm() - s.radius, s);
    case Place::nearest:
      return false;
  }
  return false;
}

}  // namespace

std::vector<int> select(const Points& points, const Selection& s) {
  std::vector<int> nodes;
  int nearest = -1;
  for (std::size_t a = 0; a < points.size(); ++a) {
    if (chosen(points[a], s)) nodes.push_back(static_cast<int>(a));
    if (nearest < 0 || (points[a] - s.point).norm() < (points[nearest] - s.point).norm())
      nearest = static_cast<int>(a);
  }
  if (s.place == Place::nearest && nearest >= 0) return {nearest};
  return nodes;
}

}  // namespace valsalva::assembly
