// What moves with the fluid: the interface between ImmersedFlow and any structure.
//
// A body has nodes, which carry forces to the grid and take their velocity from it, and may have further
// unknowns with a mass of their own (excess mass, rotations of beams). Unknowns are 3-vectors, the nodes
// first. Positions and forces are the same on all ranks.
//   ImmersedShell      leaflets: a constant-strain shell with repulsion and standoff
//   ImmersedStructure  any System with its force terms: solids, Kirchhoff-Love shells, beams, ties, loads
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "core/types.hpp"
#include "coupling/sampling.hpp"
#include "state/state.hpp"

namespace valsalva::coupling {

struct EdgeStretch {
  double largest = 1;  ///< present length of an edge over its reference length
  double change = 0;   ///< largest relative change of an edge's length since the positions given
};

/// Share of the step by which forces run ahead of the positions: what it damps and costs is in stability.hpp.
inline constexpr double step_lead = 0.25;
/// What leaflets need of it at a CFL number: at rest little, which allows longer steps.
inline double lead_at(double cfl, double least, double most) {
  return std::min(most, least + 2 * cfl);
}
inline constexpr double least_step_lead = 0.05;

/// Of fibres at the strains of a closed leaflet.
inline constexpr double stiffening_per_strain = 100;

class ImmersedBody {
 public:
  ImmersedBody() = default;
  ImmersedBody(const ImmersedBody&) = delete;
  ImmersedBody& operator=(const ImmersedBody&) = delete;
  virtual ~ImmersedBody() = default;

  /// Of the nodes.
  virtual const Points& x() const = 0;
  virtual void set_x(Points x) = 0;
  /// Where the body couples to the grid: one point a node, unless there is a sampling.
  virtual const Points& coupling_points() const = 0;
  /// Coupling by element quadrature (sampling.hpp); null: at the nodes.
  virtual const Sampling* sampling() const { return nullptr; }

  /// Nodes and further unknowns.
  virtual std::size_t unknowns() const { return x().size(); }
  /// Mass (g) or inertia (g mm2) of the further unknowns.
  virtual std::vector<double> own_masses() const { return {}; }

  /// Before the forces of a step of (at most) dt: history. last_velocity: of the unknowns in the step before.
  /// lead: forces are those of the shape that lies lead dt ahead along last_velocity.
  virtual void begin_step(double dt_s, const Points& last_velocity, double lead) = 0;
  /// The largest lead, where the flow is fast. Above 0 the limit of the step counts the fluid's
  /// incompressibility (stability.hpp).
  virtual double lead() const = 0;
  /// That in a fluid at rest.
  virtual double least_lead() const { return lead(); }
  /// Force (moment) on every unknown, uN (uN mm); zero at held ones (collective).
  virtual void forces(Points& out) = 0;
  /// The tangent at the present shape; then out = K direction, of all unknowns (collective). For the
  /// stability limit: symmetric, and positive at least in the stiff directions.
  virtual void update_tangent() = 0;
  virtual void tangent_product(const Points& direction, Points& out) const = 0;

  /// x += dt u. velocity: one an unknown; comes in with that of the fluid at the nodes, and goes out with
  /// what moved: held nodes and further unknowns filled in. NumericalFailure when a node is not finite or
  /// much too fast.
  virtual void move(Points& velocity, double dt_s) = 0;
  virtual EdgeStretch edge_stretch(const Points& since) const = 0;
  /// An upper estimate of how many times as stiff the body has become since update_tangent(), whose edges
  /// have been strained by `strain` since then.
  virtual double stiffening(double strain) const { return 1 + stiffening_per_strain * strain; }

  /// Beside the nodes' positions: what a bitwise continuation needs, by names below "coupling/body/".
  virtual std::map<std::string, state::Array> save() const { return {}; }
  virtual void load(const state::State&) {}
};

/// No leaflet or blood stream is this fast: ten times a stenotic jet.
inline constexpr double fastest_mm_per_s = 2e4;

}  // namespace valsalva::coupling
