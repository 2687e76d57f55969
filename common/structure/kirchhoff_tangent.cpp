// The Kirchhoff-Love shell's tangents, stiffness bound and states.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "structure/kirchhoff_element.hpp"
#include "structure/threads.hpp"

namespace valsalva::structure {

KirchhoffShell::Hessian KirchhoffShell::hessian(const Element& e, const Jet& j, bool positive) const {
  constexpr int vectors = ShellEdges::vectors;
  const Surface s(j);
  const Bending bending(e, j, s.n);
  const SectionResponse section = section_->respond(e.section, s.metric, bending.curvature(), true);
  Section6 tangent = section.tangent;
  Eigen::Matrix2d force = section.force;
  if (positive) {
    const Eigen::LDLT<Section6> factors(tangent);
    if (factors.vectorD().minCoeff() < 0) {
      const Eigen::SelfAdjointEigenSolver<Section6> eigen(tangent);
      tangent = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                eigen.eigenvectors().transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(force);
    force = (eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
             eigen.eigenvectors().transpose())
                .eval();
  }
  // Curvatures by n . v of the edges' vectors v: k, then k_e - k of each edge (11, 22, 2 12).
  Eigen::Matrix<double, 12, jets - 2> by_vectors = Eigen::Matrix<double, 12, jets - 2>::Zero();
  for (int k = 0; k < 3; ++k) {
    for (int q = 0; q < 4; ++q) by_vectors.block<3, 1>(3 * q, vectors * k) = (q ? -1 : 1) * e.bends.col(k);
    by_vectors.block<3, 3>(3 + 3 * k, vectors * k + 1) = Bending::turned(e.samples[k]);
  }
  for (int q = 0; q < 4; ++q) by_vectors.row(3 * q + 2) *= 2;
  // n . v changes by n . (dv - (dual_c . v) da_c).
  Eigen::Matrix<double, jets, jets - 2> by_jet;
  by_jet << -s.dual1.transpose() * j.rightCols<jets - 2>(), -s.dual2.transpose() * j.rightCols<jets - 2>(),
      Eigen::Matrix<double, jets - 2, jets - 2>::Identity();
  const Eigen::Matrix<double, 12, jets> curved = by_vectors * by_jet.transpose();
  Eigen::Matrix<double, 3, 6> strain;  // 11, 22, 2 12 by a1, a2
  strain << s.a1.transpose(), Eigen::RowVector3d::Zero(), Eigen::RowVector3d::Zero(), s.a2.transpose(),
      s.a2.transpose(), s.a1.transpose();
  // Curvatures act along n only: a matrix of the jet's vectors times n n^T.
  Eigen::Matrix<double, 12, jets> stressed;
  stressed.topRows<3>() = e.area * tangent.bottomRightCorner<3, 3>() * curved.topRows<3>();
  for (int k = 0; k < 3; ++k)
    stressed.middleRows<3>(3 + 3 * k) = e.sampled[k] * e.rigidity * curved.middleRows<3>(3 + 3 * k);
  Eigen::Matrix<double, jets, jets> along_normal = curved.transpose() * stressed;
  Eigen::Vector2d turned(0, 0);  // the curvatures' pull times dual_c . v
  Eigen::Matrix<double, jets - 2, 1> pull;
  if (!positive) {
    pull = bending.pull(e, section.moment, nullptr);
    const Vec3 bent = j.rightCols<jets - 2>() * pull;
    turned = {s.dual1.dot(bent), s.dual2.dot(bent)};
    along_normal.topLeftCorner<2, 2>() -= s.n.dot(bent) * s.inverse;
  }
  Hessian h;
  const Mat3 outer = s.n * s.n.transpose();
  for (int a = 0; a < jets; ++a)
    for (int b = 0; b < jets; ++b) h.block<3, 3>(3 * a, 3 * b) = along_normal(a, b) * outer;
  h.topLeftCorner<6, 6>() += e.area * strain.transpose() * tangent.topLeftCorner<3, 3>() * strain;
  const Eigen::Matrix<double, 6, jets> mixed =
      e.area * strain.transpose() * tangent.topRightCorner<3, 3>() * curved.topRows<3>();
  for (int b = 0; b < jets; ++b) {
    const Eigen::Matrix<double, 6, 3> block = mixed.col(b) * s.n.transpose();
    h.block<6, 3>(0, 3 * b) += block;
    h.block<3, 6>(3 * b, 0) += block.transpose();
  }
  for (int c = 0; c < 2; ++c)
    for (int d = 0; d < 2; ++d) h.block<3, 3>(3 * c, 3 * d).diagonal().array() += e.area * force(c, d);
  if (positive) return h;
  const std::array<Vec3, 2> dual{s.dual1, s.dual2};
  for (int c = 0; c < 2; ++c) {
    for (int d = 0; d < 2; ++d)
      h.block<3, 3>(3 * c, 3 * d) +=
          turned[c] * dual[d] * s.n.transpose() + turned[d] * s.n * dual[c].transpose();
    const Mat3 leaning = s.n * dual[c].transpose();
    for (int v = 0; v < jets - 2; ++v) {
      h.block<3, 3>(3 * c, 6 + 3 * v) -= pull[v] * leaning;
      h.block<3, 3>(6 + 3 * v, 3 * c) -= pull[v] * leaning.transpose();
    }
  }
  return h;
}

void KirchhoffShell::element_tangent(const Points& vertices, int i, bool positive,
                                     BlockMatrix::Piece& out) const {
  const Element& e = elements_[i];
  Eigen::MatrixXd h = hessian(e, jet(vertices, i), positive);
  for (int k = 0; k < 3; ++k) edges_.project(e.edges[k], 6 + 3 * ShellEdges::vectors * k, h);
  Eigen::MatrixXd weights;
  edges_.reach(i, out.slots, weights);
  const int count = static_cast<int>(out.slots.size());
  // The jet's vectors by the nodes.
  Eigen::Matrix<double, jets, Eigen::Dynamic> by_node =
      Eigen::Matrix<double, jets, Eigen::Dynamic>::Zero(jets, count);
  by_node.topLeftCorner<2, 3>() = e.gradients;
  by_node.bottomRows<jets - 2>() = weights;
  out.k.resize(3 * count, 3 * count);
  using Component = Eigen::Map<const Eigen::Matrix<double, jets, jets>, 0, Eigen::Stride<9 * jets, 3>>;
  Eigen::Matrix<double, jets, Eigen::Dynamic> half(jets, count);
  for (int p = 0; p < 3; ++p)
    for (int q = p; q < 3; ++q) {
      half.noalias() = Component(&h(p, q)).lazyProduct(by_node);
      for (int b = 0; b < count; ++b)
        for (int a = 0; a < count; ++a) {
          const double k = by_node.col(a).dot(half.col(b));
          out.k(3 * a + p, 3 * b + q) = k;
          out.k(3 * b + q, 3 * a + p) = k;
        }
    }
}

void KirchhoffShell::add_tangents(const Points& vertices, bool positive, BlockMatrix& out, int offset) const {
  constexpr int batch = 256;  // bounds the memory; the sums keep the order of the elements
  std::vector<BlockMatrix::Piece> pieces(batch);
  for (int first = 0; first < elements(); first += batch) {
    const int count = std::min(batch, elements() - first);
    for_all(count, "", first, [&](int i) {
      element_tangent(vertices, first + i, positive, pieces[i]);
      for (int& a : pieces[i].slots) a += offset;
    });
    out.add(std::span(pieces).first(count));
  }
}

void KirchhoffShell::add_tangent(const Points& x, BlockMatrix& out, int offset,
                                 std::span<const Mat3> clamps) const {
  Points vertices;
  edges_.gather(x, offset, vertices, clamps);
  add_tangents(vertices, false, out, offset);
}

void KirchhoffShell::add_positive_tangent(const Points& x, BlockMatrix& out, int offset) const {
  Points vertices;
  edges_.gather(x, offset, vertices);
  add_tangents(vertices, true, out, offset);
}

void KirchhoffShell::add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset) const {
  Points vertices;
  edges_.gather(x, offset, vertices);
  BlockMatrix::Piece own;
  for (int i = 0; i < elements(); ++i) {
    element_tangent(vertices, i, true, own);
    const Eigen::VectorXd rows = own.k.cwiseAbs().rowwise().sum();
    for (std::size_t a = 0; a < own.slots.size(); ++a)
      bound[offset + own.slots[a]] += rows.segment<3>(3 * a).maxCoeff();
  }
}

LayerState KirchhoffShell::layer_state(const Element& e, const Jet& j, double height) const {
  const Surface surface(j);
  const SectionStress s =
      section_->stress(e.section, surface.metric, Bending(e, j, surface.n).curvature(), height);
  // Cauchy = F S F^T with F = R U, R the middle surface's rotation.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> stretch(s.c), middle(surface.metric);
  const Eigen::Matrix2d root = stretch.operatorSqrt();
  const Eigen::Matrix2d cauchy = root * s.stress * root;
  const Eigen::Matrix<double, 3, 2> turn = j.leftCols<2>() * middle.operatorInverseSqrt();
  const double a = cauchy(0, 0), b = cauchy(1, 1), shear = cauchy(0, 1);
  LayerState out;
  out.von_mises_Pa = std::sqrt(std::max(0.0, a * a - a * b + b * b + 3 * shear * shear));
  out.stretch_major = std::sqrt(std::max(0.0, stretch.eigenvalues()[1]));
  out.stretch_minor = std::sqrt(std::max(0.0, stretch.eigenvalues()[0]));
  out.exponent = s.exponent;
  out.cauchy_Pa = turn * cauchy * turn.transpose();
  return out;
}

std::vector<LayerStates> KirchhoffShell::layer_states(const Points& x, int offset) const {
  Points vertices;
  edges_.gather(x, offset, vertices);
  std::vector<LayerStates> all;
  for (int i = 0; i < elements(); ++i) {
    const Element& e = elements_[i];
    const Jet j = jet(vertices, i);
    const auto [a, b, c] = mesh_.triangles[i];
    const Vec3 e1 = (mesh_.reference[b] - mesh_.reference[a]).normalized();
    const Vec3 e2 = e1.cross(mesh_.reference[c] - mesh_.reference[a]).normalized().cross(e1);
    all.push_back({layer_state(e, j, -0.5), layer_state(e, j, 0), layer_state(e, j, 0.5),
                   j.col(0) * e1.transpose() + j.col(1) * e2.transpose()});
  }
  return all;
}

Eigen::Matrix2d KirchhoffShell::bending_strain(const Points& x, int element, int offset) const {
  Points vertices;
  edges_.gather(x, offset, vertices);
  const Element& e = elements_[element];
  const Jet j = jet(vertices, element);
  return Bending(e, j, Surface(j).n).curvature() - e.section.curvature;
}

double KirchhoffShell::max_exponent(const Points& x, int offset) const {
  Points vertices;
  edges_.gather(x, offset, vertices);
  double largest = 0;
  for (int i = 0; i < elements(); ++i) {
    const Element& e = elements_[i];
    const Jet j = jet(vertices, i);
    const Surface s(j);
    const Eigen::Matrix2d k = Bending(e, j, s.n).curvature();
    largest = std::max(largest, section_->respond(e.section, s.metric, k, false).exponent);
  }
  return largest;
}

}  // namespace valsalva::structure
