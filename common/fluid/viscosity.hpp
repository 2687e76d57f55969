// Viscosity beyond the constant one: blood that thins with shear, and unresolved eddies.
//
//   N <- N + div(2 nu_x S),   S = (grad u + grad u^T) / 2,   nu_x = nu_CY(gamma) - nu + nu_t
//
// Carreau-Yasuda (Yasuda, Armstrong, Cohen 1981, Rheol. Acta 20), gamma = sqrt(2 S:S), in Pa s:
//   mu = mu_inf + (mu_0 - mu_inf) [1 + (lambda gamma)^a]^((n - 1) / a)
// Vreman (2004, Phys. Fluids 16, eqs. 5 to 8), alpha_ij = d u_j / d x_i, beta = h^2 alpha^T alpha:
//   nu_t = c sqrt(B / alpha:alpha), B = beta11 beta22 - beta12^2 + beta11 beta33 - beta13^2 + beta22 beta33 -
//   beta23^2
// nu_t is zero in plane shear, and therefore small next to walls; c = 0.07 answers Smagorinsky's 0.17.
//
// nu_x stands at cell centres: velocity differences of the four edges of each plane, averaged (for gamma:
// their squares); on edges the mean of four cells. Second order. Beyond the sides of the box nu_x continues
// with zero gradient. The faces of open ends and of prescribed sides do not feel it.
//
// Explicit: stable for dt < h^2 / (12 (nu + nu_x)).
#pragma once

#include <array>
#include <optional>

#include "fluid/boundary.hpp"
#include "fluid/grid.hpp"
#include "fluid/momentum.hpp"

namespace valsalva::fluid {

struct CarreauYasuda {
  double zero_shear = 0.056;  ///< mu_0, Pa s
  double time_s = 1.902;      ///< lambda
  double exponent = 0.22;     ///< n
  double transition = 1.25;   ///< a
};

struct ExtraViscosityParameters {
  std::optional<CarreauYasuda> carreau_yasuda;  ///< whose mu_inf is the constant viscosity
  double vreman = 0;                            ///< c; 0: no subgrid model
  bool any() const { return carreau_yasuda || vreman > 0; }
};

class ExtraViscosity {
 public:
  /// constant: mu (mu_inf), Pa s. InputError when mu_0 is below it.
  ExtraViscosity(const Slab& slab, const Boundaries& boundaries, const ExtraViscosityParameters& parameters,
                 double constant, double density);

  /// nu_x from a velocity with valid ghosts (collective).
  void update(const FaceField& velocity);
  /// mm2/s, with one ghost layer.
  const Field& value() const { return nu_; }
  /// The largest of all ranks at the last update, mm2/s.
  double largest() const { return largest_; }
  /// rate += div(2 nu_x S), next += weight times the same, on all faces but those of prescribed sides.
  void add(const FaceField& velocity, double weight, FaceField& rate, FaceField& next) const;

 private:
  using Rows = std::array<const double*, 3>;  ///< of the velocity's components
  void add_thinning(const CarreauYasuda& law, const Rows& u, double* nu) const;
  void add_eddies(const Rows& u, double* nu) const;
  void add_row(int d, const std::array<int, 3>& from, const FaceField& velocity, double weight, double* rate,
               double* next) const;
  void fill_ghosts();

  const Slab& slab_;
  const Boundaries& boundaries_;
  ExtraViscosityParameters parameters_;
  double constant_, density_, largest_ = 0;
  Field nu_;
};

}  // namespace valsalva::fluid
