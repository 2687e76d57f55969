// Forces and moments that keep their direction in space: f = s(t) f0 on nodes, m = s(t) m0 on rotations.
// Gravity is f0 = m g. The time is that of the configuration; in statics it is the load factor. A moment that
// is fixed in space has no potential, and forces are counted like other loads: the energy returned is zero.
// uN, uN mm.
#pragma once

#include <functional>
#include <string>

#include "structure/force_term.hpp"

namespace valsalva::structure {

class DeadLoadTerm : public ForceTerm {
 public:
  /// Empty vectors stand for none; otherwise one entry a node (rotation) of the system.
  DeadLoadTerm(std::string name, Points force, Points moment, std::function<double(double)> factor);
  std::string name() const override { return name_; }
  double add_forces(const Configuration& now, Forces& out) const override;
  void add_stiffness_bound(const Configuration&, StiffnessBound&) const override {}
  void add_tangent(const Configuration&, BlockMatrix&) const override {}

 private:
  std::string name_;
  Points force_, moment_;
  std::function<double(double)> factor_;
};

/// m g on the nodes of a body, one entry a node of the system; acceleration in mm/s2.
Points weight_of(const System& system, const Body& body, const Vec3& acceleration);

}  // namespace valsalva::structure
