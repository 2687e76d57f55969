// What is measured of a scene: one column a probe, its name followed by its unit.
//
//   displacement, position  mm     mean (min, max) over a set of nodes; of beams also rotation, rad: the
//                                  rotation vector of the mean node's turn since the reference
//   velocity                mm/s
//   reaction                N      sum of the forces by which a support holds the body
//   contact_force           N      sum of the forces of a contact pair on its first body
//   energies                nJ     kinetic: of all; stored: of all, or of one body, tie, tether or pair
//   stretch                 1      largest principal stretch of a body (beams: 1 + largest strain)
//   von_mises               kPa    largest von Mises stress of a body (Cauchy)
#pragma once

#include <string>
#include <vector>

#include "assembly/scene.hpp"

namespace valsalva::assembly {

class Probes {
 public:
  /// InputError that names the probe.
  Probes(const Case& scene, const Scene& built);
  const std::vector<std::string>& columns() const { return columns_; }
  /// At the system's present state.
  std::vector<double> values(const Scene& scene, double kinetic_nJ) const;

 private:
  struct Probe {
    std::string name, quantity, of, component, statistic;
    Vec3 direction;
  };
  struct Present;
  double value(const Probe& probe, const Scene& scene, Present& present, double kinetic_nJ) const;
  double of_vectors(const Probe& probe, const Points& vectors) const;

  std::vector<Probe> probes_;
  std::vector<std::string> columns_;
  Points reference_;
};

/// Largest stretch and von Mises stress (Pa) of every element of a body at positions x of the system.
struct ElementField {
  std::vector<double> stretch, von_mises_Pa;
};
ElementField element_field(const BuiltBody& body, const structure::Configuration& now);

}  // namespace valsalva::assembly
