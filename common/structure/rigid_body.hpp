// A rigid body that moves freely: the nodes of its surface follow six degrees of freedom.
//
//   M dv/dt = F + M g,   dL/dt = T,   L = R I R^T w,   dR/dt = [w]x R,   F, T: sums of the nodes' forces.
// Explicit: the leapfrog of structure/integrator.hpp for v and L; the orientation by R+ = exp(dt w) R with w
// at mid-step, w = R_m I^-1 R_m^T L, R_m = exp(dt w/2) R (implicit midpoint, iterated until it stands still):
// of second order, time-reversible, |L| is kept to round-off and the energy of a free top does not drift.
// Held components are taken out of F and T. The nodes are held in the System; their velocities carry them to
// where the body is after the step.
//
// Dynamic relaxation adds the nodes' scaled masses to M and, times r^2, to I; statics does not depend on
// them. mm, g, s, uN, uN mm, g mm2.
#pragma once

#include <functional>
#include <string>

#include "structure/system.hpp"

namespace valsalva::structure {

struct RigidProperties {
  double mass_g = 0;
  Vec3 centre = Vec3::Zero();
  Mat3 inertia = Mat3::Zero();  ///< about the centre, in the axes of space at the start
};

/// Of the inside of a closed, outward surface, uniformly filled. InputError with `what` when it is open or
/// its volume is not positive.
RigidProperties properties_of(const Points& x, const std::vector<Triangle>& closed, double density_g_per_mm3,
                              const std::string& what);

class RigidBody {
 public:
  /// Holds the body's nodes in the system. InputError when mass or inertia are not positive definite.
  RigidBody(System& system, const Body& body, const RigidProperties& properties);

  const std::string& name() const { return body_.name; }
  const Body& body() const { return body_; }
  const RigidProperties& properties() const { return properties_; }

  /// Velocity of the centre and spin, at the start.
  void set_velocity(const Vec3& velocity, const Vec3& spin);
  /// A further acceleration of gravity, of time.
  void add_gravity(std::function<Vec3(double)> acceleration) { gravity_.push_back(std::move(acceleration)); }
  Vec3 weight(double time_s) const;
  /// Holds translation along, or rotation about, a direction in space.
  void hold_along(const Vec3& direction);
  void hold_about(const Vec3& axis);
  /// Velocity of the centre along the held directions and spin about the held axes, for the coming step.
  void drive(const Vec3& velocity, const Vec3& spin);

  /// Upper bound of the square of the largest frequency of the body against its surroundings, 1/s2: the
  /// nodes' stiffness bounds over mass and smallest inertia.
  double largest_ratio(const StiffnessBound& bound) const;
  /// One step: kick over `kick_s`, drift over `dt_s`; mass: of the nodes, beyond their own (0: none).
  void advance(System& system, const Forces& forces, const std::vector<double>& extra_mass, double kick_s,
               double dt_s, double damping_per_s);

  /// Projector on what is held of the translation, and of the rotation.
  const Mat3& held() const { return held_; }
  const Mat3& held_spin() const { return held_spin_; }
  const Vec3& centre() const { return centre_; }
  const Vec3& velocity() const { return velocity_; }
  const Eigen::Quaterniond& rotation() const { return rotation_; }
  Vec3 spin() const;
  double kinetic_energy() const;
  Vec3 momentum() const { return properties_.mass_g * velocity_; }
  /// About the origin.
  Vec3 angular_momentum() const;
  /// Force and torque about the centre on it, at these forces.
  Vec3 force(const Forces& forces) const;
  Vec3 torque(const System& system, const Forces& forces) const;
  /// Work of gravity, damping and held components since the start, nJ.
  double gravity_work() const { return gravity_work_; }

  std::vector<double> save() const;
  void restore(const std::vector<double>& values);

 private:
  Vec3 spin_at(const Eigen::Quaterniond& rotation, const Vec3& angular_momentum, const Mat3& extra) const;

  Body body_;
  RigidProperties properties_;
  Points arms_;  // from the centre, in the axes of the start
  std::vector<std::function<Vec3(double)>> gravity_;
  Mat3 held_ = Mat3::Zero(), held_spin_ = Mat3::Zero();
  Vec3 driven_ = Vec3::Zero(), driven_spin_ = Vec3::Zero();
  Vec3 centre_, velocity_ = Vec3::Zero(), angular_momentum_ = Vec3::Zero();
  Mat3 extra_inertia_ = Mat3::Zero();
  Eigen::Quaterniond rotation_ = Eigen::Quaterniond::Identity();
  double gravity_work_ = 0;
};

}  // namespace valsalva::structure
