// What the delivery system does to the bodies.
#pragma once

#include <functional>

#include "contact/surface_nodes.hpp"
#include "structure/force_term.hpp"

namespace valsalva::deploy {

/// Pushes some nodes along z until the mean height of others is at a target: force s(t) k (target - mean z),
/// shared equally. Struts carry what the edge of the skirt, which is watched, could not. A load: no energy.
class HeightHold : public structure::ForceTerm {
 public:
  HeightHold(std::vector<int> pushed, std::vector<int> watched, double target_mm, double stiffness_uN_per_mm,
             std::function<double(double)> scale);
  std::string name() const override { return "delivery system"; }
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  /// With which it pushes along +z.
  double force_uN(const structure::Configuration& now) const;

 private:
  std::vector<int> pushed_, watched_;
  double target_, stiffness_;
  std::function<double(double)> scale_;
};

/// The nose of the delivery system passing the native valve: a rigid cylinder about a line, that pushes nodes
/// outwards and whose radius grows with time: E = sum A K g^2/2, g = R(t) + r - rho > 0.
class Dilator : public structure::ForceTerm {
 public:
  Dilator(std::vector<contact::SurfaceNode> nodes, Vec3 axis_point, Vec3 axis, double stiffness_Pa_per_mm,
          std::function<double(double)> radius_mm);
  std::string name() const override { return "nose of the delivery system"; }
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  bool stiffness_is_abrupt() const override { return true; }
  double penetration_mm(const structure::Configuration& now) const;

 private:
  Vec3 away(const Vec3& x) const;
  std::vector<contact::SurfaceNode> nodes_;
  Vec3 point_, axis_;
  double stiffness_;
  std::function<double(double)> radius_;
};

}  // namespace valsalva::deploy
