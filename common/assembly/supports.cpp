#include "assembly/supports.hpp"

#include <Eigen/Geometry>

#include "assembly/scene.hpp"
#include "core/errors.hpp"

namespace valsalva::assembly {
namespace {

Mat3 held_of(const Support& s) {
  if (s.symmetry) return s.normal * s.normal.transpose();
  Mat3 p = Mat3::Zero();
  for (int d = 0; d < 3; ++d) p(d, d) = s.translation[d] ? 1 : 0;
  return p;
}

Points reference_of(const Support& s, const structure::System& system) {
  Points x;
  for (int a : s.nodes) x.push_back(system.state.x[a]);
  return x;
}

}  // namespace

Mat3 Motion::turn(double time_s) const {
  return Eigen::AngleAxisd(turn_rad * factor(time_s), turn_axis.normalized()).toRotationMatrix();
}

Vec3 Motion::place(const Vec3& reference, double time_s) const {
  Vec3 x = reference + factor(time_s) * (gradient * (reference - turn_point));
  if (turn_rad != 0) x = turn_point + turn(time_s) * (x - turn_point);
  return x + factor(time_s) * displacement;
}

TetherTerm::TetherTerm(const Support& support, const structure::System& system)
    : support_(support), reference_(reference_of(support, system)), held_(held_of(support)) {}

double TetherTerm::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  double energy = 0;
  for (std::size_t i = 0; i < reference_.size(); ++i) {
    const int a = support_.nodes[i];
    const Vec3 d = held_ * (now.x[a] - support_.motion.place(reference_[i], now.time_s));
    energy += 0.5 * support_.tether_uN_per_mm * d.squaredNorm();
    out.force[a] -= support_.tether_uN_per_mm * d;
  }
  return energy;
}

void TetherTerm::add_stiffness_bound(const structure::Configuration&, structure::StiffnessBound& out) const {
  for (int a : support_.nodes) out.translation[a] += support_.tether_uN_per_mm;
}

void TetherTerm::add_tangent(const structure::Configuration&, structure::BlockMatrix& out) const {
  for (int a : support_.nodes) out.add(a, a, support_.tether_uN_per_mm * held_);
}

void hold(const Support& s, const BuiltBody& body, structure::System& system) {
  const Vec3 tangent = s.normal.unitOrthogonal();
  if (body.rigid) {
    if (s.symmetry) {
      body.rigid->hold_along(s.normal);
      body.rigid->hold_about(tangent);
      body.rigid->hold_about(s.normal.cross(tangent));
    }
    for (int d = 0; d < 3; ++d) {
      if (s.translation[d]) body.rigid->hold_along(Vec3::Unit(d));
      if (s.rotation[d]) body.rigid->hold_about(Vec3::Unit(d));
    }
    return;
  }
  for (int a : s.nodes) {
    const int r = system.rotation_of(a);
    if (s.symmetry) {
      system.hold_along(a, s.normal);
      if (r < 0) continue;
      system.hold_about(r, tangent);
      system.hold_about(r, s.normal.cross(tangent));
      continue;
    }
    for (int d = 0; d < 3; ++d) {
      if (s.translation[d]) system.hold_along(a, Vec3::Unit(d));
      if (r >= 0 && s.rotation[d]) system.hold_about(r, Vec3::Unit(d));
    }
  }
}

solve::Supports prescribed_motion(const std::vector<Support>& supports, const structure::System& system) {
  solve::Supports out;
  for (const Support& s : supports) {
    if (!s.holds_nodes() || !s.motion.moves()) continue;
    for (int a : s.nodes) {
      const Vec3 reference = system.state.x[a];
      for (int d = 0; d < 3; ++d)
        if (s.translation[d])
          out.move(a, d,
                   [m = s.motion, reference, d](double t) { return (m.place(reference, t) - reference)[d]; });
      const int r = system.rotation_of(a);
      const int turned = s.rotation[0] + s.rotation[1] + s.rotation[2];
      if (r < 0 || s.motion.turn_rad == 0 || turned == 0) continue;
      if (turned < 3)
        throw InputError(
            "[[support]] '{}': the static and implicit solvers turn beam nodes as a whole; expected rx, ry "
            "and "
            "rz in hold, or solver = \"explicit\" or \"quasi_static\"",
            s.name);
      out.turn(r, [m = s.motion](double t) { return m.turn(t); });
    }
  }
  return out;
}

Drive::Drive(const Scene& scene) {
  for (const Support& s : scene.supports)
    if (s.motion.moves() && s.holds_nodes()) {
      supports_.push_back(s);
      rigid_.push_back(scene.body_of(s.nodes.front()).rigid);
      reference_.push_back(rigid_.back() ? Points{rigid_.back()->properties().centre}
                                         : reference_of(s, *scene.system));
    }
}

void Drive::set_velocities(structure::System& system, double next_s, double dt_s) const {
  structure::Configuration& now = system.state;
  for (std::size_t k = 0; k < supports_.size(); ++k) {
    const Support& s = supports_[k];
    const Mat3 held = held_of(s);
    const Vec3 spin = s.motion.turn_rad * (s.motion.factor(next_s) - s.motion.factor(now.time_s)) / dt_s *
                      s.motion.turn_axis.normalized();
    if (rigid_[k]) {
      rigid_[k]->drive((s.motion.place(reference_[k][0], next_s) - rigid_[k]->centre()) / dt_s, spin);
      continue;
    }
    for (std::size_t i = 0; i < s.nodes.size(); ++i) {
      const int a = s.nodes[i];
      const Vec3 wanted = (s.motion.place(reference_[k][i], next_s) - now.x[a]) / dt_s;
      now.v[a] += held * (wanted - now.v[a]);
      const int r = system.rotation_of(a);
      if (r < 0) continue;
      for (int d = 0; d < 3; ++d)
        if (s.rotation[d]) now.angular_velocity[r][d] = spin[d];
    }
  }
}

}  // namespace valsalva::assembly
