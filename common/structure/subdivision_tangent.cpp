// The subdivision shell's tangents, stiffness bound and states.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "structure/subdivision_shell.hpp"

namespace valsalva::structure {

void SubdivisionShell::element_tangent(const Points& vertices, int e, bool positive,
                                       Eigen::MatrixXd& k) const {
  const int n = vertices_of(e);
  k.setZero(3 * n, 3 * n);
  Eigen::Matrix<double, 15, Eigen::Dynamic> pulled(15, 3 * n);
  for (int q = elements_[e].point; q < elements_[e + 1].point; ++q) {
    const Point& p = points_[q];
    const Hessian h = hessian(p, jet(vertices, e, p), positive);
    const double* basis = basis_.data() + p.basis;
    for (int b = 0; b < n; ++b) {
      auto column = pulled.middleCols<3>(3 * b);
      column.noalias() = basis[6 * b + 1] * h.middleCols<3>(0);
      for (int d = 1; d < 5; ++d) column.noalias() += basis[6 * b + 1 + d] * h.middleCols<3>(3 * d);
    }
    for (int a = 0; a < n; ++a) {
      auto row = k.middleRows<3>(3 * a);
      for (int d = 0; d < 5; ++d) row.noalias() += basis[6 * a + 1 + d] * pulled.middleRows<3>(3 * d);
    }
  }
}

void SubdivisionShell::add_tangent(const Points& x, BlockMatrix& out, int offset,
                                   std::span<const Mat3> clamps) const {
  Points vertices;
  surface_.gather(x, offset, vertices, clamps);
  constexpr int batch = 256;
  std::vector<Eigen::MatrixXd> k(std::min(batch, elements()));
  for (int begin = 0; begin < elements(); begin += batch) {
    const int end = std::min(begin + batch, elements());
#pragma omp parallel for schedule(static)
    for (int e = begin; e < end; ++e) element_tangent(vertices, e, false, k[e - begin]);
    for (int e = begin; e < end; ++e)
      surface_.add_matrix({vertices_.data() + elements_[e].vertex, static_cast<std::size_t>(vertices_of(e))},
                          k[e - begin], out, offset);
  }
}

ElementState SubdivisionShell::layer_state(const Point& p, const Jet& j, double height) const {
  const Vec3 a1 = j.col(0), a2 = j.col(1), n = a1.cross(a2).normalized();
  Eigen::Matrix2d metric, curvature;
  metric << a1.dot(a1), a1.dot(a2), a1.dot(a2), a2.dot(a2);
  curvature << n.dot(j.col(2)), n.dot(j.col(4)), n.dot(j.col(4)), n.dot(j.col(3));
  const SectionStress s = section_->stress(p.section, p.map.transpose() * metric * p.map,
                                           p.map.transpose() * curvature * p.map, height);
  // Incompressible: J = 1, Cauchy = F S F^T, which has the in-plane invariants of C^1/2 S C^1/2.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> stretch(s.c);
  const Eigen::Matrix2d root = stretch.operatorSqrt();
  const Eigen::Matrix2d cauchy = root * s.stress * root;
  const double a = cauchy(0, 0), b = cauchy(1, 1), shear = cauchy(0, 1);
  return {std::sqrt(std::max(0.0, a * a - a * b + b * b + 3 * shear * shear)),
          std::sqrt(std::max(0.0, stretch.eigenvalues()[1])),
          std::sqrt(std::max(0.0, stretch.eigenvalues()[0])), s.exponent};
}

LayerStates SubdivisionShell::layer_states(const Points& x, int e, int offset) const {
  constexpr double third = 1. / 3;
  const TrianglePatch patch = surface_.patch(e);
  const BasisTable table = loop_basis(patch.rings, third, third);
  Points rest, vertices;
  surface_.gather(surface_.reference(), 0, rest);
  surface_.gather(x, offset, vertices);
  const Point p = make_point(e, 0, table, patch, third, third, 0.5, rest);
  Jet j = Jet::Zero();
  for (int a = 0; a < patch.rings.vertices; ++a)
    j += vertices[patch.vertices[a]] * table.col(a).tail<5>().transpose();
  return {layer_state(p, j, -0.5), layer_state(p, j, 0), layer_state(p, j, 0.5)};
}

ElementState SubdivisionShell::element_state(const Points& x, int e, int offset) const {
  return layer_states(x, e, offset).middle;
}

void SubdivisionShell::add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset) const {
  SubdivisionTangent tangent(*this);
  tangent.update(x, offset);
  tangent.add_row_sums(bound, offset);
}

void SubdivisionShell::add_tangent_product(const Points& x, const Points& direction, Points& out) const {
  SubdivisionTangent tangent(*this);
  tangent.update(x);
  tangent.apply(direction, out);
}

SubdivisionTangent::SubdivisionTangent(const SubdivisionShell& shell, Part part) : shell_(shell) {
  const auto at = [&](int index) {
    return static_cast<int>(static_cast<long>(shell.elements()) * index / part.count);
  };
  begin_ = at(part.index);
  end_ = at(part.index + 1);
  element_.resize(end_ - begin_);
}

void SubdivisionTangent::update(const Points& x, int offset) {
  Points vertices;
  shell_.surface_.gather(x, offset, vertices);
#pragma omp parallel for schedule(static) if (end_ - begin_ > 200)
  for (int e = begin_; e < end_; ++e) shell_.element_tangent(vertices, e, true, element_[e - begin_]);
}

void SubdivisionTangent::apply(const Points& direction, Points& out, int offset) const {
  Points vertices;
  shell_.surface_.gather_change(direction, offset, vertices);
  Points forces(shell_.surface_.vertices(), Vec3::Zero());
  Eigen::VectorXd d, r;
  for (int e = begin_; e < end_; ++e) {
    const int n = shell_.vertices_of(e);
    const int* v = shell_.vertices_.data() + shell_.elements_[e].vertex;
    d.resize(3 * n);
    for (int a = 0; a < n; ++a) d.segment<3>(3 * a) = vertices[v[a]];
    r.noalias() = element_[e - begin_] * d;
    for (int a = 0; a < n; ++a) forces[v[a]] += r.segment<3>(3 * a);
  }
  shell_.surface_.scatter(forces, out, offset);
}

void SubdivisionTangent::add_row_sums(std::vector<double>& bound, int offset) const {
  const std::vector<double> reach = shell_.surface_.gather_bound();
  std::vector<double> rows(shell_.surface_.vertices(), 0.0);
  Eigen::VectorXd d;
  for (int e = begin_; e < end_; ++e) {
    const int n = shell_.vertices_of(e);
    const int* v = shell_.vertices_.data() + shell_.elements_[e].vertex;
    d.resize(3 * n);
    for (int a = 0; a < n; ++a) d.segment<3>(3 * a).setConstant(reach[v[a]]);
    const Eigen::VectorXd r = element_[e - begin_].cwiseAbs() * d;
    for (int a = 0; a < n; ++a) rows[v[a]] += r.segment<3>(3 * a).maxCoeff();
  }
  shell_.surface_.scatter_bound(rows, bound, offset);
}

}  // namespace valsalva::structure
