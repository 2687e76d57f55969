#include "flow_scene/shapes.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::flow_scene {

namespace {

double distance_to_segment(double s, double r, double s0, double r0, double s1, double r1) {
  const double ds = s1 - s0, dr = r1 - r0, length2 = ds * ds + dr * dr;
  const double t = length2 > 0 ? std::clamp(((s - s0) * ds + (r - r0) * dr) / length2, 0.0, 1.0) : 0;
  return std::hypot(s - s0 - t * ds, r - r0 - t * dr);
}

}  // namespace

double distance_to_cylinder(const Vec3& x, double radius, double length) {
  const double across = std::hypot(x[0], x[1]) - radius;
  if (length == 0) return across;
  const double along = std::abs(x[2]) - 0.5 * length;
  return std::min(std::max(across, along), 0.0) + std::hypot(std::max(across, 0.0), std::max(along, 0.0));
}

double distance_to_box(const Vec3& x, const Vec3& half) {
  const Vec3 q = x.cwiseAbs() - half;
  return q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
}

double distance_to_torus(const Vec3& x, double radius, double tube) {
  return std::hypot(std::hypot(x[0], x[1]) - radius, x[2]) - tube;
}

double distance_to_ellipsoid(const Vec3& x, const Vec3& half) {
  const Vec3 unit = x.cwiseQuotient(half), slope = unit.cwiseQuotient(half);
  const double level = unit.norm(), size = slope.norm();
  return size > 0 ? level * (level - 1) / size : -half.minCoeff();
}

Revolution::Revolution(std::vector<double> s, std::vector<double> radius, bool endless)
    : s_(std::move(s)), r_(std::move(radius)), endless_(endless) {}

double Revolution::distance(const Vec3& x) const {
  const double s = x[2], r = std::hypot(x[0], x[1]);
  const std::size_t n = s_.size();
  double nearest = 1e300;
  for (std::size_t i = 0; i + 1 < n; ++i)
    nearest = std::min(nearest, distance_to_segment(s, r, s_[i], r_[i], s_[i + 1], r_[i + 1]));
  double radius_here = -1;
  if (endless_) {
    constexpr double far = 1e6;
    nearest = std::min({nearest, distance_to_segment(s, r, s_[0] - far, r_[0], s_[0], r_[0]),
                        distance_to_segment(s, r, s_[n - 1], r_[n - 1], s_[n - 1] + far, r_[n - 1])});
    if (s < s_[0]) radius_here = r_[0];
    if (s >= s_[n - 1]) radius_here = r_[n - 1];
  } else {
    nearest = std::min({nearest, distance_to_segment(s, r, s_[0], 0, s_[0], r_[0]),
                        distance_to_segment(s, r, s_[n - 1], r_[n - 1], s_[n - 1], 0)});
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (s < s_[i] || s >= s_[i + 1]) continue;
    radius_here = r_[i] + (s - s_[i]) / (s_[i + 1] - s_[i]) * (r_[i + 1] - r_[i]);
  }
  return r < radius_here ? -nearest : nearest;
}

}  // namespace valsalva::flow_scene
