// A Kirchhoff-Love shell of triangles whose only unknowns are positions: large rotations, any plane-stress
// law, any manifold mesh.
//
//   E = sum over triangles A [ W(c, k) + 1/6 sum over its edges (k_e - k) : D : (k_e - k) ],
//   c  metric of the flat triangle,   k_ab = 1/A sum over its edges L nu_a nu_b (n . d),   k_e,ab = n . x,ab,
// n the triangle's normal, nu the outward normal of an edge of length L in the reference triangle; d (turned
// outward) and x,ab the edge's vectors (kirchhoff_edges.hpp). By Gauss' theorem k is the mean of n . x,ab
// when d is the derivative of the position across the edge. W is the energy of the section
// (kirchhoff_section.hpp), D its bending stiffness at rest; k_e - k is counted from the reference shape.
//
// The first part is Morley's triangle (1968; constant moments, the slope of an edge seen alike from both
// sides) with the slopes not unknown but found from the nodes near by, so that they are exact for quadratic
// surfaces: a bending patch test is passed on every mesh, and as the two slopes at an edge differ by its
// hinge angle there is no motion without energy but rigid ones. The second part is what the rule of three
// points at the middles of the edges sees of a curvature that varies in the triangle. It vanishes with the
// square of the size, but without it short waves are too soft and a point load sinks in too deep (the
// compliance is off by 0.12 h^2/D, with it by 0.01 to 0.06; docs/verification/shells.md). D is constant: the
// law's stiffening acts on the mean curvature only. Rotation-free triangles with other slopes: Phaal and
// Calladine 1992; Onate and Zarate 2000; Flores and Onate 2005. Loop subdivision (Cirak and Ortiz 2001) was
// measured first: order 3 on regular meshes, but no convergence on unstructured ones.
//
// Nodes are points of the surface. A triangle's energy depends on 12 nodes at most: its own, its neighbours'
// and their neighbours'.
//
// Limits: no transverse shear; the mesh finer than the radius of curvature; no creases inside the surface (an
// angle of the reference shape stays, and bends elastically); the angle between neighbouring triangles well
// below one radian, in which the error is quadratic.
// Lengths mm, stress Pa, energy nJ, force uN.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "structure/force_term.hpp"
#include "structure/kirchhoff_edges.hpp"
#include "structure/kirchhoff_section.hpp"
#include "structure/shell.hpp"

namespace valsalva::structure {

struct LayerState : ElementState {
  Mat3 cauchy_Pa = Mat3::Zero();  ///< in space; of a plane, no stress along the normal
};

struct LayerStates {
  LayerState bottom, middle, top;  ///< at zeta = -t/2, 0, t/2 along the normal
  Mat3 gradient = Mat3::Zero();    ///< tangent vectors of the reference middle surface to present ones
};

class KirchhoffShell {
 public:
  /// thickness per node, fibres and stiffness factor per triangle. InputError as Shell and ShellEdges.
  KirchhoffShell(ShellMesh mesh, std::shared_ptr<const SectionModel> section,
                 const EdgeConditions& conditions = {});

  int nodes() const { return edges_.nodes(); }
  int elements() const { return static_cast<int>(elements_.size()); }
  const ShellMesh& mesh() const { return mesh_; }
  const ShellEdges& edges() const { return edges_; }
  double reference_area(int element) const { return elements_[element].area; }
  double thickness(int element) const { return elements_[element].section.thickness; }
  /// Lumped: a third of every adjacent triangle's mass, or area.
  std::vector<double> lumped_mass(double density_g_per_mm3) const;
  std::vector<double> lumped_area() const;

  /// f[offset + a] += force on node a of the body, whose position is x[offset + a]; returns the energy.
  /// Independent of the number of threads. A share of the work gives a share of force and energy. clamps:
  /// rotations of the clamps since the reference, by EdgeCondition::clamp; those not given have not turned.
  double add_forces(const Points& x, Points& f, int offset = 0, Part part = {},
                    std::span<const Mat3> clamps = {}) const;
  /// The consistent tangent.
  void add_tangent(const Points& x, BlockMatrix& out, int offset = 0,
                   std::span<const Mat3> clamps = {}) const;
  /// The tangent made positive semi-definite: the negative eigenvalues of the section's tangent and of its
  /// membrane force are cut off, the moments' geometric part is left out.
  void add_positive_tangent(const Points& x, BlockMatrix& out, int offset = 0) const;
  /// Absolute row sums of that tangent's elements: per node, the largest of its three rows; an upper bound.
  void add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset = 0) const;

  /// Of every element. Incompressible: the Cauchy stress is that for J = 1.
  std::vector<LayerStates> layer_states(const Points& x, int offset = 0) const;
  /// Curvature k - k0 of an element in its own basis (first edge, and across).
  Eigen::Matrix2d bending_strain(const Points& x, int element, int offset = 0) const;
  /// The largest exponent Q over all elements and layers; the laws' exponential is continued beyond Q = 6.
  double max_exponent(const Points& x, int offset = 0) const;

 private:
  // x,1 x,2, then d x,ss x,sy x,yy of each edge.
  static constexpr int jets = 2 + 3 * ShellEdges::vectors;
  using Jet = Eigen::Matrix<double, 3, jets>;
  using Hessian = Eigen::Matrix<double, 3 * jets, 3 * jets>;
  struct EdgeSample {
    double along[2];       // the edge's direction in the triangle's basis
    Eigen::Vector3d rest;  // k_e - k of the reference: 11, 22, 12
  };
  struct Element {
    std::array<int, 3> edges;
    double area;
    Eigen::Matrix<double, 2, 3> gradients;  // of the nodes' shape functions, in the reference triangle
    Eigen::Matrix3d bends;                  // x,11 x,22 x,12 (rows) by the edges' d
    std::array<EdgeSample, 3> samples;
    std::array<double, 3> sampled;  // the samples' areas
    Eigen::Matrix3d rigidity;       // D: moments 11, 22, 12 by curvatures 11, 22, 2 12
    SectionPoint section;
  };
  struct ElementForces {
    double energy;
    std::array<Vec3, 3> nodes;
    Vec3 normal;  // along which the edges' vectors are pulled
    Eigen::Matrix<double, ShellEdges::vectors, 3> edges;
  };
  struct Bending;
  void build_elements();
  void build_section(int element, const Vec3& e1, const Vec3& e2);
  Jet jet(const Points& vertices, int element) const;
  ElementForces element_forces(const Points& vertices, int element) const;
  Hessian hessian(const Element& e, const Jet& j, bool positive) const;
  void element_tangent(const Points& vertices, int element, bool positive, BlockMatrix::Piece& out) const;
  void add_tangents(const Points& vertices, bool positive, BlockMatrix& out, int offset) const;
  LayerState layer_state(const Element& e, const Jet& j, double height) const;

  ShellMesh mesh_;
  std::shared_ptr<const SectionModel> section_;
  ShellEdges edges_;
  std::vector<Element> elements_;
};

/// A shell body as one force term of a System.
class KirchhoffTerm : public ForceTerm {
 public:
  KirchhoffTerm(std::shared_ptr<const KirchhoffShell> shell, const Body& body)
      : shell_(std::move(shell)), body_(body) {}
  std::string name() const override { return body_.name; }
  double add_forces(const Configuration& now, Forces& out) const override {
    return shell_->add_forces(now.x, out.force, body_.offset, {}, clamps_(now.time_s));
  }
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override {
    shell_->add_stiffness_bound(now.x, out.translation, body_.offset);
  }
  void add_tangent(const Configuration& now, BlockMatrix& out) const override {
    shell_->add_tangent(now.x, out, body_.offset, clamps_(now.time_s));
  }
  const KirchhoffShell& shell() const { return *shell_; }
  /// How the clamps have turned since the reference, at a time.
  void set_clamps(std::function<std::vector<Mat3>(double time_s)> clamps) { clamps_ = std::move(clamps); }

 private:
  std::shared_ptr<const KirchhoffShell> shell_;
  Body body_;
  std::function<std::vector<Mat3>(double)> clamps_ = [](double) { return std::vector<Mat3>(); };
};

}  // namespace valsalva::structure
