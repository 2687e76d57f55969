// One contribution to the forces of a System: elasticity of a body, sewing, contact, a follower load.
#pragma once

#include <string>

#include "core/errors.hpp"
#include "structure/block_matrix.hpp"
#include "structure/system.hpp"

namespace valsalva::structure {

class ForceTerm {
 public:
  virtual ~ForceTerm() = default;
  virtual std::string name() const = 0;

  /// Called once before the forces of every step: broad phase, friction history. dt_s is the coming step.
  virtual void begin_step(const Configuration&, double /*dt_s*/) {}

  /// Adds forces (uN) and moments (uN mm); returns the stored energy (nJ), zero for loads and friction.
  /// The result must not depend on the number of threads.
  virtual double add_forces(const Configuration& now, Forces& out) const = 0;

  /// Adds an upper bound of the stiffness's absolute row sums at this configuration, from which the
  /// integrator takes the stable step, dt <= 2 / sqrt(max_i k_i / m_i), or the mass scaling for a given step.
  virtual void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const = 0;

  /// Adds the stiffness -d(force)/d(position), for implicit solution; it may be an approximation, which costs
  /// Newton iterations but not accuracy. InputError from a term that has none.
  virtual void add_tangent(const Configuration&, BlockMatrix&) const {
    throw InputError("'{}' has no tangent stiffness: use the explicit integrator for this scene", name());
  }

  /// The share of the motion from `now` to the positions `to`, above 0 and up to 1, that may be made so that
  /// nothing passes through anything. Adaptive explicit steps are repeated with that share of their time,
  /// Newton's increments are cut to it.
  virtual double allowed_motion(const Configuration& /*now*/, const Points& /*to*/) const { return 1; }

  /// True where that bound changes from one step to the next, as when contact forms: it is then taken anew in
  /// every step, not only when all bounds are.
  virtual bool stiffness_is_abrupt() const { return false; }

  /// History that a bitwise restart needs; nothing for a term that depends on the configuration alone.
  virtual Snapshot save() const { return {}; }
  virtual void restore(const Snapshot&) {}
};

}  // namespace valsalva::structure
