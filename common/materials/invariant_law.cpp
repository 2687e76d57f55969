#include "materials/invariant_law.hpp"

#include "materials/thickness_stretch.hpp"
#include "materials/voigt.hpp"

namespace valsalva::materials {
namespace {

struct PlaneInvariants : Invariants {
  ThicknessStretch c33;
  Eigen::Matrix2d cofactor;  // of C: d(det C)/dC
  double trace, det;
};

PlaneInvariants invariants_of(const Eigen::Matrix2d& c, const PlaneFibres& fibres) {
  PlaneInvariants v;
  v.det = c(0, 0) * c(1, 1) - c(0, 1) * c(1, 0);
  v.trace = c(0, 0) + c(1, 1);
  v.c33 = thickness_stretch(v.det);
  v.cofactor << c(1, 1), -c(0, 1), -c(1, 0), c(0, 0);
  v.i1 = v.trace + v.c33.value;
  v.i2 = v.det + v.trace * v.c33.value;
  for (int i = 0; i < fibres.count; ++i) v.i4[i] = fibres.direction[i].dot(c * fibres.direction[i]);
  return v;
}

Eigen::Matrix2d i1_gradient(const PlaneInvariants& v) {
  return Eigen::Matrix2d::Identity() + v.c33.first * v.cofactor;
}

Eigen::Matrix2d i2_gradient(const PlaneInvariants& v) {
  return (1 + v.trace * v.c33.first) * v.cofactor + v.c33.value * Eigen::Matrix2d::Identity();
}

bool uses_i2(const InvariantResponse& w) {
  return w.d2 != 0 || w.d22 != 0;
}

PlaneStress stress_of(const PlaneInvariants& v, const InvariantResponse& w,
                      const Eigen::Matrix2d& i1_gradient, const PlaneFibres& fibres) {
  PlaneStress s{w.energy, w.exponent, v.c33.value, 2 * w.d1 * i1_gradient};
  if (uses_i2(w)) s.stress += 2 * w.d2 * i2_gradient(v);
  for (int i = 0; i < fibres.count; ++i)
    s.stress += 2 * w.d4[i] * fibres.direction[i] * fibres.direction[i].transpose();
  return s;
}

}  // namespace

ElasticResponse InvariantLaw::respond(const Mat3& c, const Fibres& fibres, double factor,
                                      Derivatives wanted) const {
  Invariants v;
  v.i1 = c.trace();
  v.i2 = 0.5 * (v.i1 * v.i1 - c.squaredNorm());
  for (int i = 0; i < fibres.count; ++i) v.i4[i] = fibres.direction[i].dot(c * fibres.direction[i]);
  const InvariantResponse w = derivatives(v, fibres.count, factor);

  const Mat3 g2 = v.i1 * Mat3::Identity() - c;  // dI2/dC
  ElasticResponse r;
  r.energy = w.energy;
  r.exponent = w.exponent;
  r.stress = 2 * (w.d1 * Mat3::Identity() + w.d2 * g2);
  for (int i = 0; i < fibres.count; ++i)
    r.stress += 2 * w.d4[i] * fibres.direction[i] * fibres.direction[i].transpose();
  if (wanted == Derivatives::stress) return r;

  const Voigt6 one = voigt(Mat3::Identity());
  r.tangent = w.d11 * one * one.transpose();
  if (uses_i2(w)) {
    const Voigt6 g = voigt(g2);
    r.tangent +=
        w.d22 * g * g.transpose() + w.d2 * (one * one.transpose() - symmetric_square(Mat3::Identity()));
  }
  for (int i = 0; i < fibres.count; ++i) {
    const Voigt6 a = voigt(Mat3(fibres.direction[i] * fibres.direction[i].transpose()));
    r.tangent += w.d44[i] * a * a.transpose() + w.d14[i] * (one * a.transpose() + a * one.transpose());
  }
  r.tangent *= 4;
  return r;
}

PlaneStress InvariantLaw::plane_stress(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                       double factor) const {
  const PlaneInvariants v = invariants_of(c, fibres);
  return stress_of(v, derivatives(v, fibres.count, factor), i1_gradient(v), fibres);
}

PlaneStressLanes InvariantLaw::plane_stress_lanes(const PlaneLanes& at) const {
  const Lanes det = at.c11 * at.c22 - at.c12 * at.c12, trace = at.c11 + at.c22;
  const auto [c33, slope] = thickness_stretch_lanes(det);
  InvariantsOf<Lanes> v;
  v.i1 = trace + c33;
  v.i2 = det + trace * c33;
  for (int i = 0; i < at.families; ++i) {
    const auto& [a1, a2] = at.fibre[i];
    v.i4[i] = a1 * a1 * at.c11 + 2 * a1 * a2 * at.c12 + a2 * a2 * at.c22;
  }
  const InvariantResponseOf<Lanes> w = lane_derivatives(v, at.families, at.factor);
  // The cofactor of C is (c22, c11, -c12).
  const Lanes on_one = 2 * (w.d1 + w.d2 * c33), on_cofactor = 2 * (w.d1 * slope + w.d2 * (1 + trace * slope));
  PlaneStressLanes s{w.energy, w.exponent, on_one + on_cofactor * at.c22, on_one + on_cofactor * at.c11,
                     -on_cofactor * at.c12};
  for (int i = 0; i < at.families; ++i) {
    const auto& [a1, a2] = at.fibre[i];
    s.s11 += 2 * w.d4[i] * a1 * a1;
    s.s22 += 2 * w.d4[i] * a2 * a2;
    s.s12 += 2 * w.d4[i] * a1 * a2;
  }
  return s;
}

InvariantResponseOf<Lanes> InvariantLaw::lane_derivatives(const InvariantsOf<Lanes>& at, int families,
                                                          const Lanes& factor) const {
  InvariantResponseOf<Lanes> all;
  for (int l = 0; l < lane_count; ++l) {
    const InvariantResponse one =
        derivatives({at.i1[l], at.i2[l], {at.i4[0][l], at.i4[1][l]}}, families, factor[l]);
    all.energy[l] = one.energy;
    all.exponent[l] = one.exponent;
    all.d1[l] = one.d1;
    all.d2[l] = one.d2;
    for (int i = 0; i < families; ++i) all.d4[i][l] = one.d4[i];
  }
  return all;
}

PlaneTangent InvariantLaw::plane_tangent(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                         double factor) const {
  const PlaneInvariants v = invariants_of(c, fibres);
  const InvariantResponse w = derivatives(v, fibres.count, factor);
  const Eigen::Matrix2d gradient = i1_gradient(v);
  const Eigen::Vector3d g = plane_voigt(gradient);
  const Eigen::Vector3d k = plane_voigt(v.cofactor);
  const Eigen::Matrix3d det_hessian = plane_determinant_hessian();
  Eigen::Matrix3d d = w.d11 * g * g.transpose();
  d += w.d1 * (v.c33.second * k * k.transpose() + v.c33.first * det_hessian);
  if (uses_i2(w)) {
    const Eigen::Vector3d g2 = plane_voigt(i2_gradient(v));
    const Eigen::Vector3d one(1, 1, 0);
    d += w.d22 * g2 * g2.transpose() + w.d2 * ((1 + v.trace * v.c33.first) * det_hessian +
                                               v.c33.first * (one * k.transpose() + k * one.transpose()) +
                                               v.trace * v.c33.second * k * k.transpose());
  }
  for (int i = 0; i < fibres.count; ++i) {
    const Eigen::Vector3d a = plane_voigt(fibres.direction[i] * fibres.direction[i].transpose());
    d += w.d44[i] * a * a.transpose() + w.d14[i] * (g * a.transpose() + a * g.transpose());
  }
  return {stress_of(v, w, gradient, fibres), 4 * d};
}

}  // namespace valsalva::materials
