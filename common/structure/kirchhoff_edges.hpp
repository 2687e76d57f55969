// The slope and the bending of a triangulated surface at the middle of each of its edges, from which a
// Kirchhoff-Love shell of nodes without rotations takes its curvature.
//
// With s along the edge and y across it (in the reference tangent plane of the edge, outward of its first
// triangle) every edge has four vectors: d = x,y and x,ss x,sy x,yy, as weighted sums of nodes near by:
//   inner, free, hinged   the weights are exact for quadratic functions of the place in that plane, of least
//                         norm among the nodes of the edge's triangles and their neighbours (moving least
//                         squares, Lancaster and Salkauskas 1981, with weights 1/(d^2 + h^2/20)^4)
//   symmetry              d and x,sy along the plane's normal m (m . sum), x,ss and x,yy in the plane
//   clamped               d = R d0, x,ss and x,sy likewise, as the clamp has turned; x,yy knows d
// One d an edge, seen by both triangles: hence the patch test on any mesh (kirchhoff_shell.hpp).
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

  /// Nodes, then four vectors an edge: the "vertices" on which a triangle's energy depends.
  int vertices() const { return nodes_ + vectors * count(); }
  static constexpr int vectors = 4;  ///< d, x,ss, x,sy, x,yy
  /// The first of an edge's vectors, d.
  int vertex(int edge) const { return nodes_ + vectors * edge; }
  /// How far an edge's second derivatives are to be trusted, 0 to 1: 0 where too few nodes were near (a strip
  /// of one row; they are zero), less than 1 where nodes lie so that the sum of the weights' absolute values,
  /// times the area of the edge's triangles, exceeds 10 (4 to 8 on regular meshes).
  double trust(int edge) const { return rows_[edge].trust; }
  /// From nodes at x[offset...]. `clamps`: rotations of the clamps since the reference; identity if not
  /// given.
  void gather(const Points& x, int offset, Points& vertices, std::span<const Mat3> clamps = {}) const;
  /// The transpose: forces on vertices become forces on nodes, added to f[offset...].
  void scatter(const Points& vertex_forces, Points& f, int offset) const;
  /// The nodes that move the vectors of a triangle's edges, its own first, and their weights (4 rows an
  /// edge).
  void reach(int triangle, std::vector<int>& nodes, Eigen::MatrixXd& weights) const;
  /// k <- P k P^T for a matrix k of the vectors of an edge beside others, 3 a vector from row and column
  /// `first`; P maps the weighted sums to the vectors (not the identity at symmetry planes).
  void project(int edge, int first, Eigen::Ref<Eigen::MatrixXd> k) const;
  /// Adds a stiffness of some nodes and vectors d (by vertex, 3 each) to that of the nodes.
  void add_matrix(std::span<const int> vertices, const Eigen::Ref<const Eigen::MatrixXd>& k, BlockMatrix& out,
                  int offset) const;
  /// Adds bounds of the stiffness of nodes and vectors d to that of the nodes.
  void scatter_bound(const std::vector<double>& vertex_bound, std::vector<double>& bound, int offset) const;

 private:
  struct Row {
    int begin, end;  // into terms_
    Eigen::Matrix<double, 3, vectors> fixed = Eigen::Matrix<double, 3, vectors>::Zero();
    int clamp = -1;  // fixed turns with it
    int plane = -1;  // index of the symmetry plane's normal
    double trust = 1;
  };
  struct Term {
    int node;
    std::array<double, vectors> weight;
  };
  void find_edges(const std::vector<Triangle>& triangles, const EdgeConditions& conditions);
  void weigh(const Points& x);
  const Row& row_of_d(int vertex) const;
  struct Fit {
    std::vector<Term> terms;
    double by_slope = 0;  // weight of a known d in x,yy
    bool quadratic = true;
  };
  Fit fit(const Points& x, const ShellEdge& e, const Vec3& along, const Vec3& across, bool slope_known) const;
  double trust_in(const Points& x, const ShellEdge& e, const Fit& fit) const;

  int nodes_ = 0;
  std::vector<ShellEdge> edges_;
  std::vector<std::array<int, 3>> of_triangle_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<Row> rows_;
  std::vector<Term> terms_;
  std::vector<Vec3> normals_;
};

}  // namespace valsalva::structure
