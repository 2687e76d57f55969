// Contact of nodes with a rigid analytic surface that may be moved, with Coulomb friction.
//
// Distance d(x) on the free side: plane n.(x - p); sphere |x - p| - R, cylinder |(1 - a a)(x - p)| - R (signs
// reversed for bodies inside). Overlap g = r - d, energy A K_n g^2 / 2, force A K_n g n; friction with the
// tethers of contact/surface_nodes.hpp, in the frame that moves with the surface (which does not turn). The
// tangent is exact for the normal force on a plane, without the curvature of the surface otherwise; friction
// counts as the stiffness of its tethers while they hold. mm, uN, Pa/mm.
#pragma once

#include <functional>

#include "contact/surface_nodes.hpp"
#include "structure/force_term.hpp"

namespace valsalva::assembly {

struct RigidShape {
  enum class Kind { plane, sphere, cylinder } kind = Kind::plane;
  Vec3 point = Vec3::Zero(), direction = Vec3::UnitZ();  ///< direction: unit
  double radius = 0;
  bool inside = false;
  struct Near {
    double distance;
    Vec3 normal;  ///< to the free side; zero on the axis or centre
  };
  Near near(const Vec3& x) const;
};

class RigidSurfaceContact : public structure::ForceTerm {
 public:
  RigidSurfaceContact(std::string name, RigidShape shape, std::function<Vec3(double)> displacement,
                      std::vector<contact::SurfaceNode> nodes, contact::SurfaceParameters parameters);
  std::string name() const override { return name_; }
  void begin_step(const structure::Configuration& now, double dt_s) override;
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  /// All nodes count, whether they touch or not: the stable step holds throughout.
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  void add_tangent(const structure::Configuration& now, structure::BlockMatrix& out) const override;
  structure::Snapshot save() const override { return tethers_.save(); }
  void restore(const structure::Snapshot& snapshot) override { tethers_.restore(snapshot, name_); }
  double penetration_mm(const structure::Configuration& now) const;

 private:
  struct Touch {
    double overlap, force;
    Vec3 normal, place;  // place: in the surface's frame
  };
  Touch touch(std::size_t i, const structure::Configuration& now) const;

  std::string name_;
  RigidShape shape_;
  std::function<Vec3(double)> displacement_;
  std::vector<contact::SurfaceNode> nodes_;
  contact::SurfaceParameters parameters_;
  contact::Tethers tethers_;
};

}  // namespace valsalva::assembly
