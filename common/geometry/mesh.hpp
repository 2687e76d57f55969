// Plain meshes. Lengths in mm.
#pragma once

#include <Eigen/Geometry>

#include "core/types.hpp"

namespace valsalva::geometry {

struct TriMesh {
  Points points;
  std::vector<Triangle> triangles;  ///< counter-clockwise seen from outside, for a closed surface
};

struct TetMesh {
  Points points;
  std::vector<Tetrahedron> tetrahedra;
};

}  // namespace valsalva::geometry
