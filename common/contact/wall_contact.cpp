#include "contact/wall_contact.hpp"

#include <algorithm>

namespace valsalva::contact {

WallContact::WallContact(std::string name, geometry::GridSdf level_set, std::vector<SurfaceNode> nodes,
                         SurfaceParameters parameters)
    : name_(std::move(name)),
      level_set_(std::move(level_set)),
      nodes_(std::move(nodes)),
      parameters_(parameters),
      tethers_(nodes_.size(), parameters.friction, parameters.tangent_Pa_per_mm) {}

WallContact::Touch WallContact::touch(const SurfaceNode& s, const Points& x) const {
  Touch t{level_set_.value(x[s.node]) + s.radius_mm, 0, Vec3::Zero(), Vec3::Zero()};
  if (t.overlap_mm <= 0) return t;
  t.slope = level_set_.gradient(x[s.node]);
  const double size = t.slope.norm();
  if (size < 1e-6) return t;
  t.inward = -t.slope / size;
  t.force_uN = parameters_.normal_Pa_per_mm * s.area_mm2 * t.overlap_mm * size;
  return t;
}

void WallContact::begin_step(const structure::Configuration& now, double) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Touch t = touch(nodes_[i], now.x);
    tethers_.advance(i, now.x[nodes_[i].node], t.inward, t.force_uN, nodes_[i].area_mm2);
  }
}

double WallContact::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  double energy = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const SurfaceNode& s = nodes_[i];
    const Touch t = touch(s, now.x);
    if (t.force_uN <= 0) continue;
    energy += 0.5 * parameters_.normal_Pa_per_mm * s.area_mm2 * t.overlap_mm * t.overlap_mm;
    out.force[s.node] +=
        t.force_uN * t.inward + tethers_.force(i, now.x[s.node], t.inward, t.force_uN, s.area_mm2);
  }
  return energy;
}

void WallContact::add_stiffness_bound(const structure::Configuration& now,
                                      structure::StiffnessBound& out) const {
  // Nodes that are about to touch count too: the bound has to hold for the steps to come.
  const double ahead = level_set_.spacing;
  for (const SurfaceNode& s : nodes_)
    if (level_set_.value(now.x[s.node]) + s.radius_mm > -ahead)
      out.translation[s.node] += parameters_.normal_Pa_per_mm * s.area_mm2 + tethers_.stiffness(s.area_mm2);
}

std::vector<WallContact::NodeForce> WallContact::node_forces(const structure::Configuration& now) const {
  std::vector<NodeForce> all;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const SurfaceNode& s = nodes_[i];
    const Touch t = touch(s, now.x);
    NodeForce f{s.node, std::max(0.0, t.overlap_mm), Vec3::Zero(), Vec3::Zero()};
    if (t.force_uN > 0) {
      f.normal_uN = t.force_uN * t.inward;
      f.friction_uN = tethers_.force(i, now.x[s.node], t.inward, t.force_uN, s.area_mm2);
    }
    all.push_back(f);
  }
  return all;
}

double WallContact::penetration_mm(const structure::Configuration& now) const {
  double most = 0;
  for (const SurfaceNode& s : nodes_) most = std::max(most, touch(s, now.x).overlap_mm);
  return most;
}

}  // namespace valsalva::contact
