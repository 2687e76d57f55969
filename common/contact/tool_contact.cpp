#include "contact/tool_contact.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::contact {
namespace {

/// Smooth step from 0 at u <= 0 to 1 at u >= 1, and its slope.
std::pair<double, double> smooth_step(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return {u * u * (3 - 2 * u), 6 * u * (1 - u)};
}

}  // namespace

ToolContact::ToolContact(std::string name, std::function<ToolPosition(double)> motion, double rim_mm,
                         std::vector<SurfaceNode> nodes, SurfaceParameters parameters)
    : name_(std::move(name)),
      motion_(std::move(motion)),
      rim_mm_(rim_mm),
      nodes_(std::move(nodes)),
      parameters_(parameters),
      tethers_(nodes_.size(), parameters.friction, parameters.tangent_Pa_per_mm) {}

ToolContact::Touch ToolContact::touch(const SurfaceNode& s, const Points& x, const ToolPosition& tool) const {
  const Vec3& p = x[s.node];
  const double rho = std::hypot(p[0], p[1]);
  Touch t{rho + s.radius_mm - tool.radius_mm, 0, 0, 0, Vec3::Zero()};
  if (t.overlap_mm <= 0 || p[2] <= tool.z0_mm || p[2] >= tool.z1_mm || rho <= 0) return t;
  const auto [low, low_slope] = smooth_step((p[2] - tool.z0_mm) / rim_mm_);
  const auto [high, high_slope] = smooth_step((tool.z1_mm - p[2]) / rim_mm_);
  t.weight = low * high;
  t.slope = (low_slope * high - low * high_slope) / rim_mm_;
  t.force_uN = t.weight * parameters_.normal_Pa_per_mm * s.area_mm2 * t.overlap_mm;
  t.inward = Vec3(-p[0] / rho, -p[1] / rho, 0);
  return t;
}

void ToolContact::begin_step(const structure::Configuration& now, double) {
  if (tethers_.friction() <= 0) return;
  const ToolPosition tool = motion_(now.time_s);
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const SurfaceNode& s = nodes_[i];
    const Touch t = touch(s, now.x, tool);
    tethers_.advance(i, now.x[s.node] - Vec3(0, 0, tool.drawn_mm), t.inward, t.force_uN, s.area_mm2);
  }
}

double ToolContact::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  const ToolPosition tool = motion_(now.time_s);
  double energy = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const SurfaceNode& s = nodes_[i];
    const Touch t = touch(s, now.x, tool);
    if (t.force_uN <= 0) continue;
    const double full = 0.5 * parameters_.normal_Pa_per_mm * s.area_mm2 * t.overlap_mm * t.overlap_mm;
    energy += t.weight * full;
    out.force[s.node] +=
        t.force_uN * t.inward - Vec3(0, 0, t.slope * full) +
        tethers_.force(i, now.x[s.node] - Vec3(0, 0, tool.drawn_mm), t.inward, t.force_uN, s.area_mm2);
  }
  return energy;
}

void ToolContact::add_stiffness_bound(const structure::Configuration& now,
                                      structure::StiffnessBound& out) const {
  constexpr double ahead_mm = 0.5;  // nodes that are about to touch count too
  const ToolPosition tool = motion_(now.time_s);
  for (const SurfaceNode& s : nodes_) {
    const Vec3& p = now.x[s.node];
    const double overlap = std::hypot(p[0], p[1]) + s.radius_mm - tool.radius_mm;
    if (overlap <= -ahead_mm) continue;
    const double rim = std::max(overlap, 0.0) / rim_mm_;
    out.translation[s.node] += parameters_.normal_Pa_per_mm * s.area_mm2 * (1 + 3 * rim + 3 * rim * rim) +
                               tethers_.stiffness(s.area_mm2);
  }
}

double ToolContact::radial_force_uN(const structure::Configuration& now) const {
  const ToolPosition tool = motion_(now.time_s);
  double sum = 0;
  for (const SurfaceNode& s : nodes_) sum += touch(s, now.x, tool).force_uN;
  return sum;
}

double ToolContact::penetration_mm(const structure::Configuration& now) const {
  const ToolPosition tool = motion_(now.time_s);
  double most = 0;
  for (const SurfaceNode& s : nodes_) {
    const Touch t = touch(s, now.x, tool);
    if (t.force_uN > 0) most = std::max(most, t.overlap_mm);
  }
  return most;
}

}  // namespace valsalva::contact
