// A small network of beams, turns of its nodes, and the forces that answer: for the tests of beams.
#pragma once

#include <random>

#include "structure/beam.hpp"

namespace valsalva::structure {

using Rotations = std::vector<Eigen::Quaterniond>;

/// Three-dimensional, with crossings and sections that differ.
inline BeamMesh crossing() {
  BeamMesh mesh;
  mesh.reference = {{5, 0, 0}, {4.6, 1.1, 1}, {5, 0.2, 2}, {4.5, -1.2, 1.2}, {4.7, 1.2, 3}};
  mesh.elements = {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {2, 4}};
  mesh.width_mm = {0.2, 0.25, 0.3, 0.2, 0.25};
  mesh.depth_mm = {0.4, 0.3, 0.3, 0.5, 0.45};
  mesh.depth_axis = radial_directions(mesh.reference, mesh.elements);
  return mesh;
}

/// Turns whose rotation vectors are normally distributed.
inline Rotations turned(std::size_t count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, size);
  Rotations r;
  for (std::size_t a = 0; a < count; ++a) {
    const Vec3 v(normal(random), normal(random), normal(random));
    r.emplace_back(Eigen::AngleAxisd(v.norm(), v.normalized()));
  }
  return r;
}

inline Eigen::Quaterniond exponential(const Vec3& v) {
  return v.norm() > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(v.norm(), v.normalized()))
                      : Eigen::Quaterniond::Identity();
}

struct Response {
  double energy;
  Points force, moment;
};

inline Response respond(const BeamNetwork& beams, const Points& x, const Rotations& r,
                        const FibreHistory* history = nullptr) {
  Response out{0, Points(x.size(), Vec3::Zero()), Points(x.size(), Vec3::Zero())};
  out.energy = beams.add_forces(x, r, out.force, out.moment, 0, 0, history);
  return out;
}

}  // namespace valsalva::structure
