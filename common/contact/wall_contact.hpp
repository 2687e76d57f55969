// Contact of nodes with a rigid wall given by a level set (negative inside the lumen), with Coulomb friction.
//
// Overlap g = phi(x) + r; energy A K_n g^2 / 2 for g > 0; force -A K_n g grad(phi), friction as in
// surface_nodes.hpp. The gradient is that of the smoothed interpolant (geometry/grid_sdf.hpp), not of the
// trilinear one that gives phi: on a curved wall force and energy agree to second order in the grid spacing.
#pragma once

#include "contact/surface_nodes.hpp"
#include "geometry/grid_sdf.hpp"
#include "structure/force_term.hpp"

namespace valsalva::contact {

class WallContact : public structure::ForceTerm {
 public:
  WallContact(std::string name, geometry::GridSdf level_set, std::vector<SurfaceNode> nodes,
              SurfaceParameters parameters);

  std::string name() const override { return name_; }
  void begin_step(const structure::Configuration& now, double dt_s) override;
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  bool stiffness_is_abrupt() const override { return true; }
  structure::Snapshot save() const override { return tethers_.save(); }
  void restore(const structure::Snapshot& snapshot) override { tethers_.restore(snapshot, name_); }

  struct NodeForce {
    int node = 0;
    double overlap_mm = 0;
    Vec3 normal_uN = Vec3::Zero();    ///< on the node, into the lumen
    Vec3 friction_uN = Vec3::Zero();  ///< on the node
  };
  /// One entry a surface node, in the order given; zero forces where there is no contact.
  std::vector<NodeForce> node_forces(const structure::Configuration& now) const;
  /// Largest overlap, 0 without contact.
  double penetration_mm(const structure::Configuration& now) const;
  const SurfaceParameters& parameters() const { return parameters_; }

 private:
  struct Touch {
    double overlap_mm, force_uN;
    Vec3 inward, slope;
  };
  Touch touch(const SurfaceNode& s, const Points& x) const;

  std::string name_;
  geometry::GridSdf level_set_;
  std::vector<SurfaceNode> nodes_;
  SurfaceParameters parameters_;
  Tethers tethers_;
};

}  // namespace valsalva::contact
