#include "fluid/krylov_pressure.hpp"

#include <petscksp.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/petsc.hpp"

namespace valsalva::fluid {

using petsc::require;

struct KrylovPressure::Petsc {
  std::vector<Mat> matrices, interpolations;  ///< from the finest level on
  KSP solver = nullptr;
  Vec b = nullptr, x = nullptr;

  Petsc() { petsc::start(); }
  ~Petsc() { release(); }
  void release() {
    if (!petsc::can_release()) return;
    KSPDestroy(&solver);
    VecDestroy(&b);
    VecDestroy(&x);
    for (Mat& m : matrices) MatDestroy(&m);
    for (Mat& m : interpolations) MatDestroy(&m);
    matrices.clear();
    interpolations.clear();
  }
  void make_levels(std::vector<std::array<int, 3>> places, MPI_Comm comm);
  void make_solver(const KrylovSettings& settings, MPI_Comm comm);
};

namespace {

constexpr int coarsest = 400;  ///< unknowns that are solved directly

/// The matrix of these rows; columns count over all ranks.
Mat matrix_of(MPI_Comm comm, PetscInt own_columns, const std::vector<PetscInt>& rows,
              const std::vector<PetscInt>& columns, const std::vector<PetscScalar>& values) {
  Mat matrix = nullptr;
  const auto own_rows = static_cast<PetscInt>(rows.size()) - 1;
  require(MatCreate(comm, &matrix), "matrix");
  require(MatSetSizes(matrix, own_rows, own_columns, PETSC_DETERMINE, PETSC_DETERMINE), "matrix size");
  require(MatSetType(matrix, MATAIJ), "matrix type");
  require(MatSeqAIJSetPreallocationCSR(matrix, rows.data(), columns.data(), values.data()), "matrix");
  require(MatMPIAIJSetPreallocationCSR(matrix, rows.data(), columns.data(), values.data()), "matrix");
  return matrix;
}

double unknowns_of(Mat matrix) {
  PetscInt rows = 0;
  require(MatGetSize(matrix, &rows, nullptr), "matrix size");
  return static_cast<double>(rows);
}

}  // namespace

// Cells joined by two in each direction, within a rank.
void KrylovPressure::Petsc::make_levels(std::vector<std::array<int, 3>> places, MPI_Comm comm) {
  while (unknowns_of(matrices.back()) > coarsest) {
    std::map<std::array<int, 3>, PetscInt> number;
    std::vector<std::array<int, 3>> joined;
    std::vector<PetscInt> rows{0}, columns;
    for (const auto& [i, j, k] : places) {
      const std::array<int, 3> at{k / 2, j / 2, i / 2};
      const auto [found, first] = number.try_emplace(at, static_cast<PetscInt>(joined.size()));
      if (first) joined.push_back({at[2], at[1], at[0]});
      columns.push_back(found->second);
      rows.push_back(static_cast<PetscInt>(columns.size()));
    }
    const auto own = static_cast<PetscInt>(joined.size());
    PetscInt before = 0;
    MPI_Exscan(&own, &before, 1, MPIU_INT, MPI_SUM, comm);
    if (mpi::rank(comm) == 0) before = 0;
    for (PetscInt& column : columns) column += before;
    const std::vector<PetscScalar> ones(columns.size(), 1.0);
    if (mpi::sum(comm, static_cast<double>(own)) > 0.8 * unknowns_of(matrices.back())) return;
    interpolations.push_back(matrix_of(comm, own, rows, columns, ones));
    Mat coarse = nullptr;
    require(MatPtAP(matrices.back(), interpolations.back(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, &coarse),
            "coarse grid");
    require(MatScale(coarse, 0.5), "coarse grid");
    matrices.push_back(coarse);
    places = std::move(joined);
  }
}

void KrylovPressure::Petsc::make_solver(const KrylovSettings& settings, MPI_Comm comm) {
  require(MatCreateVecs(matrices[0], &x, &b), "vectors");
  require(VecSet(x, 0), "vectors");
  require(KSPCreate(comm, &solver), "solver");
  require(KSPSetOperators(solver, matrices[0], matrices[0]), "operators");
  require(KSPSetType(solver, KSPCG), "solver type");
  require(KSPSetNormType(solver, KSP_NORM_UNPRECONDITIONED), "norm");
  require(KSPSetInitialGuessNonzero(solver, PETSC_TRUE), "first guess");
  PC pc = nullptr;
  require(KSPGetPC(solver, &pc), "preconditioner");
  if (settings.preconditioner == KrylovSettings::Preconditioner::aggregation) {
    require(PCSetType(pc, PCGAMG), "smoothed aggregation");
    return;
  }
  const int levels = static_cast<int>(matrices.size());
  require(PCSetType(pc, PCMG), "multigrid");
  require(PCMGSetLevels(pc, levels, nullptr), "levels");
  require(PCMGSetType(pc, PC_MG_MULTIPLICATIVE), "cycle");
  require(PCMGSetCycleType(pc, PC_MG_CYCLE_V), "cycle");
  for (int level = 1; level < levels; ++level) {
    const int of_mine = levels - 1 - level;
    require(PCMGSetInterpolation(pc, level, interpolations[of_mine]), "interpolation");
    for (const bool down : {true, false}) {
      KSP smoother = nullptr;
      PC sweep = nullptr;
      require(down ? PCMGGetSmootherDown(pc, level, &smoother) : PCMGGetSmootherUp(pc, level, &smoother),
              "smoother");
      require(KSPSetOperators(smoother, matrices[of_mine], matrices[of_mine]), "smoother");
      require(KSPSetType(smoother, KSPRICHARDSON), "smoother");
      require(KSPSetNormType(smoother, KSP_NORM_NONE), "smoother");
      require(KSPSetConvergenceTest(smoother, KSPConvergedSkip, nullptr, nullptr), "smoother");
      require(KSPSetTolerances(smoother, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, 1), "smoother");
      require(KSPGetPC(smoother, &sweep), "smoother");
      require(PCSetType(sweep, PCSOR), "smoother");
      require(PCSORSetSymmetric(sweep, down ? SOR_LOCAL_FORWARD_SWEEP : SOR_LOCAL_BACKWARD_SWEEP),
              "smoother");
    }
  }
  KSP last = nullptr;
  require(PCMGGetCoarseSolve(pc, &last), "coarsest grid");
  require(KSPSetOperators(last, matrices.back(), matrices.back()), "coarsest grid");
}

KrylovPressure::KrylovPressure(const Slab& slab, const Boundaries& boundaries, const KrylovSettings& settings)
    : slab_(slab),
      boundaries_(boundaries),
      settings_(settings),
      petsc_(std::make_unique<Petsc>()),
      number_(slab) {
  if (!(settings.tolerance > 0) || settings.most_iterations < 1)
    throw InputError("fluid: pressure tolerance {}, at most {} iterations; expected positive ones",
                     settings.tolerance, settings.most_iterations);
}

KrylovPressure::~KrylovPressure() = default;

void KrylovPressure::build(FaceField& conductance, const Field& known, bool drop_floating) {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  for (Field& c : conductance.component) exchange_planes(slab_, c, 1);
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < ny; ++j)
      conductance[0](nx, j, k) = boundaries_.periodic(0) ? conductance[0](0, j, k) : 0;
    for (int i = 0; i < nx; ++i)
      conductance[1](i, ny, k) = boundaries_.periodic(1) ? conductance[1](i, 0, k) : 0;
  }
  Field before(slab_);
  if (petsc_->x) store_start(before);
  find_unknowns(conductance, known);
  hold_floating_groups(conductance, known, drop_floating);
  petsc_->release();
  assemble(conductance, known);
  std::vector<std::array<int, 3>> places;
  for (const Cell& cell : unknowns_) places.push_back({cell.i, cell.j, cell.k});
  if (settings_.preconditioner == KrylovSettings::Preconditioner::multigrid)
    petsc_->make_levels(std::move(places), slab_.comm);
  petsc_->make_solver(settings_, slab_.comm);
  load_start(before);
}

void KrylovPressure::find_unknowns(const FaceField& c, const Field& known) {
  unknowns_.clear();
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < slab_.grid.cells[1]; ++j) {
      for (int i = 0; i < slab_.grid.cells[0]; ++i) {
        const double sum = c[0](i, j, k) + c[0](i + 1, j, k) + c[1](i, j, k) + c[1](i, j + 1, k) +
                           c[2](i, j, k) + c[2](i, j, k + 1) + known(i, j, k);
        if (sum > 0) unknowns_.push_back({i, j, k});
      }
    }
  }
  number_unknowns();
}

void KrylovPressure::number_unknowns() {
  number_.fill(-1);
  const auto own = static_cast<double>(unknowns_.size());
  double before = 0;
  MPI_Exscan(&own, &before, 1, MPI_DOUBLE, MPI_SUM, slab_.comm);
  if (slab_.rank == 0) before = 0;
  for (std::size_t u = 0; u < unknowns_.size(); ++u)
    number_(unknowns_[u].i, unknowns_[u].j, unknowns_[u].k) = before + static_cast<double>(u);
  all_unknowns_ = mpi::sum(slab_.comm, own);
  if (all_unknowns_ == 0)
    throw InputError(
        "fluid: no cell of the box is open to its neighbours and joined with a place of known pressure; "
        "check "
        "where the fluid is, and its openings");
  fill_pressure_ghosts(slab_, boundaries_, number_, {0, 0});
}

namespace {

/// each(neighbour's i, j, k, conductance) for the neighbours that a cell is joined with.
template <class Each>
void each_neighbour(const FaceField& c, int i, int j, int k, const Each& each) {
  if (const double value = c[2](i, j, k)) each(i, j, k - 1, value);
  if (const double value = c[1](i, j, k)) each(i, j - 1, k, value);
  if (const double value = c[0](i, j, k)) each(i - 1, j, k, value);
  if (const double value = c[0](i + 1, j, k)) each(i + 1, j, k, value);
  if (const double value = c[1](i, j + 1, k)) each(i, j + 1, k, value);
  if (const double value = c[2](i, j, k + 1)) each(i, j, k + 1, value);
}

}  // namespace

// Cells joined within the rank first; then each such part takes the lowest number of the parts of other ranks
// (or across a periodic z) that it touches, until nothing changes on any rank.
void KrylovPressure::hold_floating_groups(const FaceField& c, const Field& known, bool drop) {
  const auto wrapped = [this](int at, int d) {
    const int n = slab_.grid.cells[d];
    return at < 0 ? at + n : at >= n ? at - n : at;
  };
  Field part(slab_), label(slab_);
  part.fill(-1);
  std::vector<double> lowest;  // of each part
  std::vector<Cell> queue;
  for (const Cell& first : unknowns_) {
    if (part(first.i, first.j, first.k) >= 0) continue;
    const auto mine = static_cast<double>(lowest.size());
    lowest.push_back(number_(first.i, first.j, first.k));
    part(first.i, first.j, first.k) = mine;
    queue.push_back(first);
    while (!queue.empty()) {
      const Cell cell = queue.back();
      queue.pop_back();
      each_neighbour(c, cell.i, cell.j, cell.k, [&](int p, int q, int r, double) {
        if (r < 0 || r >= slab_.planes) return;
        double& other = part(wrapped(p, 0), wrapped(q, 1), r);
        if (other >= 0) return;
        other = mine;
        queue.push_back({wrapped(p, 0), wrapped(q, 1), r});
      });
    }
  }
  const auto lowest_at = [&](const Cell& cell) -> double& {
    return lowest[static_cast<std::size_t>(part(cell.i, cell.j, cell.k))];
  };
  bool changed = true;
  while (mpi::any(slab_.comm, changed)) {
    changed = false;
    for (const Cell& cell : unknowns_) label(cell.i, cell.j, cell.k) = lowest_at(cell);
    exchange_planes(slab_, label, 1);
    for (const Cell& cell : unknowns_) {
      if (cell.k != 0 && cell.k != slab_.planes - 1) continue;
      each_neighbour(c, cell.i, cell.j, cell.k, [&](int p, int q, int r, double) {
        if (r >= 0 && r < slab_.planes) return;
        const double other = label(wrapped(p, 0), wrapped(q, 1), r);
        if (other >= lowest_at(cell)) return;
        lowest_at(cell) = other;
        changed = true;
      });
    }
  }

  std::map<double, bool> own;  // group: has it a place of known pressure?
  for (const Cell& cell : unknowns_) own[lowest_at(cell)] |= known(cell.i, cell.j, cell.k) > 0;
  std::vector<double> mine;
  for (const auto& [group, has] : own) mine.insert(mine.end(), {group, has ? 1.0 : 0.0});
  std::vector<int> counts(slab_.ranks), at(slab_.ranks);
  const int count = static_cast<int>(mine.size());
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, slab_.comm);
  int total = 0;
  for (int r = 0; r < slab_.ranks; ++r) {
    at[r] = total;
    total += counts[r];
  }
  std::vector<double> all(total);
  MPI_Allgatherv(mine.data(), count, MPI_DOUBLE, all.data(), counts.data(), at.data(), MPI_DOUBLE,
                 slab_.comm);
  std::map<double, bool> groups;
  for (int g = 0; g < total; g += 2) groups[all[g]] |= all[g + 1] > 0;
  if (drop) {
    std::erase_if(unknowns_, [&](const Cell& cell) { return !groups.at(lowest_at(cell)); });
    number_unknowns();
    std::erase_if(groups, [](const auto& group) { return !group.second; });
  }
  free_mean_ = groups.size() == 1 && !groups.begin()->second;
  held_.assign(unknowns_.size(), 0.0);
  for (std::size_t u = 0; u < unknowns_.size(); ++u) {
    const auto group = groups.find(number_(unknowns_[u].i, unknowns_[u].j, unknowns_[u].k));
    if (!drop && group != groups.end() && !group->second) held_[u] = 1;
  }
}

void KrylovPressure::assemble(const FaceField& c, const Field& known) {
  std::vector<PetscInt> rows{0}, columns;
  std::vector<PetscScalar> values;
  std::vector<std::pair<PetscInt, PetscScalar>> row;
  for (std::size_t u = 0; u < unknowns_.size(); ++u) {
    const auto& [i, j, k] = unknowns_[u];
    double diagonal = known(i, j, k) + held_[u];
    row.clear();
    each_neighbour(c, i, j, k, [&](int p, int q, int r, double value) {
      diagonal += value;
      row.emplace_back(static_cast<PetscInt>(number_(p, q, r)), -value);
    });
    row.emplace_back(static_cast<PetscInt>(number_(i, j, k)), diagonal);
    std::sort(row.begin(), row.end());
    for (const auto& [column, value] : row) {
      columns.push_back(column);
      values.push_back(value);
    }
    rows.push_back(static_cast<PetscInt>(columns.size()));
  }
  petsc_->matrices.push_back(
      matrix_of(slab_.comm, static_cast<PetscInt>(unknowns_.size()), rows, columns, values));
}

void KrylovPressure::solve(const Source& source, Field& phi, Planes) {
  const int nx = slab_.grid.cells[0];
  const double h2 = slab_.grid.h * slab_.grid.h;
  std::vector<double> plane(slab_.grid.plane_cells());
  PetscScalar* b = nullptr;
  require(VecGetArray(petsc_->b, &b), "right-hand side");
  double sum = 0;
  std::size_t u = 0;
  for (int k = 0; k < slab_.planes; ++k) {
    source(k, {plane.data(), nx});
    for (; u < unknowns_.size() && unknowns_[u].k == k; ++u)
      sum += b[u] = -h2 * plane[static_cast<std::size_t>(unknowns_[u].j) * nx + unknowns_[u].i];
  }
  if (free_mean_) {
    const double mean = mpi::sum(slab_.comm, sum) / all_unknowns_;
    for (std::size_t v = 0; v < unknowns_.size(); ++v) b[v] -= mean;
  }
  require(VecRestoreArray(petsc_->b, &b), "right-hand side");

  // PETSc measures norms, this class root mean squares.
  const double floor = std::max(1e-300, h2 * floor_ * std::sqrt(all_unknowns_));
  // Where b all but vanishes, the last phi starts far above it: that is no divergence.
  constexpr double no_limit = 1e300;
  require(KSPSetTolerances(petsc_->solver, settings_.tolerance, floor, no_limit, settings_.most_iterations),
          "tolerances");
  const PetscErrorCode code = KSPSolve(petsc_->solver, petsc_->b, petsc_->x);
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  require(KSPGetConvergedReason(petsc_->solver, &reason), "reason");
  if (code != 0 || reason <= 0) report_failure(static_cast<int>(reason));
  PetscInt count = 0;
  require(KSPGetIterationNumber(petsc_->solver, &count), "iterations");
  iterations_ = static_cast<int>(count);

  const PetscScalar* x = nullptr;
  require(VecGetArrayRead(petsc_->x, &x), "solution");
  double level = 0;
  if (free_mean_) {
    for (std::size_t v = 0; v < unknowns_.size(); ++v) level += x[v];
    level = mpi::sum(slab_.comm, level) / all_unknowns_;
  }
  u = 0;
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < slab_.grid.cells[1]; ++j) std::fill_n(phi.row(j, k), nx, 0.0);
    for (; u < unknowns_.size() && unknowns_[u].k == k; ++u)
      phi(unknowns_[u].i, unknowns_[u].j, k) = x[u] - level;
  }
  require(VecRestoreArrayRead(petsc_->x, &x), "solution");
}

void KrylovPressure::report_failure(int reason) const {
  Vec r = nullptr;
  require(VecDuplicate(petsc_->b, &r), "residual");
  require(MatResidual(petsc_->matrices[0], petsc_->b, petsc_->x, r), "residual");
  const PetscScalar* values = nullptr;
  require(VecGetArrayRead(r, &values), "residual");
  double largest = -1;
  std::size_t at = 0;
  for (std::size_t u = 0; u < unknowns_.size(); ++u) {
    const double size = std::isfinite(values[u]) ? std::abs(values[u]) : 1e300;
    if (size > largest) {
      largest = size;
      at = u;
    }
  }
  require(VecRestoreArrayRead(r, &values), "residual");
  require(VecDestroy(&r), "residual");
  const double most = mpi::max(slab_.comm, largest);
  const int who = static_cast<int>(mpi::min(slab_.comm, largest == most ? slab_.rank : slab_.ranks));
  std::array<double, 3> place{};
  if (who == slab_.rank) {
    const Cell& cell = unknowns_[at];
    const Vec3 x = slab_.grid.position(3, cell.i, cell.j, cell.k + slab_.first);
    std::copy_n(x.data(), 3, place.begin());
  }
  MPI_Bcast(place.data(), 3, MPI_DOUBLE, who, slab_.comm);
  throw NumericalFailure(
      "fluid: the pressure of {:.0f} cells was not found in {} iterations (PETSc's reason {}); the largest "
      "residual is at ({:.2f}, {:.2f}, {:.2f}) mm. Use a smaller time step, or a larger "
      "fluid.pressure_tolerance than {}",
      all_unknowns_, settings_.most_iterations, reason, place[0], place[1], place[2], settings_.tolerance);
}

void KrylovPressure::store_start(Field& phi) const {
  phi.fill(0);
  const PetscScalar* x = nullptr;
  require(VecGetArrayRead(petsc_->x, &x), "solution");
  for (std::size_t u = 0; u < unknowns_.size(); ++u)
    phi(unknowns_[u].i, unknowns_[u].j, unknowns_[u].k) = x[u];
  require(VecRestoreArrayRead(petsc_->x, &x), "solution");
}

void KrylovPressure::load_start(const Field& phi) {
  PetscScalar* x = nullptr;
  require(VecGetArray(petsc_->x, &x), "solution");
  for (std::size_t u = 0; u < unknowns_.size(); ++u)
    x[u] = phi(unknowns_[u].i, unknowns_[u].j, unknowns_[u].k);
  require(VecRestoreArray(petsc_->x, &x), "solution");
}

}  // namespace valsalva::fluid
