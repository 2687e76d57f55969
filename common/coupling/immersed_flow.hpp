// The coupled system of one time step: fluid and, where the scene has one, an immersed
// body (immersed_body.hpp).
//
//   every probe_interval steps, or when the body may have become stiffer: lambda_max anew (stability.hpp)
//   dt from the limits;  0D models of the ends to t + dt;  F = F(x^n + lead dt U^n);  f = S F;  u^(n+1) by
//   the projection method;  x^(n+1) = x^n + dt J u^(n+1) a step whose local CFL number, dt max(|u|+|v|+|w|)/h
//   of u^(n+1), exceeds the limit is undone and repeated with a smaller dt (and AB2 begins anew), so that the
//   limit holds for every step
// with S and J at x^n (leaflets that touch: at their standoff, standoff.hpp): symplectic Euler for the
// structure, so that no energy is put in by the lag.
#pragma once

#include <functional>
#include <map>
#include <memory>

#include "coupling/immersed_body.hpp"
#include "coupling/immersed_shell.hpp"
#include "coupling/moving_walls.hpp"
#include "coupling/stability.hpp"
#include "coupling/transfer.hpp"
#include "fluid/flow.hpp"

namespace valsalva::coupling {

struct ImmersedFlowSettings {
  Kernel kernel{Basis::ib4, Basis::ib4};
  Surroundings beyond{};  ///< sides up to which a body may reach (transfer.hpp)
  StepLimits limits;
  int probe_interval = 8;         ///< steps between estimates of lambda_max
  double probe_stiffening = 1.2;  ///< or sooner, once the body may have become this many times as stiff
  int probe_iterations = 2;       ///< power iterations each
  int look_iterations = 3;        ///< along the nodes' last change of velocity
  int first_iterations = 40;      ///< at the start, from a random direction
  double largest_stretch = 1.6;   ///< alarm: an edge longer than this times its reference length
};

/// What the caller has to do with a step; each may be empty.
struct StepHooks {
  std::function<double(double dt)> fit;      ///< shortens the planned step, to meet a point of time
  std::function<void(double dt)> set_force;  ///< sets flow.force(), to which the body adds; none: zero
  /// Before every attempt: what is prescribed at the end of the step (pressures, velocities, held nodes).
  std::function<void(double dt)> set_ends;
};

struct ImmersedStep {
  double dt_s = 0;
  double critical_s = 0;  ///< dt_crit; infinite without a body
  int repeats = 0;        ///< attempts that were undone
  fluid::StepReport fluid;
};

class ImmersedFlow {
 public:
  /// body may be null: flow past held bodies alone. The flow must outlive this object.
  ImmersedFlow(fluid::Flow& flow, std::unique_ptr<ImmersedBody> body, const ImmersedFlowSettings& settings);

  /// One step of at most `at_most` seconds. set_ends(dt) is called before every attempt, to bring the
  /// pressures of the flow's ends to the end of the step. NumericalFailure (on all ranks) by any alarm: the
  /// state is then to be restored.
  ImmersedStep step(double at_most, const std::function<void(double dt)>& set_ends = {});
  ImmersedStep step(double at_most, const StepHooks& hooks);
  /// dt_crit as things stand, by the iterations of a start (collective); infinite without a body.
  double find_critical();

  fluid::Flow& flow() { return flow_; }
  ImmersedBody* body() { return body_.get(); }
  const ImmersedBody* body() const { return body_.get(); }
  /// The body where it is leaflets; null otherwise.
  ImmersedShell* shell() { return shell_; }
  const ImmersedShell* shell() const { return shell_; }
  long steps() const { return steps_; }
  /// Scales limits.safety from now on: smaller steps after an alarm. Part of the state.
  void set_caution(double factor) { caution_ = factor; }
  double caution() const { return caution_; }

  /// Flow, body, power iteration and step history; complete on rank 0 (collective). load wants the full
  /// arrays on every rank and continues bitwise at equal ranks.
  std::map<std::string, state::Array> save() const;
  void load(const state::State& state);

 private:
  void probe();
  void iterate(int iterations);
  /// Of the present step: by the last one's flow.
  double lead() const;
  double critical_step() const;
  double plan();
  void locate();
  void spread(const Points& force, fluid::FaceField& density);
  /// of_flow: the flow's own velocity, which walls may give images of (moving_walls.hpp).
  void interpolate(const fluid::FaceField& velocity, Points& out, bool of_flow = false);

  fluid::Flow& flow_;
  std::unique_ptr<ImmersedBody> body_;
  ImmersedShell* shell_;
  ImmersedFlowSettings settings_;
  Transfer transfer_;
  MovingWalls walls_;
  PowerIteration power_;
  Points last_velocity_, change_;  // of the unknowns in the last step; its difference to the step before
  Points probed_x_;                // where lambda_max was last looked for
  fluid::FaceField scratch_;       // of the probe's products; zero between them
  fluid::Planes forced_;           // where the last force may act
  Points force_, velocity_;
  Points at_points_;  // of the sampling
  Calm calm_;
  long steps_ = 0, probed_ = 0;
  int interval_ = 0;  // to the next estimate
  double last_dt_ = 0, max_speed_ = 0, caution_ = 1;
};

}  // namespace valsalva::coupling
