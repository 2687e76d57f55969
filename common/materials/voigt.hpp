// Voigt order 11, 22, 33, 12, 23, 13 (plane: 11, 22, 12). Symmetric tensors enter stress-like: off-diagonal
// entries once. Contracting two stress-like vectors needs the weight 2 on the shears.
#pragma once

#include "materials/elastic_law.hpp"

namespace valsalva::materials {

inline constexpr std::array<std::array<int, 2>, 6> voigt_pair{
    {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};

inline Voigt6 voigt(const Mat3& m) {
  return (Voigt6() << m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(0, 2)).finished();
}

inline Mat3 tensor(const Voigt6& v) {
  return (Mat3() << v[0], v[3], v[5], v[3], v[1], v[4], v[5], v[4], v[2]).finished();
}

inline Eigen::Vector3d plane_voigt(const Eigen::Matrix2d& m) {
  return {m(0, 0), m(1, 1), m(0, 1)};
}

/// (A o B)_ijkl = (A_ik B_jl + A_il B_jk)/2 of symmetric A, made symmetric: A o A.
inline Tangent6 symmetric_square(const Mat3& a) {
  Tangent6 t;
  for (int m = 0; m < 6; ++m)
    for (int n = m; n < 6; ++n) {
      const auto [i, j] = voigt_pair[m];
      const auto [k, l] = voigt_pair[n];
      t(m, n) = t(n, m) = 0.5 * (a(i, k) * a(j, l) + a(i, l) * a(j, k));
    }
  return t;
}

}  // namespace valsalva::materials
