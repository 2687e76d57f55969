// How the triangles of a subdivision surface are joined: the ring of neighbours of every node, completed
// beyond the border by ghost vertices.
//
// Border: each border edge (a, b) with the inner corner c has a ghost beyond it, at a + b - c; a border node
// with fewer than three triangles has further ghosts, at 2 v - (neighbour), so that its ring is regular
// (valence 6) for one to three triangles and has three more neighbours than triangles otherwise.
// What a ghost's position is, is said in subdivision_ghosts.hpp.
#pragma once

#include <map>
#include <vector>

#include "core/types.hpp"

namespace valsalva::structure {

/// What a border edge of the surface can do.
enum class EdgeSupport {
  free,     ///< nothing is prescribed
  hinged,   ///< its nodes are points of the surface, to be held or moved as one likes; it can rotate
  clamped,  ///< the same, and the surface keeps its direction across the edge
  symmetry  ///< the surface goes on as its mirror image; hold the nodes along the plane's normal
};

struct EdgeCondition {
  EdgeSupport support = EdgeSupport::free;
  Vec3 normal = Vec3::Zero();  ///< of the symmetry plane
  int clamp = 0;               ///< which rotation a clamped edge turns with
};

/// By ascending node numbers; border edges that are not listed are free.
using EdgeConditions = std::map<Edge, EdgeCondition>;

struct BorderEdge {
  int a, b, inner;  ///< a -> b with the surface on the left; the third corner of its triangle
  int triangle;
  EdgeCondition condition;
};

struct Ghost {
  std::array<int, 3> plus_plus_minus;  ///< it lies at about x[0] + x[1] - x[2]
  std::array<int, 3> edges;            ///< border edges near it; -1: none
};

struct SubdivisionTopology {
  int nodes = 0;
  std::vector<Triangle> triangles;
  std::vector<BorderEdge> border;
  std::vector<Ghost> ghosts;  ///< ghost g is vertex nodes + g
  /// Neighbours of every node, counter-clockwise, ghosts among them. On the border the ring begins with the
  /// next border node and the node's own triangles.
  std::vector<std::vector<int>> rings;
  std::vector<std::array<int, 2>> border_of;  ///< per node: the border edge that ends, that begins; or -1

  int vertices() const { return nodes + static_cast<int>(ghosts.size()); }
  bool supported(int node) const;  ///< on a hinged or clamped edge
};

/// InputError names the edge that belongs to more than two triangles or whose triangles are turned against
/// each other, the node where two pieces of surface touch or that has no triangle, and the condition on an
/// edge that is not at the border.
SubdivisionTopology subdivision_topology(int nodes, const std::vector<Triangle>& triangles,
                                         const EdgeConditions& conditions);

}  // namespace valsalva::structure
