// The pressure equation where the direct solver's box does not reach: unknowns in chosen cells only, any
// conductance between neighbours, cells of known pressure anywhere.
//
//   sum over the cell's faces of c_f (phi_neighbour - phi)  +  d (0 - phi) = h^2 b
//
//   c_f  conductance of a face between two cells: 1 in the fluid, 0 at walls (Neumann)
//   d    the sum of the cell's conductances 1/theta towards places of known pressure (phi = 0), theta h away
//        (Gibou, Fedkiw, Cheng, Kang 2002, J. Comput. Phys. 176: symmetric, second order)
//
// Cells without any conductance are no unknowns: phi = 0 there. Conjugate gradients (PETSc), from the last
// phi on. Preconditioner:
//   multigrid    one V-cycle over cells joined by two in each direction, with the operator of the doubled
//                spacing, P^T A P / 2 for piecewise constant P; one sweep of Gauss-Seidel forwards before and
//                one backwards after it; LU on the coarsest grid
//   aggregation  PETSc's smoothed aggregation (GAMG)
// Converged when the root mean square of the residual, over the unknowns, is below `tolerance` times that of
// b, or below the floor that the caller sets.
//
// Equal ranks give equal bits. Groups of cells without any known pressure: if it is a single one, the mean of
// b is dropped and that of phi is 0; of several each has one cell held at 0.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fluid/boundary.hpp"
#include "fluid/grid.hpp"
#include "fluid/pressure_solver.hpp"

namespace valsalva::fluid {

struct KrylovSettings {
  enum class Preconditioner { multigrid, aggregation };
  double tolerance = 1e-8;
  int most_iterations = 300;
  Preconditioner preconditioner = Preconditioner::multigrid;
};

class KrylovPressure : public PressureSolver {
 public:
  KrylovPressure(const Slab& slab, const Boundaries& boundaries, const KrylovSettings& settings);
  ~KrylovPressure() override;
  KrylovPressure(const KrylovPressure&) = delete;
  KrylovPressure& operator=(const KrylovPressure&) = delete;

  /// Collective; anew when the fluid changes. conductance: of owned faces (sides of the box: 0, but 1 where
  /// they are periodic); its ghosts are filled here. known: d of owned cells. drop_floating: groups of
  /// cells without any known pressure are no unknowns.
  void build(FaceField& conductance, const Field& known, bool drop_floating = false);

  /// The residual's root mean square, in units of b, at which it is good enough.
  void set_floor(double residual) { floor_ = residual; }
  /// NumericalFailure that names the place of the largest residual when it does not converge.
  void solve(const Source& b, Field& phi, Planes within = {}) override;

  int iterations() const { return iterations_; }  ///< of the last solve
  double tolerance() const { return settings_.tolerance; }
  double unknowns() const { return all_unknowns_; }
  /// Is the owned cell an unknown?
  bool solves(int i, int j, int k) const { return number_(i, j, k) >= 0; }

  /// phi of the last solve, from which the next one starts, on owned cells; and back.
  void store_start(Field& phi) const;
  void load_start(const Field& phi);

 private:
  struct Petsc;
  struct Cell {
    int i, j, k;
  };
  void find_unknowns(const FaceField& conductance, const Field& known);
  void number_unknowns();
  void hold_floating_groups(const FaceField& conductance, const Field& known, bool drop);
  void assemble(const FaceField& conductance, const Field& known);
  [[noreturn]] void report_failure(int reason) const;

  const Slab& slab_;
  const Boundaries& boundaries_;
  KrylovSettings settings_;
  std::unique_ptr<Petsc> petsc_;
  Field number_;                ///< of the unknown in a cell, over all ranks; -1: none
  std::vector<Cell> unknowns_;  ///< of this rank
  std::vector<double> held_;    ///< of this rank's unknowns: added to the diagonal to hold a group
  bool free_mean_ = false;
  double floor_ = 0, all_unknowns_ = 0;
  int iterations_ = 0;
};

}  // namespace valsalva::fluid
