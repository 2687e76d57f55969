// Basis functions of Loop's subdivision surface on one triangle, with first and second derivatives.
//
// Regular triangle (three corners of valence 6): the 12 quartic box splines of its vertices and their
// neighbours. Irregular corners: the rings are subdivided until the point lies in a regular triangle, whose
// box splines are then expressed by the first ring's vertices; second derivatives do not exist at an
// irregular corner itself (they are bounded or grow weakly near it, and are square integrable).
// Sources: Loop 1987 (weights); Stam 1998, Evaluation of Loop subdivision surfaces (box spline polynomials);
// Cirak, Ortiz and Schroeder 2000 (use in shells).
//
// Parameters: barycentric coordinates (1 - r - s, r, s) of the corners 0, 1, 2.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace valsalva::structure {

/// Rows: value, d/dr, d/ds, d2/dr2, d2/ds2, d2/drds; one column a vertex.
using BasisTable = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Loop's weight of each neighbour in the rule of an old vertex: x' = (1 - n b) x + b sum x_k.
double loop_weight(int valence);
/// The same for the limit position of the vertex.
double loop_limit_weight(int valence);

/// The vertices that a triangle's surface depends on, and how they are joined: corner k has the neighbours
/// rings[k] in counter-clockwise order, beginning with corner k+1, corner k+2. All are indices from 0 to
/// vertices - 1; corners are 0, 1, 2.
struct TriangleRings {
  std::array<std::vector<int>, 3> rings;
  int vertices = 0;
  bool regular() const { return rings[0].size() == 6 && rings[1].size() == 6 && rings[2].size() == 6; }
};

/// The basis functions at a point that is not an irregular corner.
BasisTable loop_basis(const TriangleRings& triangle, double r, double s);

}  // namespace valsalva::structure
