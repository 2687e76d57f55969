// Static equilibrium by the explicit integrator: masses scaled to a unit step, damping by kinetic restarts.
#pragma once

#include <memory>

#include "structure/integrator.hpp"

namespace valsalva::structure {

/// Constant force on one node, with its work as energy, and a constant moment on one rotation.
class DeadLoad : public ForceTerm {
 public:
  DeadLoad(int node, Vec3 force, int rotation = -1, Vec3 moment = Vec3::Zero())
      : node_(node), rotation_(rotation), force_(force), moment_(moment) {}
  std::string name() const override { return "load"; }
  double add_forces(const Configuration&, Forces& out) const override {
    out.force[node_] += scale * force_;
    if (rotation_ >= 0) out.moment[rotation_] += scale * moment_;
    return 0;
  }
  void add_stiffness_bound(const Configuration&, StiffnessBound&) const override {}
  double scale = 1;

 private:
  int node_, rotation_;
  Vec3 force_, moment_;
};

/// Steps until the largest velocity is below `tolerance` (length per step); all velocities are set to zero
/// whenever the kinetic energy passes a maximum. Returns the steps taken.
inline int settle(System& system, Integrator& integrator, double tolerance, int most) {
  double before = 0;
  for (int i = 1; i <= most; ++i) {
    integrator.step();
    const double kinetic = integrator.energies().kinetic;
    if (kinetic < before) {
      double fastest = 0;
      for (Vec3& v : system.state.v) {
        fastest = std::max(fastest, v.norm());
        v.setZero();
      }
      for (Vec3& w : system.state.angular_velocity) w.setZero();
      if (fastest < tolerance) return i;
      before = 0;
    } else {
      before = kinetic;
    }
  }
  return most;
}

}  // namespace valsalva::structure
