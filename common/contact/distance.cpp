#include "contact/distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace valsalva::contact {
namespace {

inline Nearest finish(const Vec3& difference, const std::array<double, 4>& weight, const Vec3& side_a,
                      const Vec3& side_b) {
  const double squared = difference.squaredNorm();
  if (squared > 0) {
    const double distance = std::sqrt(squared);
    return {distance, difference / distance, weight};
  }
  const Vec3 normal = side_a.cross(side_b);  // features that meet: any unit vector across both
  const double length = normal.norm();
  return {0, length > 0 ? Vec3(normal / length) : Vec3(Vec3::UnitZ()), weight};
}

/// Barycentric coordinates of the triangle's point nearest to p.
inline std::array<double, 3> nearest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double v = d1 / (d1 - d3);
    return {1 - v, v, 0};
  }
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double w = d2 / (d2 - d6);
    return {1 - w, 0, w};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double scale = 1 / (va + vb + vc);
  return {1 - vb * scale - vc * scale, vb * scale, vc * scale};
}

}  // namespace

Nearest point_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto u = nearest_on_triangle(p, a, b, c);
  return finish(p - (u[0] * a + u[1] * b + u[2] * c), {1, -u[0], -u[1], -u[2]}, b - a, c - a);
}

Nearest point_segment(const std::array<Vec3, 4>& x, int point, int a, int b, bool point_first) {
  const Vec3 along = x[b] - x[a];
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((x[point] - x[a]).dot(along) / squared, 0.0, 1.0) : 0;
  const double sign = point_first ? 1 : -1;
  std::array<double, 4> weight{};
  weight[point] = sign;
  weight[a] -= sign * (1 - t);
  weight[b] -= sign * t;
  return finish(sign * (x[point] - ((1 - t) * x[a] + t * x[b])), weight, along, along);
}

Nearest edge_edge(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  const Vec3 da = a1 - a0, db = b1 - b0, r = a0 - b0;
  const double a = da.squaredNorm(), e = db.squaredNorm();
  const double b = da.dot(db), c = da.dot(r), f = db.dot(r);
  const double denominator = a * e - b * b;
  double s = denominator > 1e-12 * a * e ? std::clamp((b * f - c * e) / denominator, 0.0, 1.0) : 0.5;
  double t = (b * s + f) / e;
  if (t < 0) {
    t = 0;
    s = std::clamp(-c / a, 0.0, 1.0);
  } else if (t > 1) {
    t = 1;
    s = std::clamp((b - c) / a, 0.0, 1.0);
  }
  return finish((a0 + s * da) - (b0 + t * db), {1 - s, s, t - 1, -t}, da, db);
}

}  // namespace valsalva::contact
