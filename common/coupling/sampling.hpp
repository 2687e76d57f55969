// Coupling to the grid by element quadrature, with a density that follows the deformation.
//
//   spread:       F_q = w_q sum_a psi_a(q) F_a / m_a        at the points x_q = sum_a N_a(q) x_a
//   interpolate:  U_a = 1/m_a sum_q w_q psi_a(q) u(x_q),    sum_q w_q psi_a(q) N_b(q) = m_a delta_ab
//
// adjoint operators: force, torque and power are kept to round-off, and every velocity that is linear on the
// cells is exact. psi are the dual functions of the linear shape functions N (biorthogonal; Wohlmuth 2000,
// SIAM J. Numer. Anal. 38), element by element, in place of the mass matrix of Griffith and Luo 2017 (Hybrid
// finite difference/finite element immersed boundary method), sections 3 and 4. (With N and the lumped mass
// instead, nodes on the surface move like points inside: the body cannot turn freely, and is held by a
// spurious spring; docs/verification/coupling.md.) Points of a cell: the midpoints of an equal division of
// its edges into at least two, so that their distance is at most `spacing` in the present shape; equal
// weights, shares of the cell's reference measure. Where nodes are half a grid spacing apart, coupling at the
// nodes is cheaper.
//
// Cells are linear: lines, triangles, tetrahedra and hexahedra; quadratic elements are divided into linear
// ones over their nodes. A node without cell is a point itself, or is left out.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/types.hpp"
#include "structure/solid.hpp"

namespace valsalva::coupling {

/// 2 nodes: line, 3: triangle, 4: tetrahedron, 8: hexahedron (VTK's order).
struct Cell {
  int count = 0;
  std::array<int, 8> nodes{};
};

std::vector<Cell> cells_of(std::span<const Edge> lines, int offset = 0);
std::vector<Cell> cells_of(std::span<const Triangle> triangles, int offset = 0);
/// tet10: 8 tetrahedra; hex27: 8 hexahedra.
std::vector<Cell> cells_of(const structure::SolidMesh& mesh, int offset = 0);
/// The measure that belongs to each node: m_a, the integral of its function.
std::vector<double> nodal_measures(std::span<const Cell> cells, const Points& x);
/// Node pairs of all edges, each once.
std::vector<Edge> edges_of(std::span<const Cell> cells);

class Sampling {
 public:
  /// spacing: largest distance of neighbouring points, mm; about h/2. InputError when it is not positive.
  /// left_out: nodes without cell that do not couple (one entry a node; empty: none). They have no point, and
  /// come back with the velocity zero.
  Sampling(std::vector<Cell> cells, const Points& reference, double spacing_mm,
           const std::vector<std::uint8_t>& left_out = {});

  /// Chooses the points anew for these positions of the nodes.
  void locate(const Points& x);
  const Points& points() const { return points_; }
  /// at_points is resized; of a longer list of nodal forces the first entries count.
  void to_points(const Points& nodal_force, Points& at_points) const;
  /// at_nodes is resized.
  void to_nodes(const Points& point_velocity, Points& at_nodes) const;
  std::size_t nodes() const { return mass_.size(); }

 private:
  struct Rule {
    int points = 0, nodes = 0;
    std::vector<double> shape;  // N of each point, then psi of each point
  };
  struct Run {  // points of one cell
    int cell;
    const Rule* rule;
    double share;  // of the measure, each point
  };
  const Rule& rule(int count, const std::array<int, 3>& division);

  std::vector<Cell> cells_;
  std::vector<double> measure_, mass_;
  std::vector<int> alone_;  // nodes without cell
  double spacing_;
  std::map<std::array<int, 4>, Rule> rules_;
  std::vector<Run> runs_;
  Points points_;
};

}  // namespace valsalva::coupling
