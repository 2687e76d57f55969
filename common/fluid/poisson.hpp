// The pressure equation lap phi = b on cell centres (second-order seven-point Laplacian), solved directly.
//
// x and y: transform to the eigenvectors of the one-dimensional operators (cosines for walls and slip sides,
// DCT-II; the real Fourier basis for periodic sides). z: one tridiagonal system for each mode. Its ends are
// Neumann (wall, slip, inflow), Dirichlet phi = 0 on the side (open), or periodic. Over slabs the tridiagonal
// systems are solved exactly: each rank eliminates its own planes, the first and last unknowns of all ranks
// form a small dense system for each mode, whose inverse is computed once (the modes are divided over the
// ranks), and each rank substitutes back. Sweeps run over whole planes, contiguous over the modes. Where the
// mean of phi is free (no open end), b is made compatible by removing its mean, and the mean of phi is 0.
#pragma once

#include <memory>

#include "fluid/boundary.hpp"
#include "fluid/grid.hpp"
#include "fluid/pressure_solver.hpp"

namespace valsalva::fluid {

class Poisson : public PressureSolver {
 public:
  Poisson(const Slab& slab, const Boundaries& boundaries);
  ~Poisson() override;
  Poisson(const Poisson&) = delete;
  Poisson& operator=(const Poisson&) = delete;

  void solve(const Source& b, Field& phi, Planes within = {}) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace valsalva::fluid
