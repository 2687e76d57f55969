// The middle surface and the curvatures of one Kirchhoff-Love triangle, from its jet (kirchhoff_shell.hpp).
// Of use to kirchhoff_shell.cpp and kirchhoff_tangent.cpp only.
#pragma once

#include "structure/kirchhoff_shell.hpp"

namespace valsalva::structure {

struct Surface {
  Vec3 a1, a2, n, dual1, dual2;
  Eigen::Matrix2d metric, inverse;

  explicit Surface(const Eigen::Ref<const Eigen::Matrix3Xd>& jet) : a1(jet.col(0)), a2(jet.col(1)) {
    n = a1.cross(a2);
    n /= std::max(n.norm(), 1e-300);
    metric << a1.dot(a1), a1.dot(a2), a1.dot(a2), a2.dot(a2);
    const double det = std::max(metric(0, 0) * metric(1, 1) - metric(0, 1) * metric(0, 1), 1e-300);
    inverse << metric(1, 1) / det, -metric(0, 1) / det, -metric(0, 1) / det, metric(0, 0) / det;
    dual1 = inverse(0, 0) * a1 + inverse(0, 1) * a2;
    dual2 = inverse(1, 0) * a1 + inverse(1, 1) * a2;
  }
};

struct KirchhoffShell::Bending {
  Eigen::Vector3d mean;                      // k: 11, 22, 12
  std::array<Eigen::Vector3d, 3> variation;  // k_e - k, less that of the reference

  Bending(const Element& e, const Jet& jet, const Vec3& n) : mean(Eigen::Vector3d::Zero()) {
    const Eigen::Matrix<double, ShellEdges::vectors, 3> b =
        (n.transpose() * jet.rightCols<jets - 2>()).reshaped(int(ShellEdges::vectors), 3);
    for (int k = 0; k < 3; ++k) mean += b(0, k) * e.bends.col(k);
    for (int k = 0; k < 3; ++k)
      variation[k] = turned(e.samples[k]) * b.col(k).tail<3>() - mean - e.samples[k].rest;
  }
  Eigen::Matrix2d curvature() const {
    return (Eigen::Matrix2d() << mean[0], mean[2], mean[2], mean[1]).finished();
  }
  // Components 11, 22, 12 of a tensor from its components ss, sy, yy at an edge; across = (along2, -along1).
  static Eigen::Matrix3d turned(const EdgeSample& s) {
    const double c = s.along[0], d = s.along[1];
    return (Eigen::Matrix3d() << c * c, 2 * c * d, d * d,  //
            d * d, -2 * c * d, c * c,                      //
            c * d, d * d - c * c, -c * d)
        .finished();
  }
  // The energy's derivative by n . (d, x,ss, x,sy, x,yy) of every edge; adds the energy of the variation.
  Eigen::Matrix<double, jets - 2, 1> pull(const Element& e, const Eigen::Matrix2d& moment,
                                          double* energy) const {
    Eigen::Matrix<double, jets - 2, 1> out;
    Eigen::Vector3d whole = e.area * Eigen::Vector3d(moment(0, 0), moment(1, 1), 2 * moment(0, 1));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d twice(variation[k][0], variation[k][1], 2 * variation[k][2]);
      Eigen::Vector3d p = e.sampled[k] * e.rigidity * twice;
      p[2] *= 2;
      if (energy) *energy += 0.5 * p.dot(variation[k]);
      whole -= p;
      out.segment<3>(ShellEdges::vectors * k + 1) = turned(e.samples[k]).transpose() * p;
    }
    for (int k = 0; k < 3; ++k) out[ShellEdges::vectors * k] = whole.dot(e.bends.col(k));
    return out;
  }
};

}  // namespace valsalva::structure
