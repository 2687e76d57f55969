#include "materials/plane_stress.hpp"

#include <algorithm>

namespace valsalva::materials {
namespace {

constexpr double determinant_floor = 1e-4;

// C33 = 1/det C with its first two derivatives, continued by its tangent below the floor.
struct ThicknessStretch {
  double value, first, second;
};

ThicknessStretch thickness_stretch(double det) {
  constexpr double f = determinant_floor;
  if (det < f) return {2 / f - det / (f * f), -1 / (f * f), 0};
  return {1 / det, -1 / (det * det), 2 / (det * det * det)};
}

struct Invariants {
  ThicknessStretch c33;
  Eigen::Matrix2d cofactor;  // of C: d(det C)/dC
  double i1;
  std::array<double, 2> i4{1, 1};
};

Invariants invariants_of(const Eigen::Matrix2d& c, const PlaneFibres& fibres) {
  Invariants v;
  v.c33 = thickness_stretch(c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0));
  v.cofactor << c(1, 1), -c(0, 1), -c(1, 0), c(0, 0);
  v.i1 = c(0, 0) + c(1, 1) + v.c33.value;
  for (int i = 0; i < fibres.count; ++i) v.i4[i] = fibres.direction[i].dot(c * fibres.direction[i]);
  return v;
}

Eigen::Matrix2d i1_gradient(const Invariants& v) {
  return Eigen::Matrix2d::Identity() + v.c33.first * v.cofactor;
}

PlaneStress stress_from(const InvariantResponse& w, const Eigen::Matrix2d& gradient,
                        const PlaneFibres& fibres) {
  PlaneStress s{w.energy, 2 * w.d1 * gradient, w.exponent};
  for (int i = 0; i < fibres.count; ++i)
    s.stress += 2 * w.d4[i] * fibres.direction[i] * fibres.direction[i].transpose();
  return s;
}

Eigen::Vector3d voigt(const Eigen::Matrix2d& m) {
  return {m(0, 0), m(1, 1), m(0, 1)};
}

}  // namespace

PlaneStress plane_stress(const InvariantLaw& law, const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                         double factor) {
  const Invariants v = invariants_of(c, fibres);
  return stress_from(law.respond(v.i1, v.i4, factor), i1_gradient(v), fibres);
}

PlaneTangent plane_tangent(const InvariantLaw& law, const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                           double factor) {
  const Invariants v = invariants_of(c, fibres);
  const InvariantResponse w = law.respond(v.i1, v.i4, factor);
  const Eigen::Matrix2d gradient = i1_gradient(v);
  const Eigen::Vector3d g = voigt(gradient);
  Eigen::Matrix3d d = w.d11 * g * g.transpose();
  const Eigen::Vector3d k = voigt(v.cofactor);
  Eigen::Matrix3d cofactor_gradient;  // of det C = C11 C22 - C12 C21
  cofactor_gradient << 0, 1, 0, 1, 0, 0, 0, 0, -0.5;
  d += w.d1 * (v.c33.second * k * k.transpose() + v.c33.first * cofactor_gradient);
  for (int i = 0; i < fibres.count; ++i) {
    const Eigen::Vector3d a = voigt(fibres.direction[i] * fibres.direction[i].transpose());
    d += w.d44[i] * a * a.transpose() + w.d14[i] * (g * a.transpose() + a * g.transpose());
  }
  return {stress_from(w, gradient, fibres), 4 * d};
}

}  // namespace valsalva::materials
