// Quality of triangles and tetrahedra. Every figure is 1 (or the regular element's angle) at best.
//
//   aspect          longest edge / inradius, scaled to 1 for the regular element:
//                   triangle  L / (2 sqrt 3 r),  tetrahedron  L / (2 sqrt 6 r);  infinite when degenerate
//   dihedral        smallest angle between two faces of a tetrahedron, degrees; regular: 70.53
//   scaled Jacobian sqrt 2 * smallest over the corners of det(edges) / product of their lengths; regular: 1;
//                   negative when inverted (Knupp et al., Verdict library manual, 2006)
#pragma once

#include "geometry/mesh.hpp"

namespace valsalva::geometry {

double triangle_aspect(const Vec3& a, const Vec3& b, const Vec3& c);
double triangle_min_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c);
/// Positive when d lies on the side to which the normal of (a, b, c) points.
double tetrahedron_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
double tetrahedron_aspect(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
double tetrahedron_min_dihedral_deg(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
double tetrahedron_scaled_jacobian(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

struct TetQuality {
  double min_dihedral_deg = 180;
  double max_aspect = 0;
  double min_scaled_jacobian = 1;
  double volume_mm3 = 0;
  int worst = -1;  ///< the tetrahedron with the smallest scaled Jacobian
};
TetQuality quality_of(const TetMesh& mesh);

struct TriQuality {
  double min_angle_deg = 180;
  double max_aspect = 0;
};
TriQuality quality_of(const TriMesh& mesh);

}  // namespace valsalva::geometry
