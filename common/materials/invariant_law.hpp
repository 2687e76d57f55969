// Laws W(I1, I2, I4_1, I4_2): a new one is a file pair that fills an InvariantResponse, nothing else. The
// assembly of stress and tangent, in space and in the plane, is here.
//   I1 = tr C,  I2 = ((tr C)^2 - tr C^2)/2,  I4_i = a_i . C a_i.
//   S = 2 [(W1 + I1 W2) 1 - W2 C + sum_i W4i a_i a_i]
// In the incompressible plane C33 = 1/det C: I1 = tr C + 1/det C, I2 = det C + tr C/det C (plane_stress.hpp).
// Laws that couple I2 with another invariant or the two fibre families with each other are not covered.
#pragma once

#include "materials/elastic_law.hpp"
#include "materials/lanes.hpp"

namespace valsalva::materials {

template <class T>  // lanes.hpp
struct InvariantsOf {
  T i1 = constant<T>(3), i2 = constant<T>(3);
  std::array<T, 2> i4{constant<T>(1), constant<T>(1)};  ///< 1 for an absent family
};

template <class T>
struct InvariantResponseOf {
  T energy = constant<T>(0);                             ///< W, Pa
  T d1 = constant<T>(0);                                 ///< dW/dI1
  T d11 = constant<T>(0);                                ///< d2W/dI1^2
  T d2 = constant<T>(0);                                 ///< dW/dI2
  T d22 = constant<T>(0);                                ///< d2W/dI2^2
  std::array<T, 2> d4{constant<T>(0), constant<T>(0)};   ///< dW/dI4_i
  std::array<T, 2> d44{constant<T>(0), constant<T>(0)};  ///< d2W/dI4_i^2
  std::array<T, 2> d14{constant<T>(0), constant<T>(0)};  ///< d2W/(dI1 dI4_i), for laws with dispersion
  T exponent = constant<T>(0);  ///< the largest argument of an exponential, 0 for laws without one
};

using Invariants = InvariantsOf<double>;
using InvariantResponse = InvariantResponseOf<double>;

class InvariantLaw : public ElasticLaw {
 public:
  /// `families` is how many fibre families the body has; the others' I4 is 1.
  virtual InvariantResponse derivatives(const Invariants& invariants, int families, double factor) const = 0;
  /// The same of eight elements, one after the other and without second derivatives where a law has nothing
  /// faster.
  virtual InvariantResponseOf<Lanes> lane_derivatives(const InvariantsOf<Lanes>& invariants, int families,
                                                      const Lanes& factor) const;

  ElasticResponse respond(const Mat3& c, const Fibres& fibres, double factor, Derivatives wanted) const final;
  PlaneStress plane_stress(const Eigen::Matrix2d& c, const PlaneFibres& fibres, double factor) const final;
  PlaneTangent plane_tangent(const Eigen::Matrix2d& c, const PlaneFibres& fibres, double factor) const final;
  PlaneStressLanes plane_stress_lanes(const PlaneLanes& at) const final;
};

}  // namespace valsalva::materials
