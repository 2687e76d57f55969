// A thin shell: constant-strain triangles for the membrane, hinges for bending.
//
// Membrane: F = D_s D_m^-1 (3x2), C = F^T F, energy t A W(C) with a plane-stress law of
// materials/plane_stress.hpp.
//
// Bending: E = 1/2 D |e|^2 / (A1 + A2) (theta - theta0)^2 at every inner edge e, theta the angle between the
// normals of its two triangles, theta0 that of the reference shape, D = E t^3 / (12 (1 - nu^2)). The form is
// that of Grinspun, Hirani, Desbrun and Schroeder 2003, Discrete Shells, eq. 2; the constant is the one that
// gives the plate's energy when a regular mesh is rolled up along its lines (their 3 |e|^2/A would be three
// times too stiff), and agrees with Seung and Nelson 1988 on equilateral triangles. Hinges depend on the
// mesh: on skewed ones they are off by tens of percent, and refinement does not mend it.
//
// Limits: thin (thickness below about the edge length), no transverse shear.
// Lengths mm, stress Pa, energy nJ, force uN.
#pragma once

#include <memory>
#include <vector>

#include "core/types.hpp"
#include "materials/plane_stress.hpp"
#include "structure/block_matrix.hpp"

namespace valsalva::structure {

struct ShellMesh {
  Points reference;  ///< the stress-free shape
  std::vector<Triangle> triangles;
  std::vector<double> thickness_mm;  ///< per node
  std::vector<Vec3> fibre1, fibre2;  ///< per triangle, in the reference; empty: no fibres (isotropic)
  std::vector<double>
      stiffness_factor;  ///< per triangle: multiplies the law's matrix part and bending; empty: 1
};

struct Bending {
  double modulus_Pa = 0;  ///< Young's modulus in bending; 0: membrane only
  double poisson = 0.5;
};

/// One share of the work, for dividing it among MPI ranks: share `index` of `count`.
struct Part {
  int index = 0;
  int count = 1;
};

struct ElementState {
  double von_mises_Pa = 0;   ///< of the Cauchy stress in the plane
  double stretch_major = 1;  ///< principal stretches in the plane
  double stretch_minor = 1;
  double exponent = 0;  ///< the largest Q of the law's exp(Q) here
};

class Shell {
 public:
  /// InputError names the triangle that is degenerate or the entry that has a wrong size or value.
  Shell(ShellMesh mesh, std::shared_ptr<const materials::PlaneLaw> law, Bending bending);

  int nodes() const { return static_cast<int>(mesh_.reference.size()); }
  int elements() const { return static_cast<int>(mesh_.triangles.size()); }
  int hinges() const { return static_cast<int>(hinges_.size()); }
  const ShellMesh& mesh() const { return mesh_; }
  double reference_area(int element) const { return elements_[element].area; }
  double thickness(int element) const { return elements_[element].thickness; }
  /// Lumped: a third of every adjacent triangle's mass.
  std::vector<double> lumped_mass(double density_g_per_mm3) const;
  /// A third of every adjacent triangle's reference area.
  std::vector<double> lumped_area() const;

  /// f[offset + a] += force on node a of the body, whose positions are x[offset + a]; returns the energy.
  /// Independent of the number of threads. A share of the work gives a share of force and energy, and the
  /// largest exponent Q in it.
  double add_forces(const Points& x, Points& f, int offset = 0, Part part = {},
                    double* largest_exponent = nullptr) const;

  /// out += K direction, K the tangent at x made positive semi-definite: the material tangent is so by
  /// construction, the negative eigenvalue of the geometric 2x2 stress is cut off, hinges by Gauss-Newton.
  void add_tangent_product(const Points& x, const Points& direction, Points& out) const;

  /// Absolute row sums of that tangent (per node, summed over its three rows' largest), added to bound[offset
  /// + a].
  void add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset = 0) const;

  /// The consistent tangent: geometric part not clipped, hinges by central differences of their gradient
  /// (1e-6 of the edge).
  void add_tangent(const Points& x, BlockMatrix& out, int offset = 0) const;

  ElementState element_state(const Points& x, int element, int offset = 0) const;
  /// The largest exponent Q over all elements; the law's exponential is continued beyond Q = 6.
  double max_exponent(const Points& x, int offset = 0) const;
  /// Signed angle of hinge h at x, and in the reference.
  double hinge_angle(const Points& x, int hinge, int offset = 0) const;

 private:
  friend class ShellTangent;
  struct Element {
    double area, thickness, factor;
    Eigen::Matrix2d inverse_edges;  // D_m^-1 in the element's own basis
    materials::PlaneFibres fibres;
  };
  struct Hinge {
    std::array<int, 4> nodes;      // edge 0-1, opposite 2 and 3
    double rest_angle, stiffness;  // stiffness = D |e|^2 / (A1 + A2)
  };
  // Elements and hinges are evaluated in groups of eight (materials/lanes.hpp): number g holds 8 g to 8 g +
  // 7, the last one repeats its last.
  using Lanes = materials::Lanes;
  using LaneVector = std::array<Lanes, 3>;
  struct ElementGroup {
    std::array<std::array<Lanes, 2>, 2> inverse_edges;
    Lanes volume, factor;
    std::array<std::array<Lanes, 2>, 2> fibre;
  };
  struct HingeGroup {
    Lanes rest_angle, stiffness;
  };
  struct GroupForces {
    std::array<LaneVector, 4> force;  // of the corners
    Lanes energy, exponent;
  };
  // Never inlined: the compiler would fuse products differently in the loops of one and of many threads.
  [[gnu::noinline]] void element_forces(const Points& x, int offset, int group, GroupForces& out) const;
  [[gnu::noinline]] void hinge_forces(const std::array<LaneVector, 4>& at, const HingeGroup& group,
                                      GroupForces& out) const;
  void hinge_forces(const Points& x, int offset, int group, GroupForces& out) const;
  void build_groups();
  Eigen::MatrixXd hinge_tangent(const Points& x, int offset, int hinge) const;
  void build_elements();
  void build_hinges(const Bending& bending);

  ShellMesh mesh_;
  std::shared_ptr<const materials::PlaneLaw> law_;
  std::vector<Element> elements_;
  std::vector<Hinge> hinges_;
  std::vector<ElementGroup> element_groups_;
  std::vector<HingeGroup> hinge_groups_;
};

/// The tangent in two phases, for power iteration: update once, apply many times.
class ShellTangent {
 public:
  enum class Geometric { clipped, exact };  ///< the part of the membrane stress
  explicit ShellTangent(const Shell& shell, Part part = {}, Geometric geometric = Geometric::clipped);
  void update(const Points& x, int offset = 0);
  /// out[offset + a] += (K direction)[a]
  void apply(const Points& direction, Points& out, int offset = 0) const;
  /// Absolute row sums: per node, the largest of its three rows; summed over elements (an upper bound).
  void add_row_sums(std::vector<double>& bound, int offset = 0) const;
  /// The membrane's matrices.
  void add_membrane(BlockMatrix& out, int offset = 0) const;

 private:
  using ElementMatrix = Eigen::Matrix<double, 9, 9>;
  using HingeVector = Eigen::Matrix<double, 12, 1>;
  const Shell& shell_;
  Part part_;
  Geometric geometric_;
  std::vector<ElementMatrix> element_;
  std::vector<HingeVector> hinge_;  // sqrt(k) grad(theta)
};

}  // namespace valsalva::structure
