// Any System with its force terms as an immersed body: solids, Kirchhoff-Love and other shells, beams, ties,
// contact, follower pressure, dead loads.
//
//   nodes          x' = J u,  force on the fluid F_a = sum of the terms (+ tie, below); held nodes keep the
//                  velocity of the System's state, partly held ones in the held directions
//   excess mass    M_a = (rho_s - rho_f) V_a > 0 of a node stands in a twin y_a that only a spring ties to
//                  it (Kim and Peskin 2007, Penalty immersed boundary method, section 2):
//                  M y'' = k (x - y),  F_a += k (y - x),  k = M w^2
//                  so that the fluid carries the mass rho_f V of the body and the twin the rest
//   rotations      of beams: I w' = moment - I c w, with the System's inertia
//
// Symplectic Euler, as the nodes. The limit of the step (stability.hpp) is that of all unknowns together. It
// asks for products with the tangent: forward differences of the terms' forces, with a displacement of 1e-6
// of the shortest edge, which serves every term (contact as far as it is closed).
//
// w: well above the frequencies of the motion, (motion/w)^2 being the slip of the twin; the tie's own limit
// is 2 / (w sqrt(1 + rho_s/rho_f)), so that some tenth of the elastic frequencies costs nothing.
//
// Contact: a node that would pass through something lags behind the fluid (settings.guard); the limit of the
// step is looked for anew as soon as the stiffness bound of contact has grown by a fifth.
//
// Limits: the fluid's incompressibility and viscosity hold inside the body; lighter bodies than the fluid are
// refused; the work of the terms is not divided among ranks.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "coupling/immersed_body.hpp"
#include "coupling/volume_keeper.hpp"
#include "structure/force_term.hpp"

namespace valsalva::coupling {

struct ImmersedStructureSettings {
  /// Elements of all bodies: for the lengths of edges, and the quadrature.
  std::vector<Cell> cells;
  /// Coupling by element quadrature with this largest distance of points, mm (h/2); none: at nodes.
  std::optional<double> sampling_mm;
  std::vector<double> excess_mass_g;  ///< one a node, >= 0; empty: none
  double tie_rate_per_s = 0;          ///< w; positive where there is excess mass
  double rotation_damping_per_s = 0;  ///< c
  /// Before every motion: slows nodes (state.v) that would pass through something in the step (contact).
  std::function<void(structure::System&, double dt_s)> guard;
  /// Of the forces, as step_lead for leaflets: steps of 1.9 times the length, but more error in time (the
  /// spinning disc of 8 cells a radius: 0.113 instead of 0.074).
  double lead = 0;
  std::optional<double> least_lead;  ///< in a fluid at rest, as for leaflets; none: always lead
  /// Do solids keep the volume of each of their parts (volume_keeper.hpp)?
  bool keep_volume = false;
};

/// Of the nodes of a body: its masses in the System times 1 - rho_f/rho_s. excess_mass_g grows to one entry a
/// node of the System. InputError when the body is lighter than the fluid.
void add_excess_mass(const structure::System& system, const structure::Body& body, double density_g_per_mm3,
                     double fluid_density_g_per_mm3, std::vector<double>& excess_mass_g);

class ImmersedStructure : public ImmersedBody {
 public:
  /// The System's present state is the start; the reference of edges and quadrature is `reference`.
  ImmersedStructure(std::unique_ptr<structure::System> system,
                    std::vector<std::shared_ptr<structure::ForceTerm>> terms, const Points& reference,
                    const ImmersedStructureSettings& settings);

  /// The same for a system of the caller's, which must outlive this object.
  ImmersedStructure(structure::System& system, std::vector<std::shared_ptr<structure::ForceTerm>> terms,
                    const Points& reference, const ImmersedStructureSettings& settings);

  const structure::System& system() const { return *system_; }
  structure::System& system() { return *system_; }

  const Points& x() const override { return system_->state.x; }
  void set_x(Points x) override;
  const Points& coupling_points() const override { return sampling_ ? sampling_->points() : x(); }
  const Sampling* sampling() const override { return sampling_ ? &*sampling_ : nullptr; }
  std::size_t unknowns() const override { return rotations_begin() + system_->rotational_nodes(); }
  std::vector<double> own_masses() const override;
  void begin_step(double dt_s, const Points& last_velocity, double lead) override;
  double lead() const override { return settings_.lead; }
  double least_lead() const override { return settings_.least_lead.value_or(settings_.lead); }
  void forces(Points& out) override;
  void update_tangent() override;
  void tangent_product(const Points& direction, Points& out) const override;
  void move(Points& velocity, double dt_s) override;
  EdgeStretch edge_stretch(const Points& since) const override;
  double stiffening(double strain) const override;
  std::map<std::string, state::Array> save() const override;
  void load(const state::State& state) override;

  void set_tie_rate(double per_s) { settings_.tie_rate_per_s = per_s; }
  bool has_twins() const { return !twin_of_.empty(); }

  /// Of the last forces().
  double stored_energy() const { return stored_; }  ///< of the terms and ties, nJ
  /// What the terms pull at held nodes (partly held ones in the held directions), uN.
  const Vec3& pull_on_holds() const { return pull_; }
  /// Momentum of the excess mass, g mm/s.
  Vec3 excess_momentum() const;
  /// Largest distance of a twin from its node, mm.
  double largest_slip() const;
  /// Of the terms' nodal forces at the present shape: without what keeping volumes takes up of them and of
  /// the ties' forces, which is what does not reach the fluid.
  void leave_out_constraints(Points& force) const;
  /// Largest relative change of the volume of a solid's part since the start.
  double largest_volume_change() const { return volumes_->largest_change(x()); }

 private:
  std::size_t twins_begin() const { return system_->nodes(); }
  std::size_t rotations_begin() const { return twins_begin() + twin_of_.size(); }
  void moved();
  Vec3 tie_force(std::size_t twin) const;
  bool keeps_volume() const { return settings_.keep_volume && !volumes_->empty(); }
  Vec3 free_part(int node, const Vec3& v) const;
  double term_forces(const structure::Configuration& at, structure::Forces& out) const;
  double abrupt_stiffness() const;

  std::unique_ptr<structure::System> owned_;
  structure::System* system_;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms_;
  ImmersedStructureSettings settings_;
  std::vector<std::shared_ptr<structure::ForceTerm>> abrupt_;  // contact
  double elastic_stiffness_ = 0, probed_stiffness_ = 0;        // bounds; of contact at update_tangent()
  std::vector<Edge> edges_;
  std::vector<double> rest_length_;
  double shortest_ = 0;
  std::optional<Sampling> sampling_;
  std::optional<VolumeKeeper> volumes_;
  std::vector<Mat3> held_;    // projectors; empty when no node is held
  std::vector<int> twin_of_;  // the node of each twin
  Points twin_, twin_velocity_;
  Points own_force_;                // on twins and rotations, at the last forces()
  structure::Forces here_;          // the terms' forces at the present shape
  structure::Configuration ahead_;  // the shape of the forces
  mutable structure::Configuration near_;
  mutable structure::Forces near_forces_;
  double stored_ = 0;
  Vec3 pull_ = Vec3::Zero();
};

}  // namespace valsalva::coupling
