// Isotropic remeshing of triangle surfaces by edge splits, collapses, flips and tangential relaxation with
// projection to the input (Botsch and Kobbelt 2004; CGAL Polygon mesh processing).
//
// Sharp edges and borders stay where they are, as lines; their corners stay as points. Edge lengths end
// between about 0.6 and 1.4 of the target, with the target as mean. The result depends on the input only.
#pragma once

#include "geometry/mesh.hpp"

namespace valsalva::geometry {

struct RemeshOptions {
  double edge_mm = 1;
  double feature_angle_deg = 180;  ///< an edge whose faces turn by more is kept as a line; 180: borders only
  double corner_angle_deg = 40;    ///< a point where a kept line turns by more is kept
  int iterations = 8;
  bool protect_borders = false;  ///< keep every vertex of borders and kept lines
};

/// The mesh must be manifold, consistently oriented and free of self-intersections (repair.hpp).
TriMesh remesh(const TriMesh& mesh, const RemeshOptions& options);

/// Closes the plane border loops of an open surface by caps of about the same edge length; the given vertices
/// stay.
TriMesh closed_by_caps(const TriMesh& open, double edge_mm);

}  // namespace valsalva::geometry
