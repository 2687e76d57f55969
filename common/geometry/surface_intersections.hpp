// Self-intersections of a triangle surface.
#pragma once

#include <utility>
#include <vector>

#include "geometry/mesh.hpp"

namespace valsalva::geometry {

/// Pairs of triangles (by number) that meet elsewhere than in a shared vertex or edge; exact predicates.
/// The mesh must be manifold and consistently oriented.
std::vector<std::pair<int, int>> self_intersections(const TriMesh& mesh);

}  // namespace valsalva::geometry
