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

#include <functional>
#include <memory>
#include <vector>

#include "fluid/boundary.hpp"
#include "fluid/grid.hpp"

namespace valsalva::fluid {

class Poisson {
 public:
  Poisson(const Slab& slab, const Boundaries& boundaries);
  ~Poisson();
  Poisson(const Poisson&) = delete;
  Poisson& operator=(const Poisson&) = delete;

  /// A plane is nx ny doubles, x fastest; k is the local plane. Planes are visited once each, in an order of
  /// the solver's choice.
  using Source = std::function<void(int k, double* plane)>;
  using Sink = std::function<void(int k, const double* plane)>;
  void solve(const Source& b, const Sink& phi);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace valsalva::fluid
