// The Kirchhoff-Love shell's tangents, stiffness bound and states.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "structure/kirchhoff_shell.hpp"

namespace valsalva::structure {

KirchhoffShell::ElementMatrix KirchhoffShell::element_tangent(const Points& vertices, const Element& e,
                                                              bool positive) const {
  const Hessian h = hessian(e, jet(vertices, e), positive);
  Eigen::Matrix<double, 15, 18> pulled;
  for (int k = 0; k < 3; ++k) {
    pulled.middleCols<3>(3 * k) =
        e.gradients(0, k) * h.middleCols<3>(0) + e.gradients(1, k) * h.middleCols<3>(3);
    pulled.middleCols<3>(9 + 3 * k) = e.bends(0, k) * h.middleCols<3>(6) +
                                      e.bends(1, k) * h.middleCols<3>(9) +
                                      e.bends(2, k) * h.middleCols<3>(12);
  }
  ElementMatrix matrix;
  for (int k = 0; k < 3; ++k) {
    matrix.middleRows<3>(3 * k) =
        e.gradients(0, k) * pulled.middleRows<3>(0) + e.gradients(1, k) * pulled.middleRows<3>(3);
    matrix.middleRows<3>(9 + 3 * k) = e.bends(0, k) * pulled.middleRows<3>(6) +
                                      e.bends(1, k) * pulled.middleRows<3>(9) +
                                      e.bends(2, k) * pulled.middleRows<3>(12);
  }
  return matrix;
}

void KirchhoffShell::add_tangent(const Points& x, BlockMatrix& out, int offset,
                                 std::span<const Mat3> clamps) const {
  Points vertices;
  edges_.gather(x, offset, vertices, clamps);
  constexpr int batch = 256;  // bounds the memory; the sums keep the order of the elements
  std::vector<ElementMatrix> k(batch);
  for (int first = 0; first < elements(); first += batch) {
    const int count = std::min(batch, elements() - first);
    for_all(count, "", first, [&](int i) { k[i] = element_tangent(vertices, elements_[first + i], false); });
    for (int i = 0; i < count; ++i) edges_.add_matrix(elements_[first + i].vertices, k[i], out, offset);
  }
}

KirchhoffShell::Jet KirchhoffShell::jet_of(const Points& x, int element, int offset) const {
  Points vertices;
  edges_.gather(x, offset, vertices);
  return jet(vertices, elements_[element]);
}

ElementState KirchhoffShell::layer_state(const Element& e, const Jet& j, double height) const {
  const Vec3 a1 = j.col(0), a2 = j.col(1), n = a1.cross(a2).normalized();
  Eigen::Matrix2d metric, curvature;
  metric << a1.dot(a1), a1.dot(a2), a1.dot(a2), a2.dot(a2);
  curvature << n.dot(j.col(2)), n.dot(j.col(4)), n.dot(j.col(4)), n.dot(j.col(3));
  const SectionStress s = section_->stress(e.section, metric, curvature, height);
  // Incompressible: J = 1, Cauchy = F S F^T, which has the in-plane invariants of C^1/2 S C^1/2.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> stretch(s.c);
  const Eigen::Matrix2d root = stretch.operatorSqrt();
  const Eigen::Matrix2d cauchy = root * s.stress * root;
  const double a = cauchy(0, 0), b = cauchy(1, 1), shear = cauchy(0, 1);
  return {std::sqrt(std::max(0.0, a * a - a * b + b * b + 3 * shear * shear)),
          std::sqrt(std::max(0.0, stretch.eigenvalues()[1])),
          std::sqrt(std::max(0.0, stretch.eigenvalues()[0])), s.exponent};
}

LayerStates KirchhoffShell::layer_states(const Points& x, int element, int offset) const {
  const Element& e = elements_[element];
  const Jet j = jet_of(x, element, offset);
  return {layer_state(e, j, -0.5), layer_state(e, j, 0), layer_state(e, j, 0.5)};
}

ElementState KirchhoffShell::element_state(const Points& x, int element, int offset) const {
  return layer_states(x, element, offset).middle;
}

Eigen::Matrix2d KirchhoffShell::bending_strain(const Points& x, int element, int offset) const {
  const Jet j = jet_of(x, element, offset);
  const Vec3 n = Vec3(j.col(0)).cross(Vec3(j.col(1))).normalized();
  Eigen::Matrix2d k;
  k << n.dot(j.col(2)), n.dot(j.col(4)), n.dot(j.col(4)), n.dot(j.col(3));
  return k - elements_[element].section.curvature;
}

double KirchhoffShell::max_exponent(const Points& x, int offset) const {
  Points vertices;
  edges_.gather(x, offset, vertices);
  double largest = 0;
  for (const Element& e : elements_)
    largest = std::max(largest, respond(e, jet(vertices, e), false).exponent);
  return largest;
}

void KirchhoffShell::add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset) const {
  KirchhoffTangent tangent(*this);
  tangent.update(x, offset);
  tangent.add_row_sums(bound, offset);
}

void KirchhoffShell::add_tangent_product(const Points& x, const Points& direction, Points& out) const {
  KirchhoffTangent tangent(*this);
  tangent.update(x);
  tangent.apply(direction, out);
}

KirchhoffTangent::KirchhoffTangent(const KirchhoffShell& shell, Part part) : shell_(shell) {
  const auto at = [&](int index) {
    return static_cast<int>(static_cast<long>(shell.elements()) * index / part.count);
  };
  begin_ = at(part.index);
  end_ = at(part.index + 1);
  element_.resize(end_ - begin_);
}

void KirchhoffTangent::update(const Points& x, int offset) {
  Points vertices;
  shell_.edges_.gather(x, offset, vertices);
#pragma omp parallel for schedule(static) if (end_ - begin_ > 500)
  for (int i = begin_; i < end_; ++i)
    element_[i - begin_] = shell_.element_tangent(vertices, shell_.elements_[i], true);
}

void KirchhoffTangent::apply(const Points& direction, Points& out, int offset) const {
  Points vertices;
  shell_.edges_.gather_change(direction, offset, vertices);
  Points forces(shell_.edges_.vertices(), Vec3::Zero());
  Eigen::Matrix<double, 18, 1> d, r;
  for (int i = begin_; i < end_; ++i) {
    const auto& v = shell_.elements_[i].vertices;
    for (int k = 0; k < 6; ++k) d.segment<3>(3 * k) = vertices[v[k]];
    r.noalias() = element_[i - begin_] * d;
    for (int k = 0; k < 6; ++k) forces[v[k]] += r.segment<3>(3 * k);
  }
  shell_.edges_.scatter(forces, out, offset);
}

void KirchhoffTangent::add_row_sums(std::vector<double>& bound, int offset) const {
  const std::vector<double> reach = shell_.edges_.gather_bound();
  std::vector<double> rows(shell_.edges_.vertices(), 0.0);
  Eigen::Matrix<double, 18, 1> d;
  for (int i = begin_; i < end_; ++i) {
    const auto& v = shell_.elements_[i].vertices;
    for (int k = 0; k < 6; ++k) d.segment<3>(3 * k).setConstant(reach[v[k]]);
    const Eigen::Matrix<double, 18, 1> r = element_[i - begin_].cwiseAbs() * d;
    for (int k = 0; k < 6; ++k) rows[v[k]] += r.segment<3>(3 * k).maxCoeff();
  }
  shell_.edges_.scatter_bound(rows, bound, offset);
}

}  // namespace valsalva::structure
