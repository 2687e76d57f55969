// The direction of a triangulated surface across each of its edges: what a Kirchhoff-Love shell of nodes
// without rotations bends about.
//
// At the middle of every edge stands the vector d = dx/dy, the derivative of the position across the edge (y
// in the reference tangent plane of the edge, outward of its first triangle), as a weighted sum of nodes near
// by:
//   inner, free, hinged   the weights are exact for quadratic functions of the place in that plane, of least
//                         norm among the nodes of the edge's triangles and their neighbours (moving least
//                         squares, Lancaster and Salkauskas 1981, with weights 1/(d^2 + h^2/20)^4)
//   symmetry              along the plane's normal: d = m (m . sum)
//   clamped               R d0, as the clamp has turned
// One vector an edge, seen by both triangles: hence the patch test on any mesh (kirchhoff_shell.hpp).
#pragma once

#include <map>
#include <span>
#include <vector>

#include "structure/block_matrix.hpp"

namespace valsalva::structure {

/// What a border edge of a shell can do. Holding or moving its nodes is the System's business.
enum class EdgeSupport {
  free,      ///< turns freely; also for nodes that are held (a hinge)
  clamped,   ///< keeps its direction, or turns with a clamp
  symmetry,  ///< the surface goes on as its mirror image; hold the nodes along the plane's normal
};

struct EdgeCondition {
  EdgeSupport support = EdgeSupport::free;
  Vec3 normal = Vec3::Zero();  ///< of the symmetry plane
  int clamp = 0;               ///< which rotation a clamped edge turns with
};

/// By ascending node numbers; border edges that are not listed are free.
using EdgeConditions = std::map<Edge, EdgeCondition>;

struct ShellEdge {
  std::array<int, 2> nodes;      ///< with the first triangle on the left
  std::array<int, 2> triangles;  ///< the second is -1 on the border
  std::array<int, 2> opposite;   ///< third corners; -1
  EdgeCondition condition;
};

class ShellEdges {
 public:
  /// InputError names the edge that belongs to more than two triangles or whose triangles are turned against
  /// each other, the node without a triangle, and the condition on an edge that is not at the border.
  ShellEdges(const Points& reference, const std::vector<Triangle>& triangles,
             const EdgeConditions& conditions);

  int nodes() const { return nodes_; }
  int count() const { return static_cast<int>(edges_.size()); }
  const ShellEdge& edge(int i) const { return edges_[i]; }
  /// Edge k of a triangle runs from its corner k to the next one.
  const std::array<int, 3>& of_triangle(int triangle) const { return of_triangle_[triangle]; }

  /// Nodes, then edge vectors: the "vertices" on which a triangle's energy depends.
  int vertices() const { return nodes_ + count(); }
  /// From nodes at x[offset...]. `clamps`: rotations of the clamps since the reference; identity if not
  /// given.
  void gather(const Points& x, int offset, Points& vertices, std::span<const Mat3> clamps = {}) const;
  /// Their change with a change of the nodes.
  void gather_change(const Points& direction, int offset, Points& vertices) const;
  /// The transpose: forces on vertices become forces on nodes, added to f[offset...].
  void scatter(const Points& vertex_forces, Points& f, int offset) const;
  /// Adds a stiffness of some vertices (3 a vertex) to that of the nodes.
  void add_matrix(std::span<const int> vertices, const Eigen::Ref<const Eigen::MatrixXd>& k, BlockMatrix& out,
                  int offset) const;
  /// Sums of the weights' absolute values: of each vertex, and their transpose.
  std::vector<double> gather_bound() const;
  void scatter_bound(const std::vector<double>& vertex_bound, std::vector<double>& bound, int offset) const;

 private:
  struct Row {
    int begin, end;  // into terms_
    Vec3 fixed = Vec3::Zero();
    int clamp = -1;      // fixed turns with it
    int projector = -1;  // index of the plane's normal
  };
  struct Term {
    int node;
    double weight;
  };
  void find_edges(const std::vector<Triangle>& triangles, const EdgeConditions& conditions);
  void weigh(const Points& x);
  std::vector<Term> weights(const Points& x, const ShellEdge& e, const Vec3& along, const Vec3& across) const;

  int nodes_ = 0;
  std::vector<ShellEdge> edges_;
  std::vector<std::array<int, 3>> of_triangle_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<Row> rows_;
  std::vector<Term> terms_;
  std::vector<Vec3> normals_;
};

}  // namespace valsalva::structure
