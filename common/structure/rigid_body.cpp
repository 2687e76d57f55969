#include "structure/rigid_body.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

constexpr int midpoint_iterations = 50;

Eigen::Quaterniond turned(const Vec3& turn, const Eigen::Quaterniond& q) {
  const double angle = turn.norm();
  if (angle == 0) return q;
  return (Eigen::AngleAxisd(angle, turn / angle) * q).normalized();
}

void widen(Mat3& projector, const Vec3& direction) {
  const Vec3 fresh = direction.normalized() - projector * direction.normalized();
  if (fresh.norm() > 1e-8) projector += fresh * fresh.transpose() / fresh.squaredNorm();
}

void refuse_open(const std::vector<Triangle>& triangles, const std::string& what) {
  std::map<std::array<int, 2>, int> users;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++users[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : users)
    if (count != 1 || !users.contains({edge[1], edge[0]}))
      throw InputError(
          "{}: its surface is not closed and of one orientation (edge {}-{}); expected a closed surface, or "
          "mass_g, inertia_g_mm2 and centre_mm",
          what, edge[0], edge[1]);
}

}  // namespace

RigidProperties properties_of(const Points& x, const std::vector<Triangle>& closed, double density,
                              const std::string& what) {
  refuse_open(closed, what);
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();  // integral of x x^T
  const Vec3 origin = x[closed.front()[0]];
  for (const Triangle& t : closed) {
    const Vec3 a = x[t[0]] - origin, b = x[t[1]] - origin, c = x[t[2]] - origin, sum = a + b + c;
    const double six = a.dot(b.cross(c));
    volume += six / 6;
    first += six / 24 * sum;
    second += six / 120 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  if (!(volume > 0))
    throw InputError("{}: its surface encloses {} mm3; expected normals outwards", what, volume);
  RigidProperties p;
  p.mass_g = density * volume;
  const Vec3 centre = first / volume;
  second -= volume * centre * centre.transpose();
  p.centre = origin + centre;
  p.inertia = density * (second.trace() * Mat3::Identity() - second);
  return p;
}

RigidBody::RigidBody(System& system, const Body& body, const RigidProperties& properties)
    : body_(body), properties_(properties), centre_(properties.centre) {
  const Vec3 principal = Eigen::SelfAdjointEigenSolver<Mat3>(properties.inertia).eigenvalues();
  if (!(properties.mass_g > 0) || !(principal[0] > 0))
    throw InputError(
        "rigid body '{}': mass {} g, principal moments of inertia {}, {}, {} g mm2; expected all positive",
        body.name, properties.mass_g, principal[0], principal[1], principal[2]);
  for (int a = body.begin(); a < body.end(); ++a) {
    arms_.push_back(system.state.x[a] - centre_);
    system.hold(a);
  }
}

void RigidBody::set_velocity(const Vec3& velocity, const Vec3& spin) {
  velocity_ = velocity;
  angular_momentum_ = properties_.inertia * spin;
}

Vec3 RigidBody::weight(double time_s) const {
  Vec3 sum = Vec3::Zero();
  for (const auto& g : gravity_) sum += properties_.mass_g * g(time_s);
  return sum;
}

void RigidBody::hold_along(const Vec3& direction) {
  widen(held_, direction);
}

void RigidBody::hold_about(const Vec3& axis) {
  widen(held_spin_, axis);
}

void RigidBody::drive(const Vec3& velocity, const Vec3& spin) {
  driven_ = held_ * velocity;
  driven_spin_ = held_spin_ * spin;
}

double RigidBody::largest_ratio(const StiffnessBound& bound) const {
  const double inertia = Eigen::SelfAdjointEigenSolver<Mat3>(properties_.inertia).eigenvalues()[0];
  double translation = 0, rotation = 0;
  for (int a = body_.begin(); a < body_.end(); ++a) {
    translation += bound.translation[a];
    rotation += bound.translation[a] * arms_[a - body_.begin()].squaredNorm();
  }
  return translation / properties_.mass_g + rotation / inertia;
}

Vec3 RigidBody::spin_at(const Eigen::Quaterniond& rotation, const Vec3& angular_momentum,
                        const Mat3& extra) const {
  const Mat3 r = rotation.toRotationMatrix();
  const Mat3 inertia = r * properties_.inertia * r.transpose() + extra;
  const Mat3 free = Mat3::Identity() - held_spin_;
  const Mat3 reduced = free * inertia * free + inertia.trace() * held_spin_;
  return driven_spin_ + free * (reduced.inverse() * (free * angular_momentum));
}

Vec3 RigidBody::spin() const {
  return spin_at(rotation_, angular_momentum_, extra_inertia_);
}

Vec3 RigidBody::force(const Forces& forces) const {
  Vec3 sum = Vec3::Zero();
  for (int a = body_.begin(); a < body_.end(); ++a) sum += forces.force[a];
  return sum;
}

Vec3 RigidBody::torque(const System& system, const Forces& forces) const {
  Vec3 sum = Vec3::Zero();
  for (int a = body_.begin(); a < body_.end(); ++a)
    sum += (system.state.x[a] - centre_).cross(forces.force[a]);
  return sum;
}

void RigidBody::advance(System& system, const Forces& forces, const std::vector<double>& extra_mass,
                        double kick_s, double dt_s, double damping_per_s) {
  const double damping = 0.5 * damping_per_s * kick_s;
  double mass = properties_.mass_g;
  extra_inertia_.setZero();
  for (int a = body_.begin(); a < body_.end(); ++a) {
    mass += extra_mass[a];
    extra_inertia_ += extra_mass[a] * arms_[a - body_.begin()].squaredNorm() * Mat3::Identity();
  }
  const Vec3 heavy = weight(system.state.time_s);
  const Vec3 before = velocity_;
  velocity_ = ((1 - damping) * before + kick_s / mass * (force(forces) + heavy)) / (1 + damping);
  velocity_ += held_ * (driven_ - velocity_);
  gravity_work_ += 0.5 * kick_s * heavy.dot(before + velocity_);
  angular_momentum_ = ((1 - damping) * angular_momentum_ + kick_s * torque(system, forces)) / (1 + damping);
  angular_momentum_ -= held_spin_ * angular_momentum_;

  Vec3 w = spin();
  for (int i = 0; i < midpoint_iterations; ++i) {
    const Vec3 next = spin_at(turned(0.5 * dt_s * w, rotation_), angular_momentum_, extra_inertia_);
    const bool still = (next - w).norm() <= 1e-15 * next.norm();
    w = next;
    if (still) break;
  }
  if (!velocity_.allFinite() || !w.allFinite() || !(dt_s * w.norm() < 1))
    throw NumericalFailure(
        "rigid body '{}' moves at {:.3g} mm/s and turns by {:.3g} rad in one step at {:.6g} s (alarm at 1); "
        "reduce the step",
        body_.name, velocity_.norm(), dt_s * w.norm(), system.state.time_s);
  rotation_ = turned(dt_s * w, rotation_);
  centre_ += dt_s * velocity_;
  const Mat3 r = rotation_.toRotationMatrix();
  for (int a = body_.begin(); a < body_.end(); ++a)
    system.state.v[a] = (centre_ + r * arms_[a - body_.begin()] - system.state.x[a]) / dt_s;
}

double RigidBody::kinetic_energy() const {
  return 0.5 * (properties_.mass_g * velocity_.squaredNorm() + spin().dot(angular_momentum_));
}

Vec3 RigidBody::angular_momentum() const {
  return angular_momentum_ + properties_.mass_g * centre_.cross(velocity_);
}

std::vector<double> RigidBody::save() const {
  std::vector<double> s;
  for (const Vec3& v : {centre_, velocity_, angular_momentum_}) s.insert(s.end(), {v[0], v[1], v[2]});
  s.insert(s.end(), {rotation_.w(), rotation_.x(), rotation_.y(), rotation_.z(), gravity_work_});
  return s;
}

void RigidBody::restore(const std::vector<double>& s) {
  if (s.size() != 14)
    throw InputError(
        "rigid body '{}': the state holds {} values of it, expected 14: it belongs to another scene",
        body_.name, s.size());
  const auto vector = [&](int i) { return Vec3(s[i], s[i + 1], s[i + 2]); };
  centre_ = vector(0);
  velocity_ = vector(3);
  angular_momentum_ = vector(6);
  rotation_ = Eigen::Quaterniond(s[9], s[10], s[11], s[12]);
  gravity_work_ = s[13];
}

}  // namespace valsalva::structure
