// What holds and moves nodes: rigid holds of components, symmetry planes, prescribed motion, elastic tethers.
//
// A held component follows X + u(t): u the displacement, or the turn about an axis, times the factor at t.
// Explicit: the velocity of the coming step is set so that the component arrives there. Implicit: the same
// motion through solve::Supports. On a free rigid body a support holds and moves the body: translation of its
// centre, rotations about the axes of space.
#pragma once

#include <string>
#include <vector>

#include "assembly/body.hpp"
#include "assembly/time_table.hpp"
#include "solve/equations.hpp"
#include "structure/force_term.hpp"

namespace valsalva::assembly {

struct Scene;

struct Motion {
  TimeTable factor = TimeTable::constant(0);
  Vec3 displacement = Vec3::Zero();
  Mat3 gradient = Mat3::Zero();  ///< adds gradient (X - turn_point)
  double turn_rad = 0;
  Vec3 turn_axis = Vec3::UnitZ(), turn_point = Vec3::Zero();
  bool moves() const { return !displacement.isZero() || !gradient.isZero() || turn_rad != 0; }
  Vec3 place(const Vec3& reference, double time_s) const;
  Mat3 turn(double time_s) const;
};

struct Support {
  std::string name;
  std::vector<int> nodes;  ///< of the system
  std::array<bool, 3> translation{}, rotation{};
  bool symmetry = false;
  Vec3 normal = Vec3::UnitZ();
  double tether_uN_per_mm = 0;  ///< above 0: no rigid hold
  Motion motion;
  bool holds_nodes() const { return !(tether_uN_per_mm > 0); }
};

/// Elastic tethers of a support: E = k/2 |P (x - X - u(t))|^2, P the held components.
class TetherTerm : public structure::ForceTerm {
 public:
  TetherTerm(const Support& support, const structure::System& system);
  std::string name() const override { return support_.name; }
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  void add_tangent(const structure::Configuration& now, structure::BlockMatrix& out) const override;

 private:
  Support support_;
  Points reference_;
  Mat3 held_;
};

/// Holds the components in the system, or those of the free rigid body that its nodes are of. Call while the
/// system is in its reference shape.
void hold(const Support& support, const BuiltBody& body, structure::System& system);

/// The prescribed motions for the implicit solvers, which take what is held from the system. Call while the
/// system is in its reference shape. InputError where some, but not all rotations of a beam's node are
/// turned.
solve::Supports prescribed_motion(const std::vector<Support>& supports, const structure::System& system);

/// Sets the velocities (explicit) of all moving supports for the step from the state's time to `next_s`.
class Drive {
 public:
  Drive(const Scene& scene);
  void set_velocities(structure::System& system, double next_s, double dt_s) const;
  bool moves() const { return !supports_.empty(); }

 private:
  std::vector<Support> supports_;
  std::vector<Points> reference_;
  std::vector<std::shared_ptr<structure::RigidBody>> rigid_;  // or null, of each support
};

}  // namespace valsalva::assembly
