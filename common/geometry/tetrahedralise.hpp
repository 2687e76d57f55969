// The wall as tetrahedra: layers grown outwards from the lumen surface to the offset of its level set.
//
// Every node x of the open inner surface gets an outer partner y with phi(y) = thickness, along the smoothed
// surface normal; nodes of the border stay in their cut plane (z unchanged). Prisms between x and y are cut
// into `layers` slices and each slice into three tetrahedra, the diagonals of the side faces starting at the
// lower vertex number, so that neighbours agree (Dompierre et al. 1999). Where slices come out badly shaped
// the outer nodes are moved along the offset surface until they are not, and
// where that does not help (folds sharper than the thickness) the wall is made thinner, down to a fifth.
// Limits: the thickness must stay below the smallest outer radius of curvature of a concave fold, and below
// the reach of the level set.
#pragma once

#include "geometry/grid_sdf.hpp"
#include "geometry/mesh.hpp"

namespace valsalva::geometry {

struct WallOptions {
  double thickness_mm = 1;
  int layers = 2;
};

struct WallMesh {
  TetMesh mesh;
  int thinned_nodes = 0;  ///< nodes of the outer surface that lie nearer than the thickness
};

/// lumen: outward triangles with border loops in planes z = const. NumericalFailure that names the place when
/// an element stays inverted.
WallMesh tetrahedral_wall(const TriMesh& lumen, const GridSdf& level_set, const WallOptions& options);

/// Volume of low_value < phi < high_value between two planes z = const, by sub-sampling the trilinear level
/// set (8 x 8 x 8 points in every cell that an interface may cross).
double level_set_volume(const GridSdf& level_set, double low_value, double high_value, double low_z,
                        double high_z);

}  // namespace valsalva::geometry
