#include "solve/linear_solver.hpp"

#include <petscksp.h>

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/petsc.hpp"

namespace valsalva::solve {

using petsc::require;
using structure::BlockMatrix;

namespace {

bool is_symmetric(const BlockMatrix& k, const std::vector<std::uint8_t>& fixed) {
  double largest = 0, difference = 0;
  for (int i = 0; i < k.slots(); ++i) {
    const BlockMatrix::Row& row = k.row(i);
    for (std::size_t n = 0; n < row.columns.size(); ++n) {
      const int j = row.columns[n];
      const BlockMatrix::Row& other = k.row(j);
      const auto at = std::lower_bound(other.columns.begin(), other.columns.end(), i);
      const bool present = at != other.columns.end() && *at == i;
      const Mat3 mirror =
          present ? Mat3(other.blocks[at - other.columns.begin()].transpose()) : Mat3(Mat3::Zero());
      for (int c = 0; c < 3; ++c)
        for (int d = 0; d < 3; ++d) {
          if (fixed[3 * i + c] || fixed[3 * j + d]) continue;
          largest = std::max(largest, std::abs(row.blocks[n](c, d)));
          difference = std::max(difference, std::abs(row.blocks[n](c, d) - mirror(c, d)));
        }
    }
  }
  return difference <= 1e-8 * largest;
}

}  // namespace

struct LinearSolver::Petsc {
  Mat matrix = nullptr;
  KSP solver = nullptr;
  Vec right = nullptr, left = nullptr;
  std::vector<PetscInt> rows, columns;
  std::vector<PetscScalar> values;
  long version = -1;
  const BlockMatrix* source = nullptr;
  bool symmetric = false, direct = false;
  int constraints = 0;  // unknowns of rank-one terms: each has a negative pivot of its own

  ~Petsc() { release(); }
  void release() {
    if (petsc::can_release()) {
      KSPDestroy(&solver);
      MatDestroy(&matrix);
      VecDestroy(&right);
      VecDestroy(&left);
    }
    solver = nullptr;
    matrix = nullptr;
    right = left = nullptr;
  }

  void fill(const BlockMatrix& k, const std::vector<std::uint8_t>& fixed, const Eigen::VectorXd& rhs,
            const Eigen::VectorXd& u, Eigen::VectorXd& b);
  void create(const Points& positions, const LinearSettings& settings);
  // False when it did not converge.
  bool run(const Eigen::VectorXd& b, Eigen::VectorXd& u, LinearReport& report);
};

void LinearSolver::Petsc::fill(const BlockMatrix& k, const std::vector<std::uint8_t>& fixed,
                               const Eigen::VectorXd& rhs, const Eigen::VectorXd& u, Eigen::VectorXd& b) {
  const int n = 3 * k.slots();
  const auto rank_ones = k.rank_ones();
  const int extra = static_cast<int>(rank_ones.size());
  rows.assign(1, 0);
  rows.reserve(n + extra + 1);
  columns.clear();
  values.clear();
  b = Eigen::VectorXd::Zero(n + extra);
  b.head(n) = rhs;
  double diagonal = 0;
  int free_rows = 0;
  for (int i = 0; i < k.slots(); ++i) {
    const BlockMatrix::Row& row = k.row(i);
    const auto own = std::lower_bound(row.columns.begin(), row.columns.end(), i) - row.columns.begin();
    for (int c = 0; c < 3; ++c)
      if (!fixed[3 * i + c]) diagonal += std::abs(row.blocks[own](c, c)), ++free_rows;
  }
  diagonal = free_rows > 0 && diagonal > 0 ? diagonal / free_rows : 1;
  const auto put = [&](int row, int column, double value) {
    if (column != row && column < n && fixed[column]) {
      b[row] -= value * u[column];
      value = 0;
    }
    columns.push_back(column);
    values.push_back(value);
  };
  // A term c v v^T as [0 w; w^T -d], w = v sqrt(c d), d of the size of the diagonal.
  const auto weight = [&](int t) { return std::sqrt(std::abs(rank_ones[t].factor) * diagonal); };
  std::vector<std::vector<std::pair<int, int>>> terms_at(extra > 0 ? k.slots() : 0);  // term, place in it
  for (int t = 0; t < extra; ++t)
    for (std::size_t m = 0; m < rank_ones[t].slots.size(); ++m)
      terms_at[rank_ones[t].slots[m]].emplace_back(t, static_cast<int>(m));
  for (int i = 0; i < k.slots(); ++i) {
    const BlockMatrix::Row& row = k.row(i);
    for (int c = 0; c < 3; ++c) {
      const int at = 3 * i + c;
      const bool held = fixed[at];
      if (held) b[at] = diagonal * u[at];
      for (std::size_t m = 0; m < row.columns.size(); ++m)
        for (int d = 0; d < 3; ++d) {
          const int column = 3 * row.columns[m] + d;
          if (held)
            columns.push_back(column), values.push_back(column == at ? diagonal : 0);
          else
            put(at, column, row.blocks[m](c, d));
        }
      if (extra > 0)
        for (const auto& [t, m] : terms_at[i]) {
          columns.push_back(n + t);
          values.push_back(held ? 0 : weight(t) * rank_ones[t].vector[3 * m + c]);
        }
      rows.push_back(static_cast<PetscInt>(columns.size()));
    }
  }
  for (int t = 0; t < extra; ++t) {
    const BlockMatrix::RankOne& term = rank_ones[t];
    for (std::size_t m = 0; m < term.slots.size(); ++m)
      for (int c = 0; c < 3; ++c)
        put(n + t, 3 * term.slots[m] + c, weight(t) * term.vector[3 * static_cast<Eigen::Index>(m) + c]);
    put(n + t, n + t, term.factor < 0 ? diagonal : -diagonal);
    rows.push_back(static_cast<PetscInt>(columns.size()));
  }
  constraints = static_cast<int>(
      std::count_if(rank_ones.begin(), rank_ones.end(), [](const auto& term) { return term.factor > 0; }));
}

void LinearSolver::Petsc::create(const Points& positions, const LinearSettings& settings) {
  const PetscInt n = static_cast<PetscInt>(rows.size()) - 1;
  require(
      MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, rows.data(), columns.data(), values.data(), &matrix),
      "matrix");
  require(MatSetOption(matrix, MAT_SYMMETRIC, symmetric ? PETSC_TRUE : PETSC_FALSE), "matrix option");
  require(MatCreateVecs(matrix, &right, &left), "vectors");
  require(KSPCreate(PETSC_COMM_SELF, &solver), "solver");
  require(KSPSetOperators(solver, matrix, matrix), "operators");
  PC pc = nullptr;
  require(KSPGetPC(solver, &pc), "preconditioner");
  if (direct) {
    require(KSPSetType(solver, KSPPREONLY), "solver type");
    require(PCSetType(pc, symmetric ? PCCHOLESKY : PCLU), "factorisation");
    require(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS), "MUMPS");
    require(PCFactorSetUpMatSolverType(pc), "MUMPS");
    Mat factor = nullptr;
    require(PCFactorGetMatrix(pc, &factor), "MUMPS");
    require(MatMumpsSetIcntl(factor, 14, 60), "MUMPS workspace");   // per cent more than estimated
    require(MatMumpsSetIcntl(factor, 24, 1), "MUMPS null pivots");  // counts them: a singular matrix
    return;
  }
  require(MatSetBlockSize(matrix, 3), "block size");
  if (static_cast<PetscInt>(3 * positions.size()) == n) {
    Vec at = nullptr;
    MatNullSpace rigid = nullptr;
    require(VecCreateSeq(PETSC_COMM_SELF, n, &at), "positions");
    require(VecSetBlockSize(at, 3), "positions");
    PetscScalar* raw = nullptr;
    require(VecGetArray(at, &raw), "positions");
    for (std::size_t a = 0; a < positions.size(); ++a)
      for (int d = 0; d < 3; ++d) raw[3 * a + d] = positions[a][d];
    require(VecRestoreArray(at, &raw), "positions");
    require(MatNullSpaceCreateRigidBody(at, &rigid), "rigid motions");
    require(MatSetNearNullSpace(matrix, rigid), "rigid motions");
    require(MatNullSpaceDestroy(&rigid), "rigid motions");
    require(VecDestroy(&at), "positions");
  }
  require(KSPSetType(solver, symmetric ? KSPCG : KSPGMRES), "solver type");
  require(PCSetType(pc, PCGAMG), "multigrid");
  require(KSPSetTolerances(solver, settings.tolerance, PETSC_DEFAULT, PETSC_DEFAULT, settings.max_iterations),
          "tolerances");
}

bool LinearSolver::Petsc::run(const Eigen::VectorXd& b, Eigen::VectorXd& u, LinearReport& report) {
  PetscScalar* raw = nullptr;
  require(VecGetArray(right, &raw), "right-hand side");
  std::copy(b.data(), b.data() + b.size(), raw);
  require(VecRestoreArray(right, &raw), "right-hand side");
  require(VecSet(left, 0), "solution");
  if (KSPSolve(solver, right, left) != 0) return false;
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  require(KSPGetConvergedReason(solver, &reason), "reason");
  if (reason < 0) return false;
  PetscInt iterations = 0;
  require(KSPGetIterationNumber(solver, &iterations), "iterations");
  if (direct) {
    PC pc = nullptr;
    Mat factor = nullptr;
    PetscInt negative = 0, null = 0;
    require(KSPGetPC(solver, &pc), "factor");
    require(PCFactorGetMatrix(pc, &factor), "factor");
    require(MatMumpsGetInfog(factor, 12, &negative), "negative pivots");
    require(MatMumpsGetInfog(factor, 28, &null), "null pivots");
    report.negative_pivots = symmetric ? static_cast<int>(negative) - constraints : 0;
    if (null > 0) return false;
  }
  const PetscScalar* found = nullptr;
  require(VecGetArrayRead(left, &found), "solution");
  u = Eigen::Map<const Eigen::VectorXd>(found, u.size());
  require(VecRestoreArrayRead(left, &found), "solution");
  report.iterations = direct ? 0 : static_cast<int>(iterations);
  return u.allFinite();
}

LinearSolver::LinearSolver(const LinearSettings& settings)
    : settings_(settings), petsc_(std::make_unique<Petsc>()) {
  if (!(settings_.tolerance > 0) || settings_.max_iterations < 1)
    throw InputError("linear solver: tolerance {}, at most {} iterations; expected positive ones",
                     settings_.tolerance, settings_.max_iterations);
}

LinearSolver::~LinearSolver() = default;

LinearReport LinearSolver::solve(const BlockMatrix& k, const std::vector<std::uint8_t>& fixed,
                                 const Eigen::VectorXd& rhs, Eigen::VectorXd& u, const Points& positions) {
  petsc::start();
  VALSALVA_ASSERT(rhs.size() == 3 * k.slots() && u.size() == rhs.size() &&
                  static_cast<Eigen::Index>(fixed.size()) == rhs.size());
  Petsc& p = *petsc_;
  LinearReport report;
  report.symmetric = is_symmetric(k, fixed);
  const auto attempt = [&](bool direct) {
    bool same = p.solver && p.source == &k && p.version == k.pattern_version() &&
                p.symmetric == report.symmetric && p.direct == direct;
    const PetscScalar* storage = p.values.data();
    const std::size_t entries = p.values.size();
    Eigen::VectorXd b;
    p.fill(k, fixed, rhs, u, b);
    same = same && storage == p.values.data() && entries == p.values.size();  // PETSc uses our arrays
    if (!same) p.release();
    p.symmetric = report.symmetric;
    p.direct = direct;
    if (!same) {
      p.create(positions, settings_);
      p.source = &k;
      p.version = k.pattern_version();
    } else {
      require(MatAssemblyBegin(p.matrix, MAT_FINAL_ASSEMBLY), "assembly");
      require(MatAssemblyEnd(p.matrix, MAT_FINAL_ASSEMBLY), "assembly");
    }
    report.direct = direct;
    return p.run(b, u, report);
  };
  const bool multigrid =
      k.rank_ones().empty() &&
      (settings_.method == LinearMethod::multigrid ||
       (settings_.method == LinearMethod::automatic && rhs.size() > settings_.direct_up_to));
  const Eigen::VectorXd given = u;
  if (multigrid) {
    if (attempt(false)) return report;
    u = given;
  }
  if (attempt(true)) return report;
  p.release();
  double smallest = 0, largest = 0;
  for (int i = 0; i < 3 * k.slots(); ++i) {
    if (fixed[i]) continue;
    const BlockMatrix::Row& row = k.row(i / 3);
    const auto own = std::lower_bound(row.columns.begin(), row.columns.end(), i / 3) - row.columns.begin();
    const double stiffness = std::abs(row.blocks[own](i % 3, i % 3));
    smallest = largest == 0 ? stiffness : std::min(smallest, stiffness);
    largest = std::max(largest, stiffness);
  }
  throw NumericalFailure(
      "linear solver: the stiffness matrix is singular to round-off (its diagonal goes from {:.2g} to "
      "{:.2g}): "
      "a body can move freely, or the state is unstable: check the supports; or, where the diagonal spans "
      "more "
      "than ten decades, an element has nearly no length or thickness: remesh",
      smallest, largest);
}

}  // namespace valsalva::solve
