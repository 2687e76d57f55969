// Triangles in the plane, by gmsh's frontal Delaunay method: for cut patterns and unrolled surfaces.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/types.hpp"

namespace valsalva::stent {

using Vec2 = Eigen::Vector2d;

struct PlaneMesh {
  std::vector<Vec2> points;  ///< the boundary in the given order, the inner points as given, then gmsh's own
  std::vector<Triangle> triangles;  ///< counter-clockwise
};

/// Inside a simple polygon given counter-clockwise. Every polygon vertex and every inner point becomes a
/// node, no node is added on the polygon. NumericalFailure when gmsh fails, moves the boundary, or leaves an
/// element with an angle below 10 degrees.
PlaneMesh mesh_polygon(const std::vector<Vec2>& boundary, const std::vector<Vec2>& inner, double edge_mm);

/// The smallest angle of all triangles, degrees.
double smallest_angle_deg(const std::vector<Vec2>& points, const std::vector<Triangle>& triangles);

}  // namespace valsalva::stent
