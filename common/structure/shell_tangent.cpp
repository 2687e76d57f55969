#include <omp.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "structure/share.hpp"
#include "structure/shell.hpp"
#include "structure/shell_kinematics.hpp"

namespace valsalva::structure {

ShellTangent::ShellTangent(const Shell& shell, Part part, Geometric geometric)
    : shell_(shell), part_(part), geometric_(geometric) {
  const Range e = share(shell.elements(), part), h = share(shell.hinges(), part);
  element_.resize(e.end - e.begin);
  hinge_.resize(h.end - h.begin);
}

void ShellTangent::update(const Points& x, int offset) {
  const Range own_elements = share(shell_.elements(), part_), own_hinges = share(shell_.hinges(), part_);
#pragma omp parallel for schedule(static) if (own_elements.end - own_elements.begin > 500)
  for (int e = own_elements.begin; e < own_elements.end; ++e) {
    const Triangle& t = shell_.mesh_.triangles[e];
    const Shell::Element& element = shell_.elements_[e];
    const auto gradient =
        deformation(x[offset + t[0]], x[offset + t[1]], x[offset + t[2]], element.inverse_edges);
    const Eigen::Matrix2d c = gradient.transpose() * gradient;
    const materials::PlaneTangent response =
        materials::plane_tangent(*shell_.law_, c, element.fibres, element.factor);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> geometric;
    geometric.computeDirect(response.at.stress);
    const Eigen::Matrix2d clipped = geometric.eigenvectors() *
                                    geometric.eigenvalues().cwiseMax(0.0).asDiagonal() *
                                    geometric.eigenvectors().transpose();
    // Rows: gradients of the three shape functions in the reference plane.
    Eigen::Matrix<double, 3, 2> shape;
    shape.row(1) = element.inverse_edges.row(0);
    shape.row(2) = element.inverse_edges.row(1);
    shape.row(0) = -shape.row(1) - shape.row(2);
    Eigen::Matrix<double, 3, 9> strain;  // dE in Voigt order per nodal displacement
    for (int a = 0; a < 3; ++a) {
      const Vec3 f1 = gradient.col(0), f2 = gradient.col(1);
      strain.block<1, 3>(0, 3 * a) = shape(a, 0) * f1.transpose();
      strain.block<1, 3>(1, 3 * a) = shape(a, 1) * f2.transpose();
      strain.block<1, 3>(2, 3 * a) = shape(a, 0) * f2.transpose() + shape(a, 1) * f1.transpose();
    }
    const double volume = element.thickness * element.area;
    ElementMatrix& k = element_[e - own_elements.begin];
    const Eigen::Matrix<double, 3, 9> stressed = volume * response.tangent * strain;
    k.noalias() = strain.transpose().lazyProduct(stressed);
    const Eigen::Matrix3d pull =
        volume * shape * (geometric_ == Geometric::exact ? response.at.stress : clipped) * shape.transpose();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) k.block<3, 3>(3 * a, 3 * b).diagonal().array() += pull(a, b);
  }
#pragma omp parallel for schedule(static) if (own_hinges.end - own_hinges.begin > 500)
  for (int h = own_hinges.begin; h < own_hinges.end; ++h) {
    const Shell::Hinge& hinge = shell_.hinges_[h];
    const auto& n = hinge.nodes;
    const HingeGeometry g =
        hinge_geometry(x[offset + n[0]], x[offset + n[1]], x[offset + n[2]], x[offset + n[3]]);
    HingeVector& v = hinge_[h - own_hinges.begin];
    const double root = std::sqrt(hinge.stiffness);
    for (int a = 0; a < 4; ++a) v.segment<3>(3 * a) = root * g.gradient[a];
  }
}

void ShellTangent::apply(const Points& direction, Points& out, int offset) const {
  const Range own_elements = share(shell_.elements(), part_), own_hinges = share(shell_.hinges(), part_);
  Eigen::Matrix<double, 9, 1> d, r;
  for (int e = own_elements.begin; e < own_elements.end; ++e) {
    const Triangle& t = shell_.mesh_.triangles[e];
    for (int a = 0; a < 3; ++a) d.segment<3>(3 * a) = direction[offset + t[a]];
    r = element_[e - own_elements.begin].lazyProduct(d);  // in place of a call for each
    for (int a = 0; a < 3; ++a) out[offset + t[a]] += r.segment<3>(3 * a);
  }
  for (int h = own_hinges.begin; h < own_hinges.end; ++h) {
    const auto& n = shell_.hinges_[h].nodes;
    const HingeVector& v = hinge_[h - own_hinges.begin];
    double along = 0;
    for (int a = 0; a < 4; ++a) along += v.segment<3>(3 * a).dot(direction[offset + n[a]]);
    for (int a = 0; a < 4; ++a) out[offset + n[a]] += along * v.segment<3>(3 * a);
  }
}

void ShellTangent::add_row_sums(std::vector<double>& bound, int offset) const {
  const Range own_elements = share(shell_.elements(), part_), own_hinges = share(shell_.hinges(), part_);
  for (int e = own_elements.begin; e < own_elements.end; ++e) {
    const Eigen::Matrix<double, 9, 1> rows = element_[e - own_elements.begin].cwiseAbs().rowwise().sum();
    for (int a = 0; a < 3; ++a)
      bound[offset + shell_.mesh_.triangles[e][a]] += rows.segment<3>(3 * a).maxCoeff();
  }
  for (int h = own_hinges.begin; h < own_hinges.end; ++h) {
    const HingeVector& v = hinge_[h - own_hinges.begin];
    const double total = v.cwiseAbs().sum();
    for (int a = 0; a < 4; ++a)
      bound[offset + shell_.hinges_[h].nodes[a]] += total * v.segment<3>(3 * a).cwiseAbs().maxCoeff();
  }
}

void ShellTangent::add_membrane(BlockMatrix& out, int offset) const {
  const Range own = share(shell_.elements(), part_);
  add_in_batches(own.end - own.begin, out, [&](int i, BlockMatrix::Piece& piece) {
    const Triangle& nodes = shell_.mesh_.triangles[own.begin + i];
    piece.slots = {offset + nodes[0], offset + nodes[1], offset + nodes[2]};
    piece.k = element_[i];
  });
}

Eigen::MatrixXd Shell::hinge_tangent(const Points& x, int offset, int h) const {
  // Lane 2 i is a step ahead along the unknown i of four, lane 2 i + 1 a step behind it.
  const std::array<int, 4>& nodes = hinges_[h].nodes;
  const double step = 1e-6 * (x[offset + nodes[1]] - x[offset + nodes[0]]).norm();
  const HingeGroup group{Lanes::Constant(hinges_[h].rest_angle), Lanes::Constant(hinges_[h].stiffness)};
  Eigen::MatrixXd k(12, 12);
  for (int first = 0; first < 12; first += lanes / 2) {
    std::array<LaneVector, 4> at;
    for (int a = 0; a < 4; ++a)
      for (int d = 0; d < 3; ++d) at[a][d] = Lanes::Constant(x[offset + nodes[a]][d]);
    for (int i = 0; i < lanes / 2; ++i) {
      Lanes& moved = at[(first + i) / 3][(first + i) % 3];
      moved[2 * i] += step;
      moved[2 * i + 1] -= step;
    }
    GroupForces g;
    hinge_forces(at, group, g);
    for (int i = 0; i < lanes / 2; ++i)
      for (int row = 0; row < 12; ++row) {
        const Lanes& force = g.force[row / 3][row % 3];
        k(row, first + i) = (force[2 * i + 1] - force[2 * i]) / (2 * step);
      }
  }
  return 0.5 * (k + k.transpose());
}

void Shell::add_tangent(const Points& x, BlockMatrix& out, int offset) const {
  ShellTangent tangent(*this, {}, ShellTangent::Geometric::exact);
  tangent.update(x, offset);
  tangent.add_membrane(out, offset);
  add_in_batches(hinges(), out, [&](int h, BlockMatrix::Piece& piece) {
    const std::array<int, 4>& nodes = hinges_[h].nodes;
    piece.slots.assign(nodes.begin(), nodes.end());
    for (int& a : piece.slots) a += offset;
    piece.k = hinge_tangent(x, offset, h);
  });
}

void Shell::add_tangent_product(const Points& x, const Points& direction, Points& out) const {
  ShellTangent tangent(*this);
  tangent.update(x);
  tangent.apply(direction, out);
}

void Shell::add_stiffness_bound(const Points& x, std::vector<double>& bound, int offset) const {
  ShellTangent tangent(*this);
  tangent.update(x, offset);
  tangent.add_row_sums(bound, offset);
}

}  // namespace valsalva::structure
