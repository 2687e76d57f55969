// Contact of nodes with a rigid surface that may be moved, analytic or given by a level set, with Coulomb
// friction. Spheres and cylinders may change their radius (crimper, balloon).
//
// Distance d(x) on the free side: plane n.(x - p); sphere |x - p| - R, cylinder |(1 - a a)(x - p)| - R (signs
// reversed for bodies inside), level set phi(x). Overlap g = r - d, energy A K_n g^2 / 2, force A K_n g n;
// friction with the tethers of contact/surface_nodes.hpp, in the frame that moves with the surface (which
// does not turn). The tangent is exact without friction, but for the curvature of level sets; friction
// counts as the stiffness of its tethers while they hold, and as mu times that of the normal force when they
// slip (unsymmetric). A level set's gradient is that of its smoothed interpolant, as in
// contact/wall_contact.hpp. mm, uN, Pa/mm.
#pragma once

#include <functional>
#include <memory>

#include "contact/surface_nodes.hpp"
#include "geometry/grid_sdf.hpp"
#include "structure/force_term.hpp"

namespace valsalva::assembly {

struct RigidShape {
  enum class Kind { plane, sphere, cylinder, level_set } kind = Kind::plane;
  Vec3 point = Vec3::Zero(), direction = Vec3::UnitZ();  ///< direction: unit
  double radius = 0;
  bool inside = false;
  std::shared_ptr<const geometry::GridSdf> level_set;
  struct Near {
    double distance;
    Vec3 normal;               ///< to the free side; zero on the axis or centre
    Mat3 turn = Mat3::Zero();  ///< d(normal)/dx; zero for level sets
  };
  /// The radius is larger by `growth`.
  Near near(const Vec3& x, double growth = 0) const;
};

/// Of a surface over time: where it has gone and by how much its radius has grown.
struct RigidMotion {
  Vec3 displacement = Vec3::Zero();
  double growth = 0;
};

class RigidSurfaceContact : public structure::ForceTerm {
 public:
  RigidSurfaceContact(std::string name, RigidShape shape, std::function<RigidMotion(double)> motion,
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
  /// Of the nodes that touch.
  double area_mm2(const structure::Configuration& now) const;

 private:
  struct Touch {
    double overlap, force;
    Vec3 normal, place;  // place: in the surface's frame
    Mat3 turn;           // of the normal
  };
  Touch touch(std::size_t i, const structure::Configuration& now) const;

  std::string name_;
  RigidShape shape_;
  std::function<RigidMotion(double)> motion_;
  std::vector<contact::SurfaceNode> nodes_;
  contact::SurfaceParameters parameters_;
  contact::Tethers tethers_;
};

}  // namespace valsalva::assembly
