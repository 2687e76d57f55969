// Contact between deformable bodies, and of each with itself: point-triangle and edge-edge pairs.
//
// Energy: sum over pairs of A psi(d), with the pressure law of pressure_law.hpp, d the distance of the
// features' middles, h the sum of their radii or what the pair of bodies has set, A the features' area. A
// point that rests on a mesh is met by one or two point-triangle and a few edge-edge pairs, so that the
// pressure at a given distance is three to five times p(d): read K as a stiffness scale, not as a material
// constant. No friction between bodies.
//
// A pair's forces sum to zero and to no moment, to round-off. Sums have a fixed order.
#pragma once

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
};

class BodyContact : public structure::ForceTerm {
 public:
  BodyContact(Candidates candidates, Law law);

  std::string name() const override { return "contact between bodies"; }
  void begin_step(const structure::Configuration& now, double dt_s) override;
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  /// Block row sums |w_i| sum_j |w_j| (A psi'' + A p / d), taken at 0.8 d, so that they stay bounds while a
  /// pair approaches by a fifth.
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  bool stiffness_is_abrupt() const override { return true; }

  const ContactReport& report() const { return report_; }
  const Candidates& candidates() const { return candidates_; }
  /// For changing the settings.
  Candidates& candidates() {
    found_at_.clear();
    return candidates_;
  }

  /// Largest h - d of the pairs of two bodies at these positions, 0 when none is in contact.
  double penetration_mm(const Points& x, const std::string& body, const std::string& other) const;

  /// The step guard: no node moves more than a quarter of the distance to the nearest feature of its near
  /// pairs in one step, hence no pair can pass through itself. Shortens velocities where needed; returns how
  /// many nodes were slowed. Held nodes keep their velocity. Call after a step, with the step that comes
  /// next.
  int limit_velocities(structure::System& system, double dt_s);

 private:
  /// A pair in contact.
  struct Active {
    std::array<int, 4> node;
    std::array<double, 4> weight;
    Vec3 direction;
    double distance_mm, contact_distance_mm, modulus_area_uN;
    Pressure at;
  };
  /// Finds the pairs in contact at x, unless x is where they were found last.
  void find_active(const Points& x) const;
  template <class Distance>
  void find_active(const Points& x, const std::vector<FeaturePair>& pairs, Distance&& distance,
                   std::size_t first_chunk) const;
  void scatter(Points& force) const;

  Candidates candidates_;
  Law law_;
  // The pairs in contact at found_at_, in the order of the lists: forces, bounds and the guard of one
  // configuration share them.
  mutable std::vector<std::vector<Active>> active_;
  mutable Points found_at_;
  mutable ContactReport report_;
};

}  // namespace valsalva::contact
