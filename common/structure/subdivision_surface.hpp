// A Loop subdivision surface over a triangle mesh, its border included: the link between the nodes of a
// System, the vertices of the control net, and the points of the surface.
//
// Nodes of the System are control vertices, except on hinged and clamped border edges, where they are points
// of the surface, so that holding them holds the surface. The surface lies inside the control net, about
// h^2/8 times the curvature off it: what is shown, measured or touched is `surface(x)`, not x.
// Input is a mesh of points of the surface; the control net that interpolates them is solved for by
// x <- x + (X - surface(x)), whose error falls by 0.75 a step on regular meshes.
//
// The triangle mesh may be any manifold, with border, of any genus, in several pieces; it should be
// finer than its radius of curvature. Irregular nodes (valence other than 6; 3 on borders in triangles are
// regular) keep the surface smooth (C1, square-integrable curvature).
#pragma once

#include <span>

#include "structure/block_matrix.hpp"
#include "structure/subdivision_basis.hpp"
#include "structure/subdivision_ghosts.hpp"
#include "structure/subdivision_topology.hpp"

namespace valsalva::structure {

/// Which vertices a triangle's surface depends on, in the numbering of its TriangleRings.
struct TrianglePatch {
  std::vector<int> vertices;
  TriangleRings rings;
};

class SubdivisionSurface {
 public:
  enum class Given { surface, control_net };
  /// points: of the surface (or the control net), one a node. InputError as subdivision_topology, and when
  /// the control net cannot be found.
  SubdivisionSurface(const Points& points, const std::vector<Triangle>& triangles,
                     const EdgeConditions& conditions = {}, Given given = Given::surface);

  int nodes() const { return topology_.nodes; }
  int vertices() const { return topology_.vertices(); }
  int elements() const { return static_cast<int>(topology_.triangles.size()); }
  const SubdivisionTopology& topology() const { return topology_; }
  /// Positions of the nodes, as a System has them, in the reference.
  const Points& reference() const { return reference_; }
  TrianglePatch patch(int triangle) const;

  /// All vertices of the control net from nodes at x[offset...]. `clamps`: rotations of the clamps since the
  /// reference, by EdgeCondition::clamp; those not given have not turned.
  void gather(const Points& x, int offset, Points& vertices, std::span<const Mat3> clamps = {}) const;
  /// Their change with a change of the nodes.
  void gather_change(const Points& direction, int offset, Points& vertices) const;
  /// The transpose: forces on vertices become forces on nodes, added to f[offset...].
  void scatter(const Points& vertex_forces, Points& f, int offset) const;
  /// Adds a stiffness of some vertices (3 a vertex) to that of the nodes.
  void add_matrix(std::span<const int> vertices, const Eigen::Ref<const Eigen::MatrixXd>& k, BlockMatrix& out,
                  int offset) const;
  /// Sums of the factors' absolute values: of a vertex' nodes (gather), or back (scatter), for bounds.
  std::vector<double> gather_bound() const;
  void scatter_bound(const std::vector<double>& vertex_bound, std::vector<double>& bound, int offset) const;

  /// Where the nodes' points of the surface lie, for nodes at x[offset...].
  Points surface(const Points& x, int offset = 0, std::span<const Mat3> clamps = {}) const;
  /// The nodes whose surface passes through the given points, one a node (clamps not turned).
  Points nodes_of(const Points& surface_points) const;
  /// Control vertices and weights whose sum is the point of the surface at a node.
  std::vector<std::pair<int, double>> limit_weights(int node) const;

 private:
  bool is_node(int vertex) const { return row_of_[vertex] < 0; }
  void gather_linear(const Points& x, int offset, const VertexRows& rows, Points& vertices) const;
  void gather(const Points& x, int offset, const VertexRows& rows, Points& vertices,
              std::span<const Mat3> clamps) const;
  Points surface_of(const Points& vertices) const;
  Points solve_for(const Points& surface_points, const VertexRows& rows) const;

  SubdivisionTopology topology_;
  VertexRows rows_;
  std::vector<int> row_of_;  // per vertex, -1: is a node
  Points reference_;
};

}  // namespace valsalva::structure
