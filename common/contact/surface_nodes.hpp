// The nodes that may touch a rigid surface (a wall, a tool), and what they have in common there.
//
// Normal law: pressure K_n times the overlap, on the node's area. Friction after Coulomb with a tether: a
// node that comes into contact drops an anchor on the surface; the traction is K_t times its tangential
// distance from the anchor, and once the traction exceeds mu times the normal force the anchor slips after
// the node, so that the traction stays at mu N (the return map of rigid-perfectly-plastic slip with an
// elastic range of mu N / (K_t A)). At rest the node stays where it is: no creep. The anchors are history and
// belong to a restart. Source: Wriggers 2006, Computational Contact Mechanics, section 5.2 (elastic stick,
// radial return). Units: mm, uN, Pa/mm.
#pragma once

#include <string>
#include <vector>

#include "core/types.hpp"
#include "structure/system.hpp"

namespace valsalva::contact {

struct SurfaceNode {
  int node = 0;
  double radius_mm = 0;  ///< the surface is met this far from the node
  double area_mm2 = 0;
};

struct SurfaceParameters {
  double normal_Pa_per_mm = 1e6;   ///< K_n
  double friction = 0;             ///< mu
  double tangent_Pa_per_mm = 1e6;  ///< K_t
};

class Tethers {
 public:
  Tethers(std::size_t count, double friction, double tangent_Pa_per_mm);

  /// Start-of-step update of contact i: position on (or above) the surface, unit normal, normal force.
  void advance(std::size_t i, const Vec3& position, const Vec3& normal, double normal_force_uN,
               double area_mm2);
  /// The tangential force, bounded by mu N; zero out of contact.
  Vec3 force(std::size_t i, const Vec3& position, const Vec3& normal, double normal_force_uN,
             double area_mm2) const;
  double friction() const { return friction_; }
  double stiffness(double area_mm2) const { return friction_ > 0 ? tangent_ * area_mm2 : 0; }
  bool engaged(std::size_t i) const { return engaged_[i] != 0; }

  structure::Snapshot save() const;
  void restore(const structure::Snapshot& snapshot, const std::string& owner);

 private:
  double friction_, tangent_;
  std::vector<double> engaged_;
  Points anchor_;
};

}  // namespace valsalva::contact
