// What a shell asks of a law: the plane-stress response to the in-plane 2x2 C. Incompressible laws
// (ElasticLaw) take C33 = 1/det C, compressible ones (SolidLaw) find C33 by a local Newton iteration.
// Voigt order 11, 22, 12 with engineering shear 2 E12. Pa.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "materials/lanes.hpp"

namespace valsalva::materials {

/// Unit fibre directions in the element's basis; count 0 to 2.
struct PlaneFibres {
  int count = 0;
  std::array<Eigen::Vector2d, 2> direction{Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)};
};

struct PlaneStress {
  double energy = 0;       ///< W per reference volume, Pa
  double exponent = 0;     ///< the largest argument of an exponential
  double c33 = 1;          ///< square of the thickness stretch
  Eigen::Matrix2d stress;  ///< second Piola-Kirchhoff, Pa
};

struct PlaneTangent {
  PlaneStress at;
  Eigen::Matrix3d tangent;  ///< dS/dE
};

/// Eight elements of one body side by side.
struct PlaneLanes {
  Lanes c11, c22, c12;
  Lanes factor;
  int families = 0;                             ///< as PlaneFibres::count
  std::array<std::array<Lanes, 2>, 2> fibre{};  ///< components of each direction
};

struct PlaneStressLanes {
  Lanes energy, exponent;
  Lanes s11, s22, s12;
};

class PlaneLaw {
 public:
  virtual ~PlaneLaw() = default;
  virtual std::string name() const = 0;
  virtual PlaneStress plane_stress(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                   double factor) const = 0;
  /// Of eight elements: one after the other where a law has nothing faster.
  virtual PlaneStressLanes plane_stress_lanes(const PlaneLanes& at) const;
  virtual PlaneTangent plane_tangent(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                     double factor) const = 0;
};

}  // namespace valsalva::materials
