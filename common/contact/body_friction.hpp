// Coulomb friction of contact pairs with elastic stick: each pair in contact remembers a tether t, the
// tangential way that its first feature has made against the second since they met, cut off at the range of
// stick u (a share of the contact distance). Traction on the first feature
//   f = -mu N |n . m| t/u,  |t| <= u,
// N the pair's normal force, n its direction, m the normal of the surface: the triangle's, or that of both
// edges (n where they are parallel, or where the pair pushes by more than 72 degrees aside of it: an edge of
// the side face of a block over one of the floor). Where points lie beside the feature that they are near to,
// the pairs' directions are inclined and their forces partly cancel; only what presses along m rubs. At rest
// the friction holds without creep, in motion it is mu times the normal force. From one accepted state to the
// next
//   t <- cut[Q t + g - Q g_n],   tangential,
// g = sum_i w_i x_i (weights w of distance.hpp), g_n the same of the last state's positions, and Q the
// smallest rotation from the last m to the present one: a common rotation of two layers is no slip. A pair
// that comes into contact starts with the tether of the pairs of the same vertex or edge with the same body,
// in units of u, so that a point which slides from triangle to triangle does not lose its grip; the first one
// with t = 0.
//
// Forces of a pair sum to zero. Their moment is g x f: friction acts on middle surfaces a distance d apart,
// and nodes of shells take no moments. Source: Wriggers 2006, Computational Contact Mechanics, section 5.2
// (elastic stick, radial return). mm, uN, nJ.
#pragma once

#include <map>
#include <string>

#include "contact/candidates.hpp"
#include "contact/continuous.hpp"
#include "structure/system.hpp"

namespace valsalva::contact {

/// Kind, first and second feature.
using PairKey = std::array<int, 3>;

/// Of one pair at one configuration.
struct PairFriction {
  PairKey key{};
  int other_body = 0;  ///< of the second feature
  double coefficient = 0;
  double range_mm = 0;         ///< u
  bool known = false;          ///< was in contact at the last accepted state
  Vec3 normal = Vec3::Zero();  ///< m
  double pressing_uN = 0;      ///< N |n . m|, of the pair with its parts
  Vec3 tether = Vec3::Zero();
  double way_mm = 0;             ///< |t| before it was cut off
  Vec3 on_first = Vec3::Zero();  ///< uN
  bool slips() const { return way_mm > range_mm; }
};

class Friction {
 public:
  explicit Friction(double slip_share);
  double slip_share() const { return slip_share_; }
  /// The tether and traction of a pair at x.
  PairFriction at(PairKind kind, const FeaturePair& pair, const Points& x, const Nearest& near,
                  const Vec3& normal_force_uN) const;
  /// Accepts a state: `pairs` are all in contact at x; those that are new inherit their tether here.
  void accept(const std::vector<PairFriction*>& pairs, const Points& x);
  double work_nJ() const { return work_; }

  structure::Snapshot save() const;
  void restore(const structure::Snapshot& snapshot, const std::string& owner);

 private:
  double slip_share_, work_ = 0;
  std::map<PairKey, Vec3> tethers_;
  Points accepted_;  // positions of the last accepted state
};

}  // namespace valsalva::contact
