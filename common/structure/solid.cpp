#include "structure/solid.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.hpp"

namespace valsalva::structure {

void SolidMesh::add(Shape shape, std::span<const int> nodes) {
  if (offsets.empty()) offsets.push_back(0);
  connectivity.insert(connectivity.end(), nodes.begin(), nodes.end());
  offsets.push_back(static_cast<int>(connectivity.size()));
  shapes.push_back(shape);
}

Solid::Solid(SolidMesh mesh, std::shared_ptr<const materials::SolidLaw> law, Formulation formulation)
    : mesh_(std::move(mesh)), law_(std::move(law)), formulation_(formulation) {
  VALSALVA_ASSERT(law_);
  if (formulation_ == Formulation::mixed && !(law_->bulk_modulus_Pa() > 0))
    throw InputError(
        "solid: the mixed formulation needs a volumetric term; the law '{}' has none: give one, or use the "
        "displacement formulation",
        law_->name());
  check(mesh_);
  if (formulation_ == Formulation::mixed) {
    const double shear =
        law_->distortional(Mat3::Identity(), {}, 1, materials::Derivatives::tangent).tangent(5, 5);
    local_share_ = std::min(1.0, local_bulk_per_shear * shear / law_->bulk_modulus_Pa());
  }
  build_elements();
}

void Solid::check(const SolidMesh& mesh) const {
  const std::size_t count = mesh.shapes.size();
  const auto require = [&](const char* what, std::size_t found) {
    if (found != 0 && found != count)
      throw InputError("solid: {} has {} entries; expected {}: one an element", what, found, count);
  };
  require("fibre1", mesh.fibre1.size());
  require("fibre2", mesh.fibre2.size());
  require("stiffness factor", mesh.stiffness_factor.size());
  if (count == 0 || mesh.offsets.size() != count + 1 ||
      mesh.offsets.back() != static_cast<int>(mesh.connectivity.size()))
    throw InputError("solid: {} elements with {} offsets; expected at least one, and one offset more", count,
                     mesh.offsets.size());
  for (int e = 0; e < mesh.elements(); ++e) {
    const Shape shape = mesh.shapes[e];
    const int expected = structure::nodes_of(shape);
    const int found = mesh.offsets[e + 1] - mesh.offsets[e];
    if (dimension_of(shape) != 3 || found != expected)
      throw InputError("solid: element {} is a {} with {} nodes; expected tet4, tet10, hex8 or hex27 with {}",
                       e, name_of(shape), found, expected);
    for (int a : mesh.nodes_of(e))
      if (a < 0 || a >= static_cast<int>(mesh.reference.size()))
        throw InputError("solid: element {} refers to node {}; the mesh has {} nodes", e, a,
                         mesh.reference.size());
  }
}

void Solid::build_elements() {
  const bool mixed = formulation_ == Formulation::mixed;
  struct Tabulated {
    std::vector<QuadraturePoint> rule;
    std::vector<ShapeValues> at;
  };
  std::map<Shape, Tabulated> tables;
  elements_.resize(mesh_.shapes.size());
  if (mixed) {
    patches_.resize(mesh_.reference.size());
    patch_volume_.assign(mesh_.reference.size(), 0.0);
  }
  for (int e = 0; e < elements(); ++e) {
    const Shape shape = mesh_.shapes[e];
    Tabulated& table = tables[shape];
    if (table.rule.empty()) {
      table.rule = quadrature(shape, mixed && shape == Shape::tet10 ? Rule::rich : Rule::stiffness);
      for (const QuadraturePoint& q : table.rule) table.at.push_back(evaluate(shape, q.at));
    }
    const auto nodes = mesh_.nodes_of(e);
    ElementPoints reference(3, nodes.size());
    for (std::size_t a = 0; a < nodes.size(); ++a) reference.col(a) = mesh_.reference[nodes[a]];
    Element& element = elements_[e];
    element.first = static_cast<int>(points_.size());
    element.count = static_cast<int>(table.rule.size());
    element.factor = mesh_.stiffness_factor.empty() ? 1 : mesh_.stiffness_factor[e];
    if (!(element.factor > 0) || !std::isfinite(element.factor))
      throw InputError("solid: stiffness factor of element {} is {}; expected a positive one", e,
                       element.factor);
    element.fibres.count = 0;
    for (const std::vector<Vec3>* fibres : {&mesh_.fibre1, &mesh_.fibre2}) {
      if (fibres->empty()) continue;
      const double length = (*fibres)[e].norm();
      if (!(length > 0.1) || !std::isfinite(length))
        throw InputError("solid: a fibre of element {} has the length {}; expected a unit vector", e, length);
      element.fibres.direction[element.fibres.count++] = (*fibres)[e] / length;
    }
    for (int q = 0; q < element.count; ++q) {
      const ShapeValues& s = table.at[q];
      const Mat3 jacobian = reference * s.gradient.transpose();  // columns: dX/d(coordinate)
      const double det = jacobian.determinant();
      const double size = std::max({jacobian.col(0).norm(), jacobian.col(1).norm(), jacobian.col(2).norm()});
      if (!(det > 1e-9 * size * size * size))
        throw InputError(
            "solid: element {} ({}, nodes {} ...) is reversed or flat in the reference (Jacobian {:.3g} at "
            "point {}); reorder its nodes as VTK does, or remesh",
            e, name_of(shape), nodes[0], det, q);
      Point p;
      p.weight = det * table.rule[q].weight;
      p.gradient = gradients_.size();
      p.modes.setZero();
      p.reference = reference * s.value;
      const Eigen::Matrix<double, 3, Eigen::Dynamic> gradient = jacobian.transpose().inverse() * s.gradient;
      gradients_.insert(gradients_.end(), gradient.data(), gradient.data() + gradient.size());
      points_.push_back(p);
    }
    element.modes = 0;
    if (!mixed) continue;
    if (!averaged(e)) {
      build_modes(e, shape);
      continue;
    }
    for (int q = 0; q < element.count; ++q) {
      Point& p = points_[element.first + q];
      p.modes = evaluate(Shape::tet4, table.rule[q].at).value;
      for (int c = 0; c < 4; ++c) patch_volume_[nodes[c]] += p.weight * p.modes[c];
    }
    for (int c = 0; c < 4; ++c) patches_[nodes[c]].push_back(e);
  }
  patch_nodes_.resize(patches_.size());
  for (std::size_t a = 0; a < patches_.size(); ++a) {
    std::vector<int>& around = patch_nodes_[a];
    for (int e : patches_[a]) around.insert(around.end(), mesh_.nodes_of(e).begin(), mesh_.nodes_of(e).end());
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
  }
}

// Orthonormal in the element: the projection on them needs no inverse.
void Solid::build_modes(int e, Shape shape) {
  Element& element = elements_[e];
  element.modes = shape == Shape::hex27 ? 4 : 1;
  const auto begin = points_.begin() + element.first, end = begin + element.count;
  double volume = 0;
  Vec3 centre = Vec3::Zero();
  for (auto p = begin; p != end; ++p) volume += p->weight, centre += p->weight * p->reference;
  centre /= volume;
  const double size = std::cbrt(volume);
  Eigen::Matrix4d mass = Eigen::Matrix4d::Identity();
  mass.topLeftCorner(element.modes, element.modes).setZero();
  for (auto p = begin; p != end; ++p) {
    p->modes[0] = 1;
    if (element.modes == 4) p->modes.tail<3>() = (p->reference - centre) / size;
    mass += p->weight * p->modes * p->modes.transpose();
  }
  const Eigen::LLT<Eigen::Matrix4d> factor(mass);
  for (auto p = begin; p != end; ++p) p->modes = factor.matrixL().solve(p->modes).eval();
}

double Solid::volume() const {
  double total = 0;
  for (const Point& p : points_) total += p.weight;
  return total;
}

std::vector<double> Solid::lumped_mass(double density_g_per_mm3) const {
  std::vector<double> mass(nodes(), 0.0);
  std::map<Shape, std::vector<std::pair<double, ShapeValues>>> tables;
  for (int e = 0; e < elements(); ++e) {
    auto& table = tables[mesh_.shapes[e]];
    if (table.empty())
      for (const QuadraturePoint& q : quadrature(mesh_.shapes[e], Rule::rich))
        table.emplace_back(q.weight, evaluate(mesh_.shapes[e], q.at));
    const auto nodes = mesh_.nodes_of(e);
    ElementPoints reference(3, nodes.size());
    for (std::size_t a = 0; a < nodes.size(); ++a) reference.col(a) = mesh_.reference[nodes[a]];
    Eigen::VectorXd square = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(nodes.size()));
    double volume = 0;
    for (const auto& [weight, s] : table) {
      const Mat3 jacobian = reference * s.gradient.transpose();
      const double w = weight * jacobian.determinant();
      volume += w;
      square += w * s.value.cwiseAbs2();
    }
    square *= density_g_per_mm3 * volume / square.sum();
    for (std::size_t a = 0; a < nodes.size(); ++a) mass[nodes[a]] += square[static_cast<Eigen::Index>(a)];
  }
  return mass;
}

double SolidTerm::add_forces(const Configuration& now, Forces& out) const {
  return solid_->add_forces(now.x, out.force, body_.offset);
}

void SolidTerm::add_stiffness_bound(const Configuration& now, StiffnessBound& out) const {
  solid_->add_stiffness_bound(now.x, out.translation, body_.offset);
}

void SolidTerm::add_tangent(const Configuration& now, BlockMatrix& out) const {
  solid_->add_tangent(now.x, out, body_.offset);
}

}  // namespace valsalva::structure
