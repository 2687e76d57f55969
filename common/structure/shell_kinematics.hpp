// What forces and tangent of the shell share: kinematics of triangles and hinges. Not for others.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "structure/shell.hpp"

namespace valsalva::structure {

inline constexpr int lanes = materials::lane_count;
using materials::Lanes;
using LaneVector = std::array<Lanes, 3>;

// Deformation gradient F (3x2) of a triangle.
inline Eigen::Matrix<double, 3, 2> deformation(const Vec3& x0, const Vec3& x1, const Vec3& x2,
                                               const Eigen::Matrix2d& inverse_edges) {
  Eigen::Matrix<double, 3, 2> edges;
  edges << x1 - x0, x2 - x0;
  return edges * inverse_edges;
}

// Angle between the normals of the two triangles of a hinge (edge 0-1, opposite nodes 2 and 3), positive when
// it folds towards the side of the normal; and its gradient (Bridson, Marino and Fedkiw 2003, section 2).
struct HingeGeometry {
  double angle;
  std::array<Vec3, 4> gradient;
};

inline double angle_of(const Vec3& normal1, const Vec3& normal2, const Vec3& edge) {
  return std::atan2(normal1.cross(normal2).dot(edge) / edge.norm(), normal1.dot(normal2));
}

inline HingeGeometry hinge_geometry(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  const Vec3 edge = x1 - x0;
  const Vec3 normal1 = edge.cross(x2 - x0);
  const Vec3 normal2 = (x3 - x0).cross(edge);
  const double length = edge.norm();
  const double square1 = std::max(normal1.squaredNorm(), 1e-20),
               square2 = std::max(normal2.squaredNorm(), 1e-20);
  HingeGeometry g;
  g.angle = angle_of(normal1, normal2, edge);
  const Vec3 u1 = -normal1 / square1, u2 = -normal2 / square2;
  g.gradient[2] = length * u1;
  g.gradient[3] = length * u2;
  g.gradient[0] = ((x2 - x1).dot(edge) / length) * u1 + ((x3 - x1).dot(edge) / length) * u2;
  g.gradient[1] = -((x2 - x0).dot(edge) / length) * u1 - ((x3 - x0).dot(edge) / length) * u2;
  return g;
}

}  // namespace valsalva::structure
