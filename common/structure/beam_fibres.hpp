// A beam's rectangular section as fibres of a superelastic law, at several stations along the element.
//
// Strain of the fibre at (y, z) of the section and s in [0, 1] of the element (cubic deflection, constant
// axial strain, the measures of beam.hpp):
//   eps = u/L - y kz + z ky,  k = [(6 s - 4) theta_a + (6 s - 2) theta_b]/L,
// forces from virtual work, dU = N du + M . dtheta = sum_s w_s L integral sigma d eps dA. Gauss points along
// the element and along both sides of the section, so that a linear law gives the linear beam exactly (from
// two points on). Torsion stays linear, and shear flexibility is not offered. Stress-strain curves with kinks
// converge with the square of the number of points (docs/verification/superelastic.md).
// mm, Pa, uN, uN mm, nJ.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "materials/superelastic.hpp"

namespace valsalva::structure {

/// Gauss points: over the section's width and depth, and stations along the element; 1 to 20 each.
struct FibreGrid {
  int width = 5;
  int depth = 5;
  int stations = 2;
  int per_element() const { return width * depth * stations; }
};

/// Stretch u, theta_z at a and b, theta_y at a and b, twist; or what is conjugate to them: normal force, end
/// moments, torque.
using BeamMeasures = Eigen::Matrix<double, 6, 1>;
using BeamStiffness = Eigen::Matrix<double, 6, 6>;

/// What all fibres of a network remember, element by element, and the energy that they have dissipated.
struct FibreHistory {
  std::vector<materials::SuperelasticState> fibre;
  double dissipated_nJ = 0;
};

class FibreSection {
 public:
  /// InputError for a grid out of range.
  FibreSection(const materials::Superelastic& law, const FibreGrid& grid);
  const materials::Superelastic& law() const { return law_; }
  const FibreGrid& grid() const { return grid_; }

  struct Shape {
    double length_mm, width_mm, depth_mm;
  };
  struct Response {
    BeamMeasures force = BeamMeasures::Zero();
    BeamStiffness stiffness = BeamStiffness::Zero();  ///< zero when not asked for
    double stored_nJ = 0, dissipated_nJ = 0;
  };
  /// `from`: the element's fibres (per_element of them); `to`, unless null, takes their states at q.
  Response respond(const Shape& shape, const BeamMeasures& q, const materials::SuperelasticState* from,
                   materials::SuperelasticState* to, bool with_stiffness) const;

 private:
  struct Points {
    std::vector<double> at, weight;  // on [-1, 1]; weights sum to 2
  };
  static Points gauss(int count);
  materials::Superelastic law_;
  FibreGrid grid_;
  Points width_, depth_, along_;
};

}  // namespace valsalva::structure
