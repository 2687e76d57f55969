#include "loads.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::deploy {

using structure::Configuration;

HeightHold::HeightHold(std::vector<int> pushed, std::vector<int> watched, double target_mm,
                       double stiffness_uN_per_mm, std::function<double(double)> scale)
    : pushed_(std::move(pushed)),
      watched_(std::move(watched)),
      target_(target_mm),
      stiffness_(stiffness_uN_per_mm),
      scale_(std::move(scale)) {}

double HeightHold::force_uN(const Configuration& now) const {
  double mean = 0;
  for (int a : watched_) mean += now.x[a].z();
  return scale_(now.time_s) * stiffness_ * (target_ - mean / static_cast<double>(watched_.size()));
}

double HeightHold::add_forces(const Configuration& now, structure::Forces& out) const {
  const double share = force_uN(now) / static_cast<double>(pushed_.size());
  for (int a : pushed_) out.force[a].z() += share;
  return 0;
}

void HeightHold::add_stiffness_bound(const Configuration&, structure::StiffnessBound& out) const {
  for (int a : pushed_) out.translation[a] += 2 * stiffness_ / static_cast<double>(pushed_.size());
}

Dilator::Dilator(std::vector<contact::SurfaceNode> nodes, Vec3 axis_point, Vec3 axis,
                 double stiffness_Pa_per_mm, std::function<double(double)> radius_mm)
    : nodes_(std::move(nodes)),
      point_(axis_point),
      axis_(axis.normalized()),
      stiffness_(stiffness_Pa_per_mm),
      radius_(std::move(radius_mm)) {}

Vec3 Dilator::away(const Vec3& x) const {
  const Vec3 d = x - point_;
  return d - d.dot(axis_) * axis_;
}

double Dilator::add_forces(const Configuration& now, structure::Forces& out) const {
  const double radius = radius_(now.time_s);
  double energy = 0;
  for (const contact::SurfaceNode& s : nodes_) {
    const Vec3 d = away(now.x[s.node]);
    const double rho = std::max(d.norm(), 1e-9), overlap = radius + s.radius_mm - rho;
    if (radius <= 0 || overlap <= 0) continue;
    const double force = stiffness_ * s.area_mm2 * overlap;
    out.force[s.node] += force / rho * d;
    energy += 0.5 * force * overlap;
  }
  return energy;
}

void Dilator::add_stiffness_bound(const Configuration& now, structure::StiffnessBound& out) const {
  const double reach = radius_(now.time_s) + 0.5;
  for (const contact::SurfaceNode& s : nodes_)
    if (away(now.x[s.node]).norm() < reach + s.radius_mm)
      out.translation[s.node] += 2 * stiffness_ * s.area_mm2;
}

double Dilator::penetration_mm(const Configuration& now) const {
  double worst = 0;
  for (const contact::SurfaceNode& s : nodes_)
    worst = std::max(worst, radius_(now.time_s) + s.radius_mm - away(now.x[s.node]).norm());
  return worst;
}

}  // namespace valsalva::deploy
