// The normal law of contact: a pressure p(d) that acts between two layers whose middles are closer than the
// contact distance h. Energy per area psi(d), p = -psi', both zero for d >= h.
//
//   barrier   psi = -K h (s - 1)^2 ln s,                         s = d / h
//             p   =  K [2 (s - 1) ln s + (s - 1)^2 / s]          grows without bound as d -> 0
//   penalty   psi =  K h (1 - s)^2 / 2,  p = K (1 - s)           bounded by K: can be pushed through
//
// The barrier is twice continuously differentiable and soft at onset (p = 3 K (1 - s)^2 there); p = 1.2 K at
// half the contact distance. Source: Li et al. 2020, Incremental Potential Contact, eq. 6, made a pressure.
// Units: d, h mm; K, p Pa; psi Pa mm; stiffness -p' Pa/mm. docs/decisions/contact-law.md has the comparison.
#pragma once

namespace valsalva::contact {

enum class Law { barrier, penalty };

struct Pressure {
  double energy = 0;     ///< psi
  double pressure = 0;   ///< p
  double stiffness = 0;  ///< -p', never negative
};

/// Below s = 1e-3 the barrier is evaluated at s = 1e-3 (a pressure of 1000 K), so that it stays finite.
Pressure normal_pressure(Law law, double modulus_Pa, double distance_mm, double contact_distance_mm);

}  // namespace valsalva::contact
