// The linear systems of Newton's method, by PETSc.
//
//   direct      MUMPS: L D L^T when the matrix is symmetric (to 1e-8 of its largest entry), else L U; also
//   for
//               indefinite matrices, whose negative pivots it counts
//   multigrid   smoothed aggregation (GAMG) with the rigid motions as near-kernel, conjugate gradients, or
//               GMRES when unsymmetric; falls back to the direct solver when it does not converge
//   automatic   direct up to `direct_up_to` unknowns, then multigrid (docs/decisions/implicit.md)
// Rank-one terms c v v^T of the matrix become unknowns of their own, [K w; w^T -d] (indefinite: always
// direct). Prescribed unknowns are eliminated symmetrically. One process; PETSc is started at the first solve
// and ended with the program.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "structure/block_matrix.hpp"

namespace valsalva::solve {

enum class LinearMethod { automatic, direct, multigrid };

struct LinearSettings {
  LinearMethod method = LinearMethod::automatic;
  int direct_up_to = 300000;
  double tolerance = 1e-8;  ///< of multigrid, relative residual
  int max_iterations = 400;
};

struct LinearReport {
  bool symmetric = true;
  bool direct = true;
  int iterations = 0;       ///< of multigrid
  int negative_pivots = 0;  ///< of a direct symmetric solve: unstable modes
};

class LinearSolver {
 public:
  explicit LinearSolver(const LinearSettings& settings = {});
  ~LinearSolver();
  LinearSolver(const LinearSolver&) = delete;
  LinearSolver& operator=(const LinearSolver&) = delete;

  /// u[i] with fixed[i] is given; the others solve K u = rhs. `positions` of the nodes serve multigrid.
  /// NumericalFailure when the matrix is singular.
  LinearReport solve(const structure::BlockMatrix& k, const std::vector<std::uint8_t>& fixed,
                     const Eigen::VectorXd& rhs, Eigen::VectorXd& u, const Points& positions);

 private:
  struct Petsc;
  LinearSettings settings_;
  std::unique_ptr<Petsc> petsc_;
};

}  // namespace valsalva::solve
