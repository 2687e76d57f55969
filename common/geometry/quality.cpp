#include "geometry/quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace valsalva::geometry {
namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double longest_edge(std::initializer_list<Vec3> corners) {
  double longest = 0;
  for (auto a = corners.begin(); a != corners.end(); ++a)
    for (auto b = a + 1; b != corners.end(); ++b) longest = std::max(longest, (*a - *b).norm());
  return longest;
}

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return 0.5 * (b - a).cross(c - a).norm();
}

}  // namespace

double triangle_aspect(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double area = triangle_area(a, b, c);
  const double perimeter = (a - b).norm() + (b - c).norm() + (c - a).norm();
  return area > 0 ? longest_edge({a, b, c}) * perimeter / (4 * std::sqrt(3.0) * area) : infinity;
}

double triangle_min_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c) {
  return degrees *
         std::min({angle_between(b - a, c - a), angle_between(c - b, a - b), angle_between(a - c, b - c)});
}

double tetrahedron_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6;
}

double tetrahedron_aspect(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double volume = std::abs(tetrahedron_volume(a, b, c, d));
  const double faces =
      triangle_area(a, b, c) + triangle_area(a, b, d) + triangle_area(a, c, d) + triangle_area(b, c, d);
  return volume > 0 ? longest_edge({a, b, c, d}) * faces / (6 * std::sqrt(6.0) * volume) : infinity;
}

double tetrahedron_min_dihedral_deg(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // Outward face normals; the dihedral angle is pi minus the angle between them.
  const std::array<Vec3, 4> normals{(c - b).cross(d - b), (d - a).cross(c - a), (b - a).cross(d - a),
                                    (c - a).cross(b - a)};
  double smallest = std::numbers::pi;
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j)
      smallest = std::min(smallest, std::numbers::pi - angle_between(normals[i], normals[j]));
  return degrees * smallest;
}

double tetrahedron_scaled_jacobian(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const std::array<Vec3, 4> corner{a, b, c, d};
  const double determinant = 6 * tetrahedron_volume(a, b, c, d);
  double largest_product = 0;
  for (int i = 0; i < 4; ++i) {
    double product = 1;
    for (int j = 0; j < 4; ++j)
      if (j != i) product *= (corner[j] - corner[i]).norm();
    largest_product = std::max(largest_product, product);
  }
  return largest_product > 0 ? std::numbers::sqrt2 * determinant / largest_product : 0;
}

TetQuality quality_of(const TetMesh& mesh) {
  TetQuality quality;
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) {
    const auto& t = mesh.tetrahedra[i];
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]], &d = mesh.points[t[3]];
    quality.min_dihedral_deg = std::min(quality.min_dihedral_deg, tetrahedron_min_dihedral_deg(a, b, c, d));
    quality.max_aspect = std::max(quality.max_aspect, tetrahedron_aspect(a, b, c, d));
    quality.volume_mm3 += tetrahedron_volume(a, b, c, d);
    const double jacobian = tetrahedron_scaled_jacobian(a, b, c, d);
    if (quality.worst < 0 || jacobian < quality.min_scaled_jacobian) {
      quality.min_scaled_jacobian = jacobian;
      quality.worst = static_cast<int>(i);
    }
  }
  return quality;
}

TriQuality quality_of(const TriMesh& mesh) {
  TriQuality quality;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    quality.min_angle_deg = std::min(quality.min_angle_deg, triangle_min_angle_deg(a, b, c));
    quality.max_aspect = std::max(quality.max_aspect, triangle_aspect(a, b, c));
  }
  return quality;
}

}  // namespace valsalva::geometry
