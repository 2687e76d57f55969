// Static equilibrium by the explicit integrator: masses scaled to a unit step, adaptive damping.
#pragma once

#include <algorithm>
#include <cmath>
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

/// Dynamic relaxation: damping follows 2 omega, omega^2 the Rayleigh quotient of the present motion
/// (Underwood 1983), until the largest velocity (length per step) has stayed below `tolerance` for 500 steps.
/// Returns the steps taken.
inline int settle(System& system, Integrator& integrator, double tolerance, int most) {
  Points force, velocity;
  int quiet = 0;
  for (int i = 1; i <= most; ++i) {
    integrator.step();
    const Points& now = integrator.forces().force;
    double work = 0, inertia = 0, fastest = 0;
    for (std::size_t a = 0; a < now.size(); ++a) {
      fastest = std::max(fastest, system.state.v[a].norm());
      if (force.empty()) continue;
      work -= (now[a] - force[a]).dot(velocity[a]);
      inertia += integrator.mass(static_cast<int>(a)) * velocity[a].squaredNorm();
    }
    if (inertia > 0) integrator.set_damping(2 * std::min(0.5, std::sqrt(std::max(work / inertia, 1e-12))));
    force = now;
    velocity = system.state.v;
    quiet = fastest < tolerance ? quiet + 1 : 0;
    if (quiet == 500) return i;
  }
  return most;
}

}  // namespace valsalva::structure
