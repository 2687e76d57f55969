// Contact of nodes with the inside of a rigid round tool about the z axis: a crimper, a sheath.
//
// The tool has radius R, covers z0 <= z <= z1 and may be drawn along the axis; all three are given functions
// of time. Overlap g = rho + r - R with rho the node's distance from the axis; energy w(z) A K_n g^2 / 2 for
// g > 0; w falls smoothly from 1 to 0 within `rim_mm` inside each end, so that a node slides off the rim
// instead of falling. Friction as in surface_nodes.hpp, in the frame that moves with the tool along the axis;
// closing does not drag nodes round or along. The force of w' pushes along the axis, as a rounded rim does.
#pragma once

#include <functional>

#include "contact/surface_nodes.hpp"
#include "structure/force_term.hpp"

namespace valsalva::contact {

struct ToolPosition {
  double radius_mm = 0;
  double z0_mm = 0, z1_mm = 0;
  double drawn_mm = 0;  ///< how far the tool has moved along +z since the start
};

class ToolContact : public structure::ForceTerm {
 public:
  ToolContact(std::string name, std::function<ToolPosition(double time_s)> motion, double rim_mm,
              std::vector<SurfaceNode> nodes, SurfaceParameters parameters);

  std::string name() const override { return name_; }
  void begin_step(const structure::Configuration& now, double dt_s) override;
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  bool stiffness_is_abrupt() const override { return true; }
  structure::Snapshot save() const override { return tethers_.save(); }
  void restore(const structure::Snapshot& snapshot) override { tethers_.restore(snapshot, name_); }

  /// Sum of the normal forces on the nodes (uN): the hoop-integrated radial force of the tool.
  double radial_force_uN(const structure::Configuration& now) const;
  double penetration_mm(const structure::Configuration& now) const;
  ToolPosition position(double time_s) const { return motion_(time_s); }

 private:
  struct Touch {
    double overlap_mm, weight, slope, force_uN;
    Vec3 inward;
  };
  Touch touch(const SurfaceNode& s, const Points& x, const ToolPosition& tool) const;

  std::string name_;
  std::function<ToolPosition(double)> motion_;
  double rim_mm_;
  std::vector<SurfaceNode> nodes_;
  SurfaceParameters parameters_;
  Tethers tethers_;
};

}  // namespace valsalva::contact
