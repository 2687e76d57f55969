// The explicit time step of an immersed structure, from the largest eigenvalue of its linearised motion.
//
// Nodes move with the fluid, u' = (1/rho) S F and x' = J u, so a small displacement y obeys
//   y'' = -(1/rho) J S K y,      dt_crit = 2 / sqrt(lambda_max).
// S: spreading, J: interpolation (adjoint: J S is symmetric and positive semi-definite), K: the tangent
// stiffness made positive semi-definite. The projection and solid faces P only add mass: J P S in place of J
// S gives steps 1.7 to 2.3 times as long for leaflets. lambda comes from a warm-started power iteration with
// the Rayleigh quotient of the K-product,   lambda = (K y)^T (1/rho) J P S (K y) / (y^T K y), a bound from
// below whose error is second order in that of the direction.
//
// Without P every run of the prototypes held at 0.85-0.9 of dt_crit. With it, that needs two things:
//   - Convection (AB2) lags behind the structure (symplectic Euler) and feeds a mode that the flow carries
//     along: with theta = k |u| dt and dt sqrt(lambda) = 2 sin(phi/2) by theta (1 - cos phi)^2 / (2 sin phi)
//     a step. Forces of the shape a dt ahead, F(x + a dt U), take a (dt sqrt(lambda))^2 / 2 a step out of it,
//     and lower the limit to 2 / sqrt(lambda (1 + 2 a)). a = 0.25; where nothing flows there is nothing to
//     take out, and leaflets' forces lead by 0.05 only (lead_at).
//   - Where the flow is fast that is not enough: dt^2 = limit^2 (1 - 2 CFL) keeps all waves of five cells and
//     more from growing, at any CFL number up to 0.35.
//   - Waves of three and four cells, of a fold beside the attachment, still grow by a percent a step or so;
//     at half the safety they do not. They show as trembling, |u(n) - 2 u(n-1) + u(n-2)| dt of a node: 1e-6
//     to 1e-4 cells in calm motion, 1e-2 in a burst. Beyond 1e-3 cells steps shrink, down to half (Calm).
// docs/decisions/time-step.md derives it; unit.coupling.ModelOfTheStep.* solves the model problem.
//
// A warm start follows one mode. Where another, local one stiffens past it (a fold that is pulled straight
// beside the attachment), a few iterations do not find it, but the motion does: an explicit step beyond its
// limit makes that mode alternate from step to step. So the quotient is also taken along the last change of
// the nodes' velocities, and the larger of the two counts.
#pragma once

#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "core/types.hpp"

namespace valsalva::coupling {

/// out = operator(in); out comes in with the right size and any content.
using Operator = std::function<void(const Points& in, Points& out)>;

class PowerIteration {
 public:
  /// Starts from a fixed pseudo-random direction.
  explicit PowerIteration(std::size_t nodes);
  /// Some iterations on mobility * stiffness; returns the eigenvalue's estimate (1/s2), 0 for a zero
  /// stiffness.
  double run(const Operator& stiffness, const Operator& mobility, int iterations);
  /// Some iterations from another direction, which takes the place of the present one if its quotient is
  /// larger. The first ones take the flow's smooth changes out of it.
  double look_along(Points direction, const Operator& stiffness, const Operator& mobility, int iterations);
  double eigenvalue() const { return eigenvalue_; }
  /// 2 / sqrt(lambda); infinite for lambda = 0.
  double critical_step() const;
  /// The direction and the last estimate: part of the restart state.
  const Points& direction() const { return direction_; }
  void restore(Points direction, double eigenvalue);

 private:
  /// Rayleigh quotient along `direction`; next_ is the product. Nothing for a direction without stiffness.
  std::optional<double> quotient(const Points& direction, const Operator& stiffness,
                                 const Operator& mobility);
  void take_next(Points& direction) const;

  Points direction_, force_, next_;
  double eigenvalue_ = 0;
};

/// What trembling nodes leave of the safety: a tenth less after every step in which one trembles, 0.2 % more
/// after every other, between a half and 1.
class Calm {
 public:
  void see(double trembling_cells) {
    factor_ = trembling_cells > most_cells ? std::max(least, 0.9 * factor_) : std::min(1.0, 1.002 * factor_);
  }
  double factor() const { return factor_; }
  void restore(double factor) { factor_ = factor; }

  static constexpr double most_cells = 1e-3, least = 0.5;

 private:
  double factor_ = 1;
};

struct StepLimits {
  double safety = 0.85;   ///< of dt_crit
  double convection = 2;  ///< by what the flow shortens the step near dt_crit: above
  double largest_s = 1e-4;
  double cfl = 0.35;         ///< dt max(|u|+|v|+|w|) / h
  double growth = 1.3;       ///< from one step to the next
  double smallest_s = 1e-8;  ///< below it the run has failed
};

/// The next step: at most safety * critical, less where the flow is fast, largest, the local CFL number, and
/// growth times the last one (last 0: no limit). speed: max(|u|+|v|+|w|), mm/s. NumericalFailure below
/// smallest_s.
double next_step(const StepLimits& limits, double critical_s, double speed, double h, double last_s);

}  // namespace valsalva::coupling
