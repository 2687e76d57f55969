#include "assembly/rigid_surface.hpp"

#include <algorithm>

namespace valsalva::assembly {

RigidShape::Near RigidShape::near(const Vec3& x, double growth) const {
  Vec3 d = x - point;
  if (kind == Kind::plane) return {direction.dot(d), direction};
  if (kind == Kind::level_set) {
    const double sign = inside ? -1 : 1;
    const Vec3 slope = level_set->gradient(x);
    const double size = slope.norm();
    return {sign * level_set->value(x), size > 1e-6 ? Vec3(sign / size * slope) : Vec3(Vec3::Zero())};
  }
  Mat3 across = Mat3::Identity();
  if (kind == Kind::cylinder) across -= direction * direction.transpose();
  d = (across * d).eval();
  const double r = d.norm(), sign = inside ? -1 : 1;
  if (!(r > 0)) return {sign * (r - radius - growth), Vec3::Zero()};
  const Vec3 normal = sign / r * d;
  return {sign * (r - radius - growth), normal, sign / r * (across - normal * normal.transpose())};
}

RigidSurfaceContact::RigidSurfaceContact(std::string name, RigidShape shape,
                                         std::function<RigidMotion(double)> motion,
                                         std::vector<contact::SurfaceNode> nodes,
                                         contact::SurfaceParameters parameters)
    : name_(std::move(name)),
      shape_(shape),
      motion_(std::move(motion)),
      nodes_(std::move(nodes)),
      parameters_(parameters),
      tethers_(nodes_.size(), parameters.friction, parameters.tangent_Pa_per_mm) {}

RigidSurfaceContact::Touch RigidSurfaceContact::touch(std::size_t i,
                                                      const structure::Configuration& now) const {
  Touch t;
  const RigidMotion motion = motion_(now.time_s);
  t.place = now.x[nodes_[i].node] - motion.displacement;
  const RigidShape::Near near = shape_.near(t.place, motion.growth);
  t.overlap = nodes_[i].radius_mm - near.distance;
  t.normal = near.normal;
  t.turn = near.turn;
  t.force = std::max(0.0, parameters_.normal_Pa_per_mm * nodes_[i].area_mm2 * t.overlap);
  return t;
}

void RigidSurfaceContact::begin_step(const structure::Configuration& now, double) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Touch t = touch(i, now);
    tethers_.advance(i, t.place, t.normal, t.force, nodes_[i].area_mm2);
  }
}

double RigidSurfaceContact::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  double energy = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Touch t = touch(i, now);
    if (t.force <= 0) continue;
    energy += 0.5 * t.force * t.overlap;
    out.force[nodes_[i].node] +=
        t.force * t.normal + tethers_.force(i, t.place, t.normal, t.force, nodes_[i].area_mm2);
  }
  return energy;
}

void RigidSurfaceContact::add_stiffness_bound(const structure::Configuration&,
                                              structure::StiffnessBound& out) const {
  for (const contact::SurfaceNode& s : nodes_)
    out.translation[s.node] += parameters_.normal_Pa_per_mm * s.area_mm2 + tethers_.stiffness(s.area_mm2);
}

void RigidSurfaceContact::add_tangent(const structure::Configuration& now,
                                      structure::BlockMatrix& out) const {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Touch t = touch(i, now);
    if (t.force <= 0) continue;
    const double area = nodes_[i].area_mm2;
    const Mat3 normal = t.normal * t.normal.transpose();
    Mat3 k = parameters_.normal_Pa_per_mm * area * normal - t.force * t.turn;
    if (tethers_.engaged(i)) {
      const Vec3 friction = tethers_.force(i, t.place, t.normal, t.force, area);
      const double limit = tethers_.friction() * t.force;
      if (friction.norm() < (1 - 1e-9) * limit)
        k += tethers_.stiffness(area) * (Mat3::Identity() - normal);
      else
        k += parameters_.normal_Pa_per_mm * area / t.force * friction * t.normal.transpose();
    }
    out.add(nodes_[i].node, nodes_[i].node, k);
  }
}

double RigidSurfaceContact::area_mm2(const structure::Configuration& now) const {
  double sum = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (touch(i, now).force > 0) sum += nodes_[i].area_mm2;
  return sum;
}

double RigidSurfaceContact::penetration_mm(const structure::Configuration& now) const {
  double most = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) most = std::max(most, touch(i, now).overlap);
  return most;
}

}  // namespace valsalva::assembly
