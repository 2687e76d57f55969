// lap phi = b in a box that is periodic in all directions, by Fourier transforms in all three, for any
// Laplacian that is the divergence of a gradient with the real symbols kappa(angle)/h of each direction:
//   phi(k) = -h^2 b(k) / (kappa_x^2 + kappa_y^2 + kappa_z^2)
// One transposition between slabs of planes and bundles of z-lines each way. Used with the fourth-order
// operators, whose seven-point second difference the tridiagonal solver (poisson.hpp) cannot solve.
#pragma once

#include <fftw3.h>

#include <complex>
#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

#include "fluid/grid.hpp"
#include "fluid/pressure_solver.hpp"

namespace valsalva::fluid {

class PeriodicPoisson : public PressureSolver {
 public:
  /// symbol: kappa of an angle in (-pi, pi].
  PeriodicPoisson(const Slab& slab, const std::function<double(double)>& symbol);
  void solve(const Source& b, Field& phi, Planes within = {}) override;

 private:
  struct Free {
    void operator()(void* p) const { fftw_free(p); }
  };
  struct Destroy {
    void operator()(fftw_plan p) const { fftw_destroy_plan(p); }
  };
  using Plan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, Destroy>;
  using Modes = std::unique_ptr<std::complex<double>, Free>;

  void exchange(const std::complex<double>* from, const std::vector<int>& counts,
                const std::vector<int>& starts, std::complex<double>* to, const std::vector<int>& to_counts,
                const std::vector<int>& to_starts) const;

  MPI_Comm comm_;
  int planes_, nx_, ny_, nz_, modes_, own_,
      first_;  ///< modes of a plane; those whose z-lines are here, from first_
  std::unique_ptr<double, Free> cells_;
  Modes plane_, lines_;  ///< modes of one plane; z-lines, mode fastest
  std::vector<std::complex<double>> bundle_;
  std::vector<int> plane_counts_, plane_starts_, line_counts_, line_starts_, mode_first_;
  std::vector<double> factor_;  ///< of the z-lines: -h^2 / sum of kappa^2, and the transforms' normalisation
  Plan plane_forward_, plane_backward_, line_forward_, line_backward_;
};

}  // namespace valsalva::fluid
