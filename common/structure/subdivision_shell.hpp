// A Kirchhoff-Love shell on Loop's subdivision surface: large rotations, any plane-stress law, positions
// only.
//
//   E = integral W(c, k) dA over the reference,  c from a_ab = x,a . x,b,  k from b_ab = n . x,ab,
// n the unit normal, W the section's energy (subdivision_section.hpp). The surface is that of
// subdivision_surface.hpp: what a node of the System is, how borders are held, and how to get surface points
// is said there. With N the basis functions at a quadrature point,
//   force on vertex a = -w [N,a (n^ab x,b - m^bc G^a_bc n) + N,ab m^ab n],
// n^ab, m^ab the resultants and G the Christoffel symbols of the present surface. Tangent: material and
// geometric part, exact. Sources: Cirak, Ortiz and Schroeder 2000; Cirak and Ortiz 2001 (finite deformation).
//
// Quadrature: one or three points a triangle; on triangles at irregular nodes three in each of their four
// quarters, if three are asked for. Convergence and cost, also against hinges: docs/verification/shells.md.
//
// Limits: no transverse shear (thickness below a tenth of the span of a wave); the mesh finer than the radius
// of curvature; no creases inside the surface.
// Lengths mm, stress Pa, energy nJ, force uN.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "structure/force_term.hpp"
#include "structure/shell.hpp"
#include "structure/subdivision_section.hpp"
#include "structure/subdivision_surface.hpp"

namespace valsalva::structure {

enum class ShellQuadrature { one, three };

struct LayerStates {
  ElementState bottom, middle, top;  ///< at zeta = -t/2, 0, t/2 along the normal
};

class SubdivisionShell {
 public:
  /// mesh.reference: points of the stress-free surface (its control net, if so given); thickness per node,
  /// fibres and stiffness factor per triangle. InputError as Shell and SubdivisionSurface.
  SubdivisionShell(ShellMesh mesh, std::shared_ptr<const SectionModel> section,
                   const EdgeConditions& conditions = {}, ShellQuadrature quadrature = ShellQuadrature::three,
                   SubdivisionSurface::Given given = SubdivisionSurface::Given::surface);

  int nodes() const { return surface_.nodes(); }
  int elements() const { return surface_.elements(); }
  const ShellMesh& mesh() const { return mesh_; }
  const SubdivisionSurface& surface() const { return surface_; }
  /// Positions that the System's nodes have in the stress-free shape.
  const Points& reference() const { return surface_.reference(); }
  double reference_area(int element) const;
  double thickness(int element) const;
  /// A third of every adjacent triangle's mass, integrated over its surface: positive, the total exact.
  std::vector<double> lumped_mass(double density_g_per_mm3) const;
  std::vector<double> lumped_area() const;

  /// f[offset + a] += force on node a of the body, whose position is x[offset + a]; returns the energy.
  /// Independent of the number of threads. A share of the work gives a share of force and energy.
  double add_forces(const Points& x, Points& f, int offset = 0, Part part = {},
                    std::span<const Mat3> clamps = {}) const;
  /// The consistent tangent.
  void add_tangent(const Points& x, BlockMatrix& out, int offset = 0,
                   std::span<const Mat3> clamps = {}) const;
  /// Absolute row sums of the positive semi-definite tangent (SubdivisionTangent).
  void add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset = 0) const;
  /// out += K direction with that tangent.
  void add_tangent_product(const Points& x, const Points& direction, Points& out) const;

  /// In the middle surface, at the triangle's centre.
  ElementState element_state(const Points& x, int element, int offset = 0) const;
  LayerStates layer_states(const Points& x, int element, int offset = 0) const;
  /// The largest exponent Q over all quadrature points.
  double max_exponent(const Points& x, int offset = 0) const;

  /// A quadrature point of the surface, for loads: vertices and basis functions.
  struct Quadrature {
    std::span<const int> vertices;
    const double* basis;  ///< 6 a vertex: value, d/dr, d/ds, d2/dr2, d2/ds2, d2/drds
    double area;          ///< its share of the reference area
    double parameter;     ///< its share of the parameter domain, so that dA = |x,r x x,s| parameter
  };
  int quadrature_points() const { return static_cast<int>(points_.size()); }
  Quadrature quadrature_point(int point) const;
  /// Quadrature points of an element: from first to last, not included.
  std::array<int, 2> points_of(int element) const {
    return {elements_[element].point, elements_[element + 1].point};
  }

 private:
  friend class SubdivisionTangent;
  using Jet = Eigen::Matrix<double, 3, 5>;  // x,1 x,2 x,11 x,22 x,12
  using Hessian = Eigen::Matrix<double, 15, 15>;
  struct Point {
    int basis;  // first of its numbers in basis_
    double parameter, area;
    Eigen::Matrix2d map;  // inverse of the reference tangents in an orthonormal basis
    SectionPoint section;
  };
  struct Element {
    int vertex, point;  // first of its own
  };
  struct Response;
  Point make_point(int element, int basis, const BasisTable& table, const TrianglePatch& patch, double r,
                   double s, double parameter, const Points& vertices) const;
  Jet jet(const Points& vertices, int element, const Point& p) const;
  Response respond(const Point& p, const Jet& j) const;
  double element_forces(const Points& vertices, int element, Vec3* force) const;
  Hessian hessian(const Point& p, const Jet& j, bool positive) const;
  // Stiffness of the element's vertices.
  void element_tangent(const Points& vertices, int element, bool positive, Eigen::MatrixXd& k) const;
  int vertices_of(int element) const { return elements_[element + 1].vertex - elements_[element].vertex; }
  ElementState layer_state(const Point& p, const Jet& j, double height) const;

  ShellMesh mesh_;
  std::shared_ptr<const SectionModel> section_;
  SubdivisionSurface surface_;
  std::vector<Element> elements_;  // one more than there are
  std::vector<int> vertices_;
  std::vector<Point> points_;
  std::vector<double> basis_;
  std::vector<std::array<int, 2>> gather_;  // per vertex: range in gather_slots_
  std::vector<int> gather_slots_;           // element slots (indices of vertices_) of each vertex, ascending
};

/// The tangent made positive semi-definite, in two phases, for power iteration: update once, apply many
/// times. The membrane stress's negative eigenvalue is cut off, the moments' geometric part left out.
class SubdivisionTangent {
 public:
  explicit SubdivisionTangent(const SubdivisionShell& shell, Part part = {});
  void update(const Points& x, int offset = 0);
  /// out[offset + a] += (K direction)[a]
  void apply(const Points& direction, Points& out, int offset = 0) const;
  /// Absolute row sums: per node, the largest of its three rows; an upper bound.
  void add_row_sums(std::vector<double>& bound, int offset = 0) const;

 private:
  const SubdivisionShell& shell_;
  int begin_, end_;
  std::vector<Eigen::MatrixXd> element_;
};

/// A shell body as one force term of a System.
class SubdivisionTerm : public ForceTerm {
 public:
  SubdivisionTerm(std::shared_ptr<const SubdivisionShell> shell, const Body& body)
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
  const SubdivisionShell& shell() const { return *shell_; }
  /// How the clamps have turned since the reference, at a time.
  void set_clamps(std::function<std::vector<Mat3>(double time_s)> clamps) { clamps_ = std::move(clamps); }

 private:
  std::shared_ptr<const SubdivisionShell> shell_;
  Body body_;
  std::function<std::vector<Mat3>(double)> clamps_ = [](double) { return std::vector<Mat3>(); };
};

}  // namespace valsalva::structure
