#include "structure/system.hpp"

#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {

void Forces::reset(std::size_t nodes, std::size_t rotational_nodes) {
  force.assign(nodes, Vec3::Zero());
  moment.assign(rotational_nodes, Vec3::Zero());
}

void StiffnessBound::reset(std::size_t nodes, std::size_t rotational_nodes) {
  translation.assign(nodes, 0.0);
  rotation.assign(rotational_nodes, 0.0);
}

Body System::add_body(const std::string& name, const Points& x, const std::vector<double>& mass) {
  if (has_body(name))
    throw InputError("structure: there are two bodies called '{}'; give each its own name", name);
  VALSALVA_ASSERT(x.size() == mass.size());
  for (std::size_t a = 0; a < mass.size(); ++a)
    if (!(mass[a] > 0) || !std::isfinite(mass[a]))
      throw InputError(
          "structure: node {} of body '{}' has the mass {} g; expected a positive one: is the node "
          "part of an element, and are density and thickness positive?",
          a, name, mass[a]);
  const Body body{name, static_cast<int>(mass_.size()), static_cast<int>(x.size()), -1};
  state.x.insert(state.x.end(), x.begin(), x.end());
  state.v.resize(state.x.size(), Vec3::Zero());
  mass_.insert(mass_.end(), mass.begin(), mass.end());
  rotation_of_.resize(mass_.size(), -1);
  held_.resize(mass_.size(), 0);
  bodies_.push_back(body);
  return bodies_.back();
}

Body System::add_rotational_body(const std::string& name, const Points& x, const std::vector<double>& mass,
                                 const std::vector<Eigen::Quaterniond>& rotation,
                                 const std::vector<double>& inertia) {
  VALSALVA_ASSERT(x.size() == rotation.size() && x.size() == inertia.size());
  for (std::size_t a = 0; a < inertia.size(); ++a)
    if (!(inertia[a] > 0) || !std::isfinite(inertia[a]))
      throw InputError(
          "structure: node {} of body '{}' has the rotary inertia {} g mm2; expected a positive one", a, name,
          inertia[a]);
  add_body(name, x, mass);
  Body& body = bodies_.back();
  body.rotation_offset = static_cast<int>(inertia_.size());
  for (int a = 0; a < body.count; ++a) {
    rotation_of_[body.offset + a] = body.rotation_offset + a;
    node_of_rotation_.push_back(body.offset + a);
    state.rotation.push_back(rotation[a].normalized());
  }
  inertia_.insert(inertia_.end(), inertia.begin(), inertia.end());
  state.angular_velocity.resize(inertia_.size(), Vec3::Zero());
  return body;
}

namespace {

/// Adds a direction to the space that a projector projects on.
void widen(Mat3& projector, const Vec3& direction) {
  const Vec3 fresh = direction.normalized() - projector * direction.normalized();
  if (fresh.norm() > 1e-8) projector += fresh * fresh.transpose() / fresh.squaredNorm();
}

}  // namespace

void System::hold_along(int node, const Vec3& direction) {
  widen(held_directions_.try_emplace(node, Mat3::Zero()).first->second, direction);
}

void System::hold_about(int rotation, const Vec3& axis) {
  widen(held_axes_.try_emplace(rotation, Mat3::Zero()).first->second, axis);
}

Mat3 System::held_directions(int node) const {
  if (held(node)) return Mat3::Identity();
  const auto found = held_directions_.find(node);
  return found == held_directions_.end() ? Mat3::Zero() : found->second;
}

Mat3 System::held_axes(int rotation) const {
  if (held(node_of_rotation(rotation))) return Mat3::Identity();
  const auto found = held_axes_.find(rotation);
  return found == held_axes_.end() ? Mat3::Zero() : found->second;
}

bool System::has_body(const std::string& name) const {
  for (const Body& body : bodies_)
    if (body.name == name) return true;
  return false;
}

const Body& System::body(const std::string& name) const {
  for (const Body& body : bodies_)
    if (body.name == name) return body;
  std::string known;
  for (const Body& body : bodies_) known += (known.empty() ? "" : ", ") + body.name;
  throw InputError("structure: there is no body '{}'; the bodies are: {}", name, known);
}

std::string System::describe(int node) const {
  for (const Body& body : bodies_)
    if (node >= body.begin() && node < body.end())
      return fmt::format("{} node {}", body.name, node - body.offset);
  return fmt::format("node {}", node);
}

}  // namespace valsalva::structure
