// Convection and viscosity on the staggered grid, and the explicit update made from them, in one pass.
//
//   N = -div(u u) + nu lap u, conservative; the flux of q through a face, with advecting velocity a (mean of
//   two): F = a [ c1 (q0 + q1) - c2 (q-1 + q2) ] + s |a| [ 3 (q0 - q1) + (q2 - q-1) ]
//
//   upwind3    c1 = 7/12, c2 = 1/12, s = 1/12   third-order upwind-biased face value (kappa = 1/3; van Leer
//   1985) centred4   c1 = 7/12, c2 = 1/12, s = 0      fourth-order face value, no dissipation centred2   c1 =
//   1/2,  c2 = 0,    s = 0      second order, conserves kinetic energy weno5      F = a q*, q* of fifth order
//   where q is smooth, without new extremes beside jumps
//              (convective_flux.hpp); on the faces of open ends, which have no third neighbour outside,
//              upwind3
//
// The advecting velocities are two-point means, so the scheme as a whole is second order.
//
// Order 4 (periodic boxes only) replaces all of it, viscosity and pressure gradient included
// (fourth_order.hpp). The flux difference is 9/8 of that over one cell less 1/8 of that over three, and the
// flux through a side
//   centred4      the product of q and a interpolated there, with six points on the near sides and four on
//   the
//                 far ones: 1/40 of the error of the next at the same grid; momentum is conserved
//   conserving4   Morinishi et al. (1998), "Div-S4": q is a mean of two; kinetic energy is conserved too
//
// On a face of an open end through which fluid enters with the speed w_in, N says that it comes from rest in
// a reservoir of the prescribed pressure (boundary.hpp): over the half cell that belongs to the face
//   d w_in / dt = -(w_in^2 / 2) / (h / 2)
#pragma once

#include <string>
#include <vector>

#include "fluid/boundary.hpp"
#include "fluid/convective_flux.hpp"
#include "fluid/grid.hpp"

namespace valsalva::fluid {

enum class Convection { upwind3, centred4, centred2, weno5, conserving4 };

/// InputError for an unknown name.
Convection convection_from(const std::string& name);

/// next = velocity + dt (weight_new N + weight_old rate) + dt/rho (force - grad pressure);  rate <- N.
struct Advance {
  double dt = 0;
  double weight_new = 1, weight_old = 0;
  double density = 1;
  const FaceField* force = nullptr;  ///< none: no force
  Planes forced = {};                ///< outside of them the force is zero
  const Field* pressure = nullptr;   ///< one valid ghost layer (order 4: two); none: no gradient
};

class Momentum {
 public:
  Momentum(const Slab& slab, const Boundaries& boundaries, Convection scheme, double kinematic_viscosity,
           int order = 2);

  /// Ghosts of `velocity` must be valid. Owned faces of `next` and `rate` are written; ghosts are not.
  void advance(const FaceField& velocity, const Advance& step, FaceField& rate, FaceField& next);

 private:
  template <bool open_end, class Flux>
  void plane(const Flux& flux, int d, int k, const FaceField& velocity, const Advance& step, FaceField& rate,
             FaceField& next);
  template <class Flux>
  void start_plane_fluxes(const Flux& flux, const FaceField& velocity);
  template <class Flux>
  void advance_second_order(const Flux& flux, const FaceField& velocity, const Advance& step, FaceField& rate,
                            FaceField& next);
  void hold_sides(int k, FaceField& rate, FaceField& next) const;
  template <class Flux>
  void advance_fourth_order(const FaceField& velocity, const Advance& step, FaceField& rate,
                            FaceField& next) const;
  void advance_fourth_order(const FaceField& velocity, const Advance& step, FaceField& rate,
                            FaceField& next) const;

  const Slab& slab_;
  const Boundaries& boundaries_;
  Convection convection_;
  LinearFlux linear_;  ///< of the scheme; of weno5 that of the open ends
  double nu_;
  int order_;
  std::array<std::vector<double>, 3> flux_z_;  ///< of each component, through the low side of the next plane
  std::vector<double> flux_x_, flux_y_;
};

}  // namespace valsalva::fluid
