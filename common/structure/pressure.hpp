// Follower pressure on a triangle mesh: p A n/3 on each node of a triangle, A and n those of the present
// shape, n the normal by the triangle's orientation; positive pressure pushes along n. Pa. The load stores no
// energy here; its work shows in the integrator's balance as work of loads.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "structure/force_term.hpp"

namespace valsalva::structure {

class PressureTerm : public ForceTerm {
 public:
  /// pressure_Pa: of the time in s.
  PressureTerm(std::string name, std::vector<Triangle> triangles, const Body& body,
               std::function<double(double)> pressure_Pa);
  std::string name() const override { return name_; }
  double add_forces(const Configuration& now, Forces& out) const override;
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override;
  /// Exact; not symmetric at the rim.
  void add_tangent(const Configuration& now, BlockMatrix& out) const override;

 private:
  std::string name_;
  std::vector<Triangle> triangles_;
  Body body_;
  std::function<double(double)> pressure_;
};

}  // namespace valsalva::structure
