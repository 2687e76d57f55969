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
  double feature_angle_deg = 60;  ///< an edge whose faces turn by more is kept as a line
  double corner_angle_deg = 40;   ///< a point where a kept line turns by more is kept
  int iterations = 8;
};

/// The mesh must be manifold, consistently oriented and free of self-intersections (repair.hpp).
TriMesh remesh(const TriMesh& mesh, const RemeshOptions& options);

}  // namespace valsalva::geometry
