// Contact between deformable bodies, and of each with itself: point-triangle and edge-edge pairs, with
// Coulomb friction.
//
// Energy: sum over pairs of A psi(d), with the pressure law of pressure_law.hpp, d the distance of the
// features' middles, h the sum of their radii or what the pair of bodies has set, A the features' area. A
// point that rests on a mesh is met by one or two point-triangle and a few edge-edge pairs, so that the
// pressure at a given distance is three to five times p(d): read K as a stiffness scale, not as a material
// constant.
//
// Even (BodyPairSettings::even): what neighbouring features see alike counts once, so that flat layers are
// hardly pushed aside where features end: a point and a face give
//   psi(face) - sum of (n - 1)/n psi(edge) + sum of 1/m psi(vertex),
// n faces on an edge, m at an inner vertex (inclusion and exclusion: over a flat mesh one psi is left,
// exactly), two edges
//   psi(edges) - 1/2 sum psi(edge, end of the other) + 1/4 sum psi(ends),
// which leaves the number of crossings and fades where they change. As d -> 0 each sum grows without bound as
// psi does. Source: Li et al. 2023, Convergent Incremental Potential Contact (points and faces; the shares of
// edges are our own).
//
// Friction: body_friction.hpp; the coefficient belongs to a pair of bodies (BodyPairSettings::friction).
//
// A pair's forces sum to zero, and without friction to no moment, to round-off. Sums have a fixed order.
//
// Nothing passes through anything: `allowed_motion` says how much of a motion may be made (adaptive explicit
// steps and Newton's method ask it), by continuous detection; `limit_velocities` is for fixed explicit steps.
#pragma once

#include "contact/body_friction.hpp"
#include "contact/candidates.hpp"
#include "contact/pressure_law.hpp"
#include "structure/force_term.hpp"

namespace valsalva::contact {

/// Of the last evaluation of forces.
struct ContactReport {
  long active = 0;                  ///< pairs nearer than their contact distance
  double penetration_mm = 0;        ///< largest h - d
  double smallest_ratio = 1;        ///< smallest d / h of active pairs
  double smallest_distance_mm = 0;  ///< of active pairs; at most the near skin
  long slipping = 0;                ///< pairs whose friction is at Coulomb's limit
};

class BodyContact : public structure::ForceTerm {
 public:
  /// slip_share: how far a pair gives way before it slips, over its contact distance. The name tells terms of
  /// one system apart in restarts.
  BodyContact(Candidates candidates, Law law, double slip_share = 0.05,
              std::string name = "contact between bodies");

  std::string name() const override { return name_; }
  void begin_step(const structure::Configuration& now, double dt_s) override;
  /// The energy is that of the normal law; friction stores none.
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  /// Block row sums |w_i| sum_j |w_j| (A psi'' + A p / d), taken at 0.8 d, so that they stay bounds while a
  /// pair approaches by a fifth; of friction mu (A p/u + A psi'') more, u the range of stick.
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  bool stiffness_is_abrupt() const override { return true; }
  /// Exact for the normal law, with the change of the nearest points; friction with the present normal and
  /// nearest points kept. Symmetric without friction.
  void add_tangent(const structure::Configuration& now, structure::BlockMatrix& out) const override;
  /// The share of the motion to `to` at which no pair is nearer than 0.8 of what it was, or of its contact
  /// distance: nothing crosses, and the stiffness bound still holds there.
  double allowed_motion(const structure::Configuration& now, const Points& to) const override;
  /// Friction's history; nothing without friction.
  structure::Snapshot save() const override;
  void restore(const structure::Snapshot& snapshot) override;

  const ContactReport& report() const { return report_; }
  /// Energy that friction has taken out, up to the last begin_step, nJ.
  double friction_work_nJ() const { return friction_.work_nJ(); }
  const Candidates& candidates() const { return candidates_; }
  /// For changing the settings.
  Candidates& candidates() {
    found_at_.clear();
    return candidates_;
  }

  /// Largest h - d of the pairs of two bodies at these positions, 0 when none is in contact.
  double penetration_mm(const Points& x, const std::string& body, const std::string& other) const;
  /// Forces on all nodes of the system at these positions, friction included.
  Points forces(const Points& x) const;

  /// The step guard: no node moves more than a quarter of the distance to the nearest feature of its near
  /// pairs in one step, hence no pair can pass through itself. Shortens velocities where needed; returns how
  /// many nodes were slowed. Held nodes keep their velocity. Call after a step, with the step that comes
  /// next.
  int limit_velocities(structure::System& system, double dt_s);

 private:
  /// A pair in contact.
  struct Active {
    PairKind kind;
    std::array<int, 4> node;
    std::array<double, 4> weight;
    Vec3 direction;
    double distance_mm, contact_distance_mm, modulus_area_uN;
    Pressure at;
    PairFriction friction;
    double share = 1;   // contained in `at`
    bool whole = true;  // not an edge or vertex of a pair (BodyPairSettings::even)
  };
  static constexpr double floor = 1e-5;    // of the contact distance, below which pairs hardly approach
  static constexpr double approach = 0.8;  // by which pairs may come nearer within a step

  /// Finds the pairs in contact at x, unless x is where they were found last.
  void find_active(const Points& x) const;
  void find_active(const Points& x, const std::vector<FeaturePair>& pairs, PairKind kind,
                   std::size_t first_chunk) const;
  /// Appends what the edges and vertices of a pair take back or add; the sum of their forces on its first
  /// feature.
  Vec3 add_parts(PairKind kind, const FeaturePair& pair, const std::array<Vec3, 4>& x,
                 std::vector<Active>& own) const;
  void scatter(Points& force) const;
  double limited(const Points& from, const Points& to, const std::vector<FeaturePair>& pairs, PairKind kind,
                 double share) const;

  mutable Candidates candidates_;  // lists are renewed when trial positions leave their reach
  Law law_;
  std::string name_;
  Friction friction_;
  // The pairs in contact at found_at_, in the order of the lists: forces, bounds and the guard of one
  // configuration share them.
  mutable std::vector<std::vector<Active>> active_;
  mutable Points found_at_;
  mutable ContactReport report_;
};

}  // namespace valsalva::contact
