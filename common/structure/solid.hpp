// A solid body of tetrahedra and hexahedra, total Lagrangian, with any materials::SolidLaw.
//
// displacement:  E = sum_q w [W + U](C_q),  F = sum_a x_a (x) grad N_a,  C = F^T F;  f_a = -sum_q w F S grad
//   N_a;
//   K = B^T D B + (grad N_a . S grad N_b) 1. Locks as the bulk modulus exceeds some 50 shear moduli (tet4 and
//   hex8 badly, also in bending; tet10 and hex27 mildly).
// mixed:         E = sum_q w [W(C_q) + U(theta_q)],  theta = projection of J = det F on discontinuous
// functions.
//   It is the three-field form of Simo, Taylor and Pister 1985 with dilatation and pressure condensed in the
//   element, p = projection of U'(theta), which leaves an energy of the positions alone and a symmetric
//   tangent K = K(S + p J C^-1) + G H G^T, G = d(projection of J)/dx, H = projection of U''.
//     hex8   Q1P0: theta constant (mean dilatation). Not inf-sup stable: pressures may alternate on regular
//            meshes (average them); displacements are good.
//     hex27  Q2P1: theta = a + b.(X - X_c), in reference coordinates, so that order 3 holds on general
//            meshes. Stable; the element of choice for stress near the incompressible limit.
//     tet10  averages at the corners: theta_a = integral l_a J / V_a, V_a = integral l_a, l_a the linear
//            shape functions; U at corners, sum_a V_a U(theta_a). In the limit the constraint is that of
//            Taylor and Hood's P2P1 (continuous linear pressure; inf-sup stable, order 3), whose compliance
//            1/K is lumped here; that costs a relative error of (mu/K) h^2, so the part of U that cannot
//            lock, as if K were local_bulk_per_shear x mu, is integrated point by point instead. One pressure
//            an element (P2P0) was measured and dropped: order 2; discontinuous P1 has as many constraints
//            as unknowns and locks.
//     tet4   the same averages with the one-point rule, theta_a = sum_e V_e J_e / sum_e V_e (Bonet and Burton
//            1998), nothing point by point. W is not averaged: bending stays stiff; pressures may oscillate.
//   Averages couple all nodes around a corner; BlockMatrix keeps these terms apart from the matrix.
//   All need a finite bulk modulus (1e5 shear moduli are fine for the direct solver).
// St. Venant-Kirchhoff and Fung laws without volumetric term cannot be split: displacement only.
//
// Mass: HRZ lumping (Hinton, Rock and Zienkiewicz 1976), m_a ~ integral N_a^2: positive on quadratic
// elements. A reversed element (J <= 0 at a point) is a NumericalFailure that names it: integrators halve the
// step. Lengths mm, stress Pa, energy nJ, force uN, density g/mm3.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "materials/solid_law.hpp"
#include "structure/element_shapes.hpp"
#include "structure/force_term.hpp"

namespace valsalva::structure {

enum class Formulation { displacement, mixed };

/// Bulk modulus, in shear moduli at rest, up to which the mixed tet10 takes U point by point (Poisson's ratio
/// 0.35). More costs accuracy where the stress is singular, less costs order in compressible bodies.
inline constexpr double local_bulk_per_shear = 3;

struct SolidMesh {
  Points reference;               ///< the stress-free shape
  std::vector<int> connectivity;  ///< flat, VTK's numbering
  std::vector<int> offsets;       ///< elements + 1
  std::vector<Shape> shapes;
  std::vector<Vec3> fibre1, fibre2;      ///< per element, in the reference; empty: no fibres
  std::vector<double> stiffness_factor;  ///< per element: multiplies the law's matrix part; empty: 1

  int elements() const { return static_cast<int>(shapes.size()); }
  std::span<const int> nodes_of(int element) const {
    return {connectivity.data() + offsets[element], connectivity.data() + offsets[element + 1]};
  }
  void add(Shape shape, std::span<const int> nodes);
};

/// What is known at a quadrature point.
struct SolidPoint {
  Vec3 reference;       ///< where it lies in the reference
  double volume_mm3;    ///< its share of the reference volume
  Mat3 deformation;     ///< F
  Mat3 cauchy_Pa;       ///< with the mixed pressure, where there is one
  Vec3 principal_Pa;    ///< ascending
  double von_mises_Pa;  ///< of the Cauchy stress
  double volume_ratio;  ///< det F
  Vec3 stretch;         ///< principal, ascending
  double exponent;      ///< the largest Q of the law's exp(Q)
  double energy_Pa;     ///< strain energy per reference volume
};

class Solid {
 public:
  /// InputError names the element that is reversed or flat in the reference, or the entry that is wrong.
  Solid(SolidMesh mesh, std::shared_ptr<const materials::SolidLaw> law, Formulation formulation);

  int nodes() const { return static_cast<int>(mesh_.reference.size()); }
  int elements() const { return mesh_.elements(); }
  const SolidMesh& mesh() const { return mesh_; }
  Formulation formulation() const { return formulation_; }
  double volume() const;
  std::vector<double> lumped_mass(double density_g_per_mm3) const;

  /// f[offset + a] += force on node a, whose position is x[offset + a]; returns the energy. Independent of
  /// the number of threads.
  double add_forces(const Points& x, Points& f, int offset = 0) const;
  /// The consistent tangent.
  void add_tangent(const Points& x, BlockMatrix& out, int offset = 0) const;
  /// Absolute row sums of it, the largest of a node's three rows, summed over elements.
  void add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset = 0) const;
  /// Stress and strain at the element's quadrature points.
  std::vector<SolidPoint> points_of(const Points& x, int element, int offset = 0) const;
  /// The same of all elements; the pressures of the averages are found once.
  std::vector<std::vector<SolidPoint>> all_points(const Points& x, int offset = 0) const;

 private:
  using ElementPoints = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, most_nodes>;
  struct Point {
    double weight;
    std::size_t gradient;   // into gradients_, 3 x nodes
    Eigen::Vector4d modes;  // orthonormal functions of theta at this point; of averages: the corners' l_a
    Vec3 reference;
  };
  struct Element {
    int first, count;  // into points_
    int modes;         // 0: displacement, or averages at the corners
    materials::Fibres fibres;
    double factor;
  };
  // The volumetric state of the patches of tetrahedra: per node.
  struct NodalPressure {
    std::vector<double> pressure, curvature;  // U'(theta), U''(theta)/V
    double energy = 0;
  };
  struct Deformed;

  void check(const SolidMesh& mesh) const;
  void build_elements();
  void build_modes(int element, Shape shape);
  bool averaged(int element) const {
    return formulation_ == Formulation::mixed &&
           (mesh_.shapes[element] == Shape::tet4 || mesh_.shapes[element] == Shape::tet10);
  }
  // The part of U that is integrated point by point, and that of the averages.
  double local_share(int element) const { return mesh_.shapes[element] == Shape::tet10 ? local_share_ : 0; }
  double patch_share(int node) const { return 1 - local_share(patches_[node].front()); }
  Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> gradient(int element, const Point& p) const;
  NodalPressure nodal_pressures(const Points& x, int offset) const;
  Deformed deform(const Points& x, int offset, int element, const NodalPressure& nodal) const;
  materials::ElasticResponse respond(int element, const Deformed& d, int point,
                                     materials::Derivatives wanted) const;
  double element_forces(const Points& x, int offset, int element, const NodalPressure& nodal,
                        Vec3* force) const;
  Eigen::MatrixXd element_tangent(const Points& x, int offset, int element, const NodalPressure& nodal) const;
  std::vector<SolidPoint> points_of(const Points& x, int element, int offset,
                                    const NodalPressure& nodal) const;
  // Calls use(nodes of the patch, d(V theta)/dx, U''/V) for every corner with averages.
  template <class Use>
  void for_each_patch(const Points& x, int offset, const NodalPressure& nodal, const Use& use) const;

  SolidMesh mesh_;
  std::shared_ptr<const materials::SolidLaw> law_;
  Formulation formulation_;
  std::vector<Element> elements_;
  std::vector<Point> points_;
  std::vector<double> gradients_;
  double local_share_ = 0;
  std::vector<std::vector<int>> patches_;  // per node: the tetrahedra that are averaged there
  std::vector<std::vector<int>> patch_nodes_;
  std::vector<double> patch_volume_;
};

/// A solid body as one force term of a System.
class SolidTerm : public ForceTerm {
 public:
  SolidTerm(std::shared_ptr<const Solid> solid, const Body& body) : solid_(std::move(solid)), body_(body) {}
  std::string name() const override { return body_.name; }
  double add_forces(const Configuration& now, Forces& out) const override;
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override;
  void add_tangent(const Configuration& now, BlockMatrix& out) const override;
  const Solid& solid() const { return *solid_; }

 private:
  std::shared_ptr<const Solid> solid_;
  Body body_;
};

}  // namespace valsalva::structure
