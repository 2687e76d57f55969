// Positions of the vertices of a subdivision surface that are not nodes of the System, as weighted sums of
// nodes: ghosts beyond the border, and the control vertices of supported border nodes.
//
// A node of the System is a control vertex, except on hinged and clamped edges, where it is a point of the
// surface. All weights come from one rule: a weighted sum of the nodes near by which is exact for quadratic
// functions of the position in the tangent plane, of least norm with weights 1/(d^2 + 1e-3 h^2)^2 (moving
// least squares, Lancaster and Salkauskas 1981; distance d, edge length h):
//   free, hinged  the ghost is extrapolated. (The usual x_a + x_b - x_c is exact for linear functions only,
//                 takes the curvature across the border away and with it an order of accuracy.)
//   symmetry      the mirror image of the surface at the ghost's mirrored place
//   clamped       the same for the displacement: u(ghost) = u(mirrored place), so that the slope stays
//   supported     the control vertex c of a node at x, from its limit position:
//                 x = c + l sum_k (c_k - c), the neighbours' c_k - c on the same edge taken as x_k - x.
// A control vertex stands off the surface by half the second derivatives times the covariance of its ring;
// where control vertices and surface points are mixed, the exactness is asked for with that difference.
// Where the nodes do not suffice for a quadratic (a strip of one row), a smaller basis is taken.
#pragma once

#include "structure/subdivision_topology.hpp"

namespace valsalva::structure {

/// position = sum_i weight_i T_i x(node_i) + shift + R offset;  T: mirror images, R: the clamp's rotation.
struct VertexRow {
  struct Term {
    int node;
    int mirror;  ///< index into VertexRows::mirrors; 0: none
    double weight;
  };
  std::vector<Term> terms;
  Vec3 shift = Vec3::Zero();
  Vec3 offset = Vec3::Zero();
  int clamp = -1;  ///< which rotation R; -1: none
};

struct VertexRows {
  std::vector<Mat3> mirrors{Mat3::Identity()};
  std::vector<int> vertex;  ///< nodes (on supported edges) and ghosts
  std::vector<VertexRow> rows;
};

/// vertices: where all of them lie in the reference (nodes: as the System has them), from which the weights
/// are computed. `clamps`: false gives the rows of the stress-free shape, in which clamped edges are hinged.
VertexRows vertex_rows(const SubdivisionTopology& topology, const Points& nodes, const Points& vertices,
                       bool clamps);

}  // namespace valsalva::structure
