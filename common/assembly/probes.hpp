// What is measured of a scene: one column a probe, its name followed by its unit.
//
//   displacement, position  mm     mean (min, max) over a set of nodes; of beams also rotation, rad: the
//                                  rotation vector of the mean node's turn since the reference
//   velocity                mm/s
//   reaction                N      sum of the forces by which a support holds the body
//   reaction_moment         N_mm   the same of their moments about a point, moments on beam nodes included
//   contact_force           N      sum of the forces of a contact pair on its first body
//   of these forces and of displacement, position and velocity also the radial component: outwards from an
//   axis, node by node (displacement: the change of the distance from it)
//   contact_area            mm2    area of the nodes that touch a rigid surface
//   penetration             mm     largest overlap with a rigid surface, or of two bodies' contact distance
//   energies                nJ     kinetic: of all; stored: of all, or of one body, tie, tether or pair
//   momentum                g_mm_per_s, angular_momentum (about a point) g_mm2_per_s   of a body, or of all
//   stretch                 ratio  principal stretch (beams: 1 + largest strain): the largest of a body, or
//                                  that nearest to a point of the reference
//   von_mises, stress       kPa    Cauchy; likewise. Kirchhoff shells: at the bottom, the middle (the
//   membrane
//                                  stress) or the top, the bending stress (top - bottom)/2, or the largest of
//                                  the three; along the first fibre, or along a direction that was projected
//                                  on the reference shape and moves with it. Hinge shells: von Mises only
//   volume                  mm3    enclosed by a body's surface, or that of a volume load
//   pressure                kPa    of a volume load
#pragma once

#include <map>
#include <optional>
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
    std::string name, quantity, of, component, statistic, layer;
    Vec3 direction;
    std::optional<Vec3> point;
  };
  struct Present;
  /// From the axis of radial components: the distance as a vector, and its direction (zero on the axis).
  static Vec3 from_axis(const Vec3& x, const Probe& probe);
  static Vec3 outward(const Vec3& x, const Probe& probe);
  double value(const Probe& probe, const Scene& scene, Present& present, double kinetic_nJ) const;
  static void check(const Probe& probe, const Scene& built, const std::string& what);
  double of_nodes(const Probe& probe, const Scene& scene) const;
  double of_elements(const Probe& probe, const Scene& scene) const;
  double of_layers(const Probe& probe, const BuiltBody& body, const structure::Configuration& now) const;
  double of_solid(const Probe& probe, const BuiltBody& body, const structure::Configuration& now) const;
  double penetration(const Probe& probe, const Scene& scene) const;
  double of_support(const Probe& probe, const Scene& scene, Present& present) const;
  double of_motion(const Probe& probe, const Scene& scene) const;

  std::vector<Probe> probes_;
  std::vector<std::string> columns_;
  Points reference_;
};

/// Values of the elements, some numbers each.
struct CellField {
  std::vector<double> values;
  std::size_t components = 1;
};

/// Largest stretch and von Mises stress (Pa) of every element of a body at positions x of the system.
struct ElementField {
  std::vector<double> stretch, von_mises_Pa;
  double exponent =
      0;  ///< the largest Q of the law's exp(Q): beyond 6 it is continued by its Taylor polynomial
  /// Kirchhoff shells: stress_<layer>_kPa (xx yy zz xy yz xz), principal_max_, principal_min_, von_mises_
  /// and, with fibres, fibre_stress_<layer>_kPa, layer = bottom, middle, top.
  std::map<std::string, CellField> layers;
};
ElementField element_field(const BuiltBody& body, const structure::Configuration& now);

}  // namespace valsalva::assembly
