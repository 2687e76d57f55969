// Shape functions and quadrature of solid elements and of their faces. Numbering is VTK's:
//   tet4 (VTK 10), tet10 (24), hex8 (12), hex27 (29);  faces tri3 (5), quad4 (9), tri6 (22), quad9 (28).
// Tetrahedra: coordinates r, s, t >= 0, r + s + t <= 1; hexahedra and quadrilaterals: -1 to 1.
//
// Rules:
//   stiffness   tet4 1 point, tet10 4 (exact for the quadratic strain energy of straight elements; curved
//   ones pass the patch test only with the rich rule), hex8
//               2x2x2, hex27 3x3x3, tri3 1, tri6 6, quad4 2x2, quad9 3x3
//   rich        tet4 4, tet10 14 points (degree 5, positive; Walkington 2000); the others as above. The mixed
//               tet10 needs it: with 4 points, 5 distortional strains each and one pressure, the element has
//               more zero-energy modes than the six rigid ones.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/types.hpp"

namespace valsalva::structure {

enum class Shape : std::uint8_t {
  triangle3 = 5,
  quad4 = 9,
  tet4 = 10,
  hex8 = 12,
  triangle6 = 22,
  tet10 = 24,
  quad9 = 28,
  hex27 = 29
};

inline constexpr int most_nodes = 27;
inline constexpr int most_points = 27;

int nodes_of(Shape shape);
int dimension_of(Shape shape);
std::string name_of(Shape shape);

struct ShapeValues {
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most_nodes, 1> value;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, most_nodes> gradient;  ///< by the element's coordinates
};
ShapeValues evaluate(Shape shape, const Vec3& at);

/// The element's own coordinates of its nodes.
std::vector<Vec3> node_coordinates(Shape shape);

struct QuadraturePoint {
  Vec3 at;
  double weight;
};
enum class Rule { stiffness, rich };
std::vector<QuadraturePoint> quadrature(Shape shape, Rule rule);

/// The faces of a solid element, outward by the right-hand rule, as its local nodes in VTK's order.
struct LocalFace {
  Shape shape;
  std::vector<int> nodes;
};
std::vector<LocalFace> faces_of(Shape shape);

}  // namespace valsalva::structure
