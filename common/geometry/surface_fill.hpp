// Triangulation of a closed loop of points in space: least sum of triangle areas, ties broken by edge lengths
// (dynamic programming of Barequet and Sharir 1995; cubic in the number of points). For a plane simple
// polygon this is a valid triangulation of it.
#pragma once

#include <set>
#include <vector>

#include "geometry/mesh.hpp"

namespace valsalva::geometry {

/// loop: vertex numbers in the order of a border (border_loops); the triangles run against it, so that they
/// close the surface with the right orientation. No vertices are added.
/// taken: edges (lower vertex first) that may not appear as diagonals. Empty when there is no triangulation.
std::vector<Triangle> filled_loop(const Points& points, const std::vector<int>& loop,
                                  const std::set<Edge>& taken = {});

}  // namespace valsalva::geometry
