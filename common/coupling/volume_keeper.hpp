// Keeps the volume of every part of immersed solids.
//
// The fluid's velocity is free of divergence, and so bodies that move with it keep the volume of each of
// their parts. What nodes take of it (quadrature and averages over elements, or linear interpolation between
// nodes) is so only up to the truncation error, and nothing brings such a change of volume back: the body's
// volumetric stress is answered by a pressure of the fluid inside the body, without motion. It accumulates.
// In a bar two cells thick, parts above and below the middle plane came to differ in volume by three times
// the strain of bending, with the opposite deviatoric strain: the bar lost its stiffness against bending.
//
// So the volumes V_c of the parts are constraints. With G = dV/dx, H the projector on held directions,
// P = 1 - H and m_a the volume that belongs to a node (sampling.hpp), the coupling's interpolation J and
// spreading S = J^T become M J and S M^T,
//   M = 1 - P m^-1 G^T (G P m^-1 G^T)^-1 G,
// on the same shape: adjoint, so that forces do on the fluid the work that they do on the body, and no energy
// comes in. Forces and torques of free bodies are kept, as G of a rigid motion is zero. The nearest velocity
// is meant in the integral over the body: then forces m_a f(x_a) of a density f that would drive no change of
// volume pass. (With all nodes alike a uniform f does not, as nodes of the surface have half the volume, and
// the load on a bar of two cells was wrong by a third.) What the shape's change within a step leaves (second
// order in dt) is taken back with the next.
//
// Parts: each hexahedron (a mean volume, as the constant pressure of Q1-P0 elements: no locking); of
// tetrahedra, which would lock, those around each node together.
#pragma once

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <span>
#include <vector>

#include "coupling/sampling.hpp"

namespace valsalva::coupling {

class VolumeKeeper {
 public:
  /// Of the cells those with volume count; start: where they have theirs. held: projectors on held
  /// directions, one a node, or empty. Up to most_direct parts G P m^-1 G^T is factorised in every step,
  /// beyond that solved with conjugate gradients to 1e-10.
  VolumeKeeper(std::span<const Cell> cells, const Points& start, const std::vector<Mat3>& held,
               int most_direct = 1500);

  bool empty() const { return cells_.empty(); }
  /// The shape that the following calls are about. NumericalFailure when parts have collapsed.
  void update(const Points& x);
  /// F := M^T F + what the constraint pulls at held directions. The first entries are the nodes'.
  void constrain_force(Points& force) const;
  /// U := M U, the nearest velocity (in the integral) that keeps all volumes; with dt that which takes their
  /// change back in dt.
  void constrain_velocity(Points& velocity) const;
  void constrain_velocity(Points& velocity, double dt_s) const;
  /// The largest relative change of a part's volume.
  double largest_change(const Points& x) const;

 private:
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  double volume(const Cell& cell, const Points& x, std::array<Vec3, 8>* gradient) const;
  Eigen::VectorXd volumes(const Points& x) const;
  Eigen::VectorXd pressures(const Eigen::VectorXd& growth) const;
  void constrain_velocity(Points& velocity, const Eigen::VectorXd& growth) const;

  std::vector<Cell> cells_;
  std::vector<std::vector<int>> parts_of_;  // of each cell: the parts that it belongs to
  Eigen::VectorXd start_, now_;             // volumes
  std::vector<Mat3> held_;
  std::vector<double> measure_;      // of the volume that belongs to a node; the mean is 1
  Sparse gradient_, free_gradient_;  // G, G P m^-1
  bool direct_;
  Eigen::SparseMatrix<double> product_;  // G P m^-1 G^T
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors_;
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> iterations_;
  Eigen::Index analysed_ = -1;                      // entries of the product whose pattern the factors know
  std::vector<Eigen::Matrix<double, 3, 8>> slope_;  // of the hexahedron's functions at the Gauss points
  std::vector<double> weight_;
};

}  // namespace valsalva::coupling
