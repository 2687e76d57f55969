// The surface of a solid mesh and what acts on it.
//
// Pressure follows the surface: traction -p n on the present area, n outward,
//   f_a = -p integral N_a (x,r x x,s) dr ds,   K_ab = p integral N_a (N_b,s [x,r]x - N_b,r [x,s]x) dr ds,
// the exact tangent, unsymmetric for an open surface. Traction t on the reference area is a dead load,
//   f_a = integral N_a t dA.  Pa.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "structure/solid.hpp"

namespace valsalva::structure {

struct SolidFace {
  Shape shape;             ///< tri3, quad4, tri6 or quad9
  std::vector<int> nodes;  ///< of the mesh, outward, in VTK's order
  int element;
};

/// Faces that belong to one element only, in the order of the elements.
std::vector<SolidFace> boundary_faces(const SolidMesh& mesh);

/// Those whose corners all satisfy the condition on their reference positions.
std::vector<SolidFace> faces_where(const SolidMesh& mesh, const std::function<bool(const Vec3&)>& inside);

/// Nodal forces of a traction on the reference area, one entry a node of the mesh.
Points traction_forces(const SolidMesh& mesh, const std::vector<SolidFace>& faces,
                       const std::function<Vec3(const Vec3&)>& traction_Pa);

class SolidPressureTerm : public ForceTerm {
 public:
  /// pressure_Pa: of the time in s (the load factor in statics); positive pushes inwards.
  SolidPressureTerm(std::string name, std::vector<SolidFace> faces, const Body& body,
                    std::function<double(double)> pressure_Pa);
  std::string name() const override { return name_; }
  double add_forces(const Configuration& now, Forces& out) const override;
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override;
  void add_tangent(const Configuration& now, BlockMatrix& out) const override;

 private:
  struct Point {
    double weight;
    ShapeValues shape;
  };
  struct Face {
    std::vector<int> nodes;  // of the system
    std::size_t rule;
  };
  // The columns x,r and x,s at a point.
  static std::array<Vec3, 2> tangents(const Points& x, const Face& face, const Point& point);

  std::string name_;
  std::vector<std::vector<Point>> rules_;
  std::vector<Face> faces_;
  std::function<double(double)> pressure_;
};

}  // namespace valsalva::structure
