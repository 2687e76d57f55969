// The mechanical system that the explicit integrator advances: the nodes of all bodies, one after the other.
//
// A node has a position and a velocity; the nodes of a rotational body (beams) have also a rotation, the unit
// quaternion that turns the reference directions of the node to its present ones, and a spatial angular
// velocity. Masses are lumped. The rotary inertia of a node is isotropic: its product with the angular
// velocity is parallel to it, and no gyroscopic term appears (beams are thin, and their rotary inertia is
// scaled for the step anyway).
//
// Held nodes keep the velocity that they were given: zero for a fixed node, other for a prescribed motion. A
// node may also be held along some directions only (roller, symmetry plane), its rotation about some axes
// only.
// Units: mm, g, s; force uN, moment uN mm, rotary inertia g mm2.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/types.hpp"

namespace valsalva::structure {

struct Configuration {
  Points x;                                  ///< current positions, all bodies
  Points v;                                  ///< velocities, mm/s
  std::vector<Eigen::Quaterniond> rotation;  ///< rotational nodes only, see System::rotation_of
  Points angular_velocity;                   ///< rad/s, in space
  double time_s = 0;
};

/// What a force term adds to: one entry a node, one moment (in space) a rotational node.
struct Forces {
  Points force;
  Points moment;
  void reset(std::size_t nodes, std::size_t rotational_nodes);
};

/// Upper bounds of the row sums of the stiffness, per node: the largest eigenvalue of M^-1 K is at most
/// max_i (sum_j |K_ij|) / m_i.
struct StiffnessBound {
  std::vector<double> translation;  ///< uN/mm
  std::vector<double> rotation;     ///< uN mm/rad
  void reset(std::size_t nodes, std::size_t rotational_nodes);
};

/// A named run of consecutive nodes.
struct Body {
  std::string name;
  int offset = 0;
  int count = 0;
  int rotation_offset = -1;  ///< index of its first rotational node; -1: no rotations
  int begin() const { return offset; }
  int end() const { return offset + count; }
  bool rotational() const { return rotation_offset >= 0; }
};

/// Named arrays: what a restart needs.
using Snapshot = std::map<std::string, std::vector<double>>;

class System {
 public:
  /// mass: g, one a node, all positive. InputError names the body and node otherwise.
  Body add_body(const std::string& name, const Points& x, const std::vector<double>& mass);
  /// inertia: g mm2, one a node, all positive.
  Body add_rotational_body(const std::string& name, const Points& x, const std::vector<double>& mass,
                           const std::vector<Eigen::Quaterniond>& rotation,
                           const std::vector<double>& inertia);

  const std::vector<Body>& bodies() const { return bodies_; }
  bool has_body(const std::string& name) const;
  /// InputError when there is no such body.
  const Body& body(const std::string& name) const;
  /// "leaflets node 12" for a global node index.
  std::string describe(int node) const;
  std::size_t nodes() const { return mass_.size(); }
  std::size_t rotational_nodes() const { return inertia_.size(); }
  /// Index of the node's rotation, or -1.
  int rotation_of(int node) const { return rotation_of_[node]; }
  /// The global node of a rotation.
  int node_of_rotation(int rotation) const { return node_of_rotation_[rotation]; }

  /// Keep the node's velocity (and angular velocity) as it stands in the configuration.
  void hold(int node) { held_[node] = 1; }
  void release(int node) { held_[node] = 0; }
  bool held(int node) const { return held_[node] != 0; }
  /// Hold the motion along one more direction, or the rotation about one more axis.
  void hold_along(int node, const Vec3& direction);
  void hold_about(int rotation, const Vec3& axis);
  bool partly_held(int node) const { return held_directions_.count(node) > 0; }
  bool rotation_partly_held(int rotation) const { return held_axes_.count(rotation) > 0; }
  /// Projectors on what is held of a velocity: identity for a held node, zero for a free one.
  Mat3 held_directions(int node) const;
  Mat3 held_axes(int rotation) const;

  double mass(int node) const { return mass_[node]; }
  double inertia(int rotation) const { return inertia_[rotation]; }
  const std::vector<double>& masses() const { return mass_; }
  const std::vector<double>& inertias() const { return inertia_; }

  Configuration state;

 private:
  std::vector<Body> bodies_;
  std::vector<double> mass_;
  std::vector<double> inertia_;
  std::vector<int> rotation_of_;
  std::vector<int> node_of_rotation_;
  std::vector<std::uint8_t> held_;
  std::map<int, Mat3> held_directions_, held_axes_;
};

}  // namespace valsalva::structure
