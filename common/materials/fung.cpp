#include "materials/fung.hpp"

#include "materials/capped_exponential.hpp"
#include "materials/checks.hpp"
#include "materials/voigt.hpp"

namespace valsalva::materials {
namespace {

// Second derivative of |E a|^2 with respect to E: (1_ik A_jl + 1_il A_jk + A_ik 1_jl + A_il 1_jk)/2, A = a a.
Tangent6 squared_row_hessian(const Mat3& a) {
  Tangent6 t;
  const Mat3 one = Mat3::Identity();
  for (int m = 0; m < 6; ++m)
    for (int n = 0; n < 6; ++n) {
      const auto [i, j] = voigt_pair[m];
      const auto [k, l] = voigt_pair[n];
      t(m, n) = 0.5 * (one(i, k) * a(j, l) + one(i, l) * a(j, k) + a(i, k) * one(j, l) + a(i, l) * one(j, k));
    }
  return t;
}

}  // namespace

Fung::Fung(const FungParameters& parameters) : p_(parameters) {
  require_positive("fung", "Ch (Pa)", p_.ch_Pa);
  require_positive("fung", "b1", p_.b1);
  require_positive("fung", "b2", p_.b2);
  require_positive("fung", "b3", p_.b3);
}

ElasticResponse Fung::respond(const Mat3& c, const Fibres& fibres, double factor, Derivatives wanted) const {
  if (fibres.count < 1)
    throw InputError(
        "material fung: the body has no fibre direction; expected one, along which E11 is taken");
  const Vec3& a = fibres.direction[0];
  const Mat3 strain = 0.5 * (c - Mat3::Identity());
  const Vec3 row = strain * a;
  const double e = a.dot(row), row2 = row.squaredNorm();
  const Mat3 along = a * a.transpose(), m = row * a.transpose() + a * row.transpose();

  const double on_e2 = p_.b1 + p_.b2 - 2 * p_.b3, on_row2 = 2 * (p_.b3 - p_.b2);
  const double q = on_e2 * e * e + on_row2 * row2 + p_.b2 * strain.squaredNorm();
  const Mat3 dq = 2 * on_e2 * e * along + on_row2 * m + 2 * p_.b2 * strain;
  const CappedExponential x = capped_exponential<double>(q);
  const double half = 0.5 * factor * p_.ch_Pa;

  ElasticResponse r;
  r.energy = half * (x.value - 1);
  r.stress = half * x.first * dq;
  r.exponent = q;
  if (wanted == Derivatives::stress) return r;
  const Voigt6 g = voigt(dq), v = voigt(along);
  const Tangent6 hessian = 2 * on_e2 * v * v.transpose() + on_row2 * squared_row_hessian(along) +
                           2 * p_.b2 * symmetric_square(Mat3::Identity());
  r.tangent = half * (x.second * g * g.transpose() + x.first * hessian);
  return r;
}

}  // namespace valsalva::materials
