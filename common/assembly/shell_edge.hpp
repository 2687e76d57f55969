// The rotation of a hinge shell's edge where a support holds it: a clamp or a symmetry plane. Shell nodes
// have no rotations, and a hinge needs two triangles; here the second is the mirror image of the first.
//
// With N the triangle's unit normal, m the plane's (for a clamp: in the sheet, across the edge, turned with
// the support), the mirrored normal makes the angle 2 phi with N, sin phi = N . m, and half of the energy of
// the hinge between both (structure/shell.hpp) is
//   E = 1/2 k (phi - phi0)^2,   k = D |e|^2 / A,   D = E t^3 / (12 (1 - nu^2)).
// Tangent by central differences of the forces. nJ, uN.
#pragma once

#include "assembly/body.hpp"
#include "assembly/supports.hpp"

namespace valsalva::assembly {

/// What the supports (tethers left out) ask of the border edges of a Kirchhoff shell; clamps turn with the
/// support of their number.
structure::EdgeConditions edge_conditions(const BuiltBody& body, const std::vector<Support>& supports);

class ShellEdgeTerm : public structure::ForceTerm {
 public:
  /// Border edges of the shell with both nodes in the support, whose rotation about the edge is held.
  ShellEdgeTerm(const BuiltBody& body, const Support& support);
  bool empty() const { return edges_.empty(); }
  std::string name() const override { return name_; }
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  void add_tangent(const structure::Configuration& now, structure::BlockMatrix& out) const override;

 private:
  struct Edge {
    std::array<int, 3> nodes;  // of the system, counter-clockwise
    Vec3 mirror;               // m in the reference
    double stiffness, rest;
  };
  struct Bent {
    double energy;
    double torque;                 // k (phi - phi0)
    std::array<Vec3, 3> gradient;  // of phi
  };
  Bent bent(const Edge& edge, const std::array<Vec3, 3>& x, const Vec3& mirror) const;
  Vec3 mirror_of(const Edge& edge, double time_s) const;

  std::string name_;
  Motion motion_;
  std::vector<Edge> edges_;
};

}  // namespace valsalva::assembly
