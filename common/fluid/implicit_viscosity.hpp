// The constant viscosity by Crank-Nicolson's rule, together with the penalisation of solid faces:
//
//   (1 + chi dt/eta - dt nu/2 lap) delta = (u_e - u^n) + dt nu lap u^n - chi dt/eta (u^n - U_solid)
//   u* = u^n + delta
//
// u_e: u^n and everything explicit. chi: 1 on solid faces. Second order in time, stable for any nu dt/h^2;
// modes of large nu dt/h^2 decay slowly and change sign from step to step, as the rule does. Component by
// component by conjugate gradients with the diagonal as preconditioner, to a relative residual of 1e-10. On
// faces of open ends delta has zero gradient.
#pragma once

#include "fluid/boundary.hpp"
#include "fluid/grid.hpp"
#include "fluid/solids.hpp"

namespace valsalva::fluid {

class ImplicitViscosity {
 public:
  ImplicitViscosity(const Slab& slab, const Boundaries& boundaries, double kinematic_viscosity);

  /// velocity: u^n with valid ghosts. next: u_e, prescribed faces at their new velocity; becomes u*. ratio:
  /// dt/eta, or 0 to leave solids out. Collective; NumericalFailure when it does not converge in 1000
  /// iterations.
  void solve(double dt, double ratio, const FaceField& velocity, const Solids& solids, FaceField& next);

  /// Of the last solve, the largest of the three components.
  int iterations() const { return iterations_; }

 private:
  void fill_ghosts(int d, Field& field) const;
  template <class Body>
  void each_row(int d, const Body& body) const;
  double dot(int d, const Field& a, const Field& b) const;
  void apply(int d, double half, Field& x, Field& out) const;

  const Slab& slab_;
  const Boundaries& boundaries_;
  double nu_;
  int iterations_ = 0;
  Field delta_, residual_, direction_, image_, mass_;  ///< mass_: 1 + chi dt/eta
};

}  // namespace valsalva::fluid
