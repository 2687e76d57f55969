#include "structure/shell.hpp"

#include <omp.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

struct Range {
  int begin, end;
};

Range share(int count, Part part) {
  const auto at = [&](int index) { return static_cast<int>(static_cast<long>(count) * index / part.count); };
  return {at(part.index), at(part.index + 1)};
}

// Deformation gradient F (3x2) of a triangle.
Eigen::Matrix<double, 3, 2> deformation(const Vec3& x0, const Vec3& x1, const Vec3& x2,
                                        const Eigen::Matrix2d& inverse_edges) {
  Eigen::Matrix<double, 3, 2> edges;
  edges << x1 - x0, x2 - x0;
  return edges * inverse_edges;
}

template <class Count>
void require_size(const char* what, Count found, Count expected) {
  if (found != expected)
    throw InputError("shell: {} has {} entries; expected {}: one each", what, found, expected);
}

}  // namespace

Shell::Shell(ShellMesh mesh, std::shared_ptr<const materials::PlaneLaw> law, Bending bending)
    : mesh_(std::move(mesh)), law_(std::move(law)) {
  VALSALVA_ASSERT(law_);
  require_size("thickness (per node)", mesh_.thickness_mm.size(), mesh_.reference.size());
  if (mesh_.fibre1.empty()) VALSALVA_ASSERT(mesh_.fibre2.empty());
  if (!mesh_.fibre1.empty())
    require_size("fibre1 (per triangle)", mesh_.fibre1.size(), mesh_.triangles.size());
  if (!mesh_.fibre2.empty())
    require_size("fibre2 (per triangle)", mesh_.fibre2.size(), mesh_.triangles.size());
  if (!mesh_.stiffness_factor.empty())
    require_size("stiffness factor (per triangle)", mesh_.stiffness_factor.size(), mesh_.triangles.size());
  for (std::size_t a = 0; a < mesh_.thickness_mm.size(); ++a)
    if (!(mesh_.thickness_mm[a] > 0) || !std::isfinite(mesh_.thickness_mm[a]))
      throw InputError("shell: thickness of node {} is {} mm; expected a positive one", a,
                       mesh_.thickness_mm[a]);
  if (!(bending.modulus_Pa >= 0) || !(std::abs(bending.poisson) <= 0.5))
    throw InputError(
        "shell: bending modulus {} Pa, Poisson's ratio {}; expected not negative, and -0.5 to 0.5",
        bending.modulus_Pa, bending.poisson);
  build_elements();
  if (bending.modulus_Pa > 0) build_hinges(bending);
}

void Shell::build_elements() {
  const int count = static_cast<int>(mesh_.triangles.size());
  elements_.resize(count);
  for (int e = 0; e < count; ++e) {
    const Triangle& t = mesh_.triangles[e];
    for (int a : t)
      if (a < 0 || a >= nodes())
        throw InputError("shell: triangle {} refers to node {}; the mesh has {} nodes", e, a, nodes());
    const Vec3 edge1 = mesh_.reference[t[1]] - mesh_.reference[t[0]];
    const Vec3 edge2 = mesh_.reference[t[2]] - mesh_.reference[t[0]];
    const Vec3 normal = edge1.cross(edge2);
    const double longest =
        std::max({edge1.squaredNorm(), edge2.squaredNorm(), (edge2 - edge1).squaredNorm()});
    if (!(normal.norm() > 1e-6 * longest))
      throw InputError("shell: triangle {} (nodes {}, {}, {}) has no area in the reference shape; remesh it",
                       e, t[0], t[1], t[2]);
    const Vec3 axis1 = edge1.normalized();
    const Vec3 axis2 = normal.normalized().cross(axis1);
    Element& element = elements_[e];
    Eigen::Matrix2d edges;
    edges << edge1.dot(axis1), edge2.dot(axis1), edge1.dot(axis2), edge2.dot(axis2);
    element.inverse_edges = edges.inverse();
    element.area = 0.5 * normal.norm();
    element.thickness = (mesh_.thickness_mm[t[0]] + mesh_.thickness_mm[t[1]] + mesh_.thickness_mm[t[2]]) / 3;
    element.factor = mesh_.stiffness_factor.empty() ? 1 : mesh_.stiffness_factor[e];
    if (!(element.factor > 0))
      throw InputError("shell: stiffness factor of triangle {} is {}; expected a positive one", e,
                       element.factor);
    for (const std::vector<Vec3>* fibres : {&mesh_.fibre1, &mesh_.fibre2}) {
      if (fibres->empty()) continue;
      const Eigen::Vector2d in_plane((*fibres)[e].dot(axis1), (*fibres)[e].dot(axis2));
      if (!(in_plane.norm() > 0.1))
        throw InputError("shell: fibre of triangle {} does not lie in it; expected a unit tangent vector", e);
      element.fibres.direction[element.fibres.count++] = in_plane.normalized();
    }
  }
}

void Shell::build_hinges(const Bending& bending) {
  std::map<Edge, std::vector<std::pair<int, int>>> sides;  // edge -> (triangle, opposite node)
  for (int e = 0; e < elements(); ++e) {
    const Triangle& t = mesh_.triangles[e];
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      sides[{std::min(a, b), std::max(a, b)}].emplace_back(e, t[(k + 2) % 3]);
    }
  }
  for (const auto& [edge, both] : sides) {
    if (both.size() > 2)
      throw InputError(
          "shell: edge {}-{} belongs to {} triangles; expected at most two: the mesh is not manifold",
          edge[0], edge[1], both.size());
    if (both.size() < 2) continue;
    // Oriented as in the first triangle, so that node 2 lies left of 0 -> 1 seen against the normal.
    const Triangle& first = mesh_.triangles[both[0].first];
    int a = edge[0], b = edge[1];
    for (int k = 0; k < 3; ++k)
      if (first[k] == edge[1] && first[(k + 1) % 3] == edge[0]) std::swap(a, b);
    const Element& one = elements_[both[0].first];
    const Element& two = elements_[both[1].first];
    const double thickness = 0.5 * (one.thickness + two.thickness);
    const double factor = 0.5 * (one.factor + two.factor);
    const double rigidity = factor * bending.modulus_Pa * thickness * thickness * thickness /
                            (12 * (1 - bending.poisson * bending.poisson));
    const double length2 = (mesh_.reference[b] - mesh_.reference[a]).squaredNorm();
    hinges_.push_back(
        {{a, b, both[0].second, both[1].second}, 0, rigidity * length2 / (one.area + two.area)});
    hinges_.back().rest_angle = hinge_angle(mesh_.reference, hinges() - 1);
  }
}

std::vector<double> Shell::lumped_area() const {
  std::vector<double> area(nodes(), 0.0);
  for (int e = 0; e < elements(); ++e)
    for (int a : mesh_.triangles[e]) area[a] += elements_[e].area / 3;
  return area;
}

std::vector<double> Shell::lumped_mass(double density_g_per_mm3) const {
  std::vector<double> mass(nodes(), 0.0);
  for (int e = 0; e < elements(); ++e)
    for (int a : mesh_.triangles[e])
      mass[a] += density_g_per_mm3 * elements_[e].thickness * elements_[e].area / 3;
  return mass;
}

double Shell::element_forces(const Points& x, int offset, int e, std::array<Vec3, 3>& f) const {
  const Triangle& t = mesh_.triangles[e];
  const Element& element = elements_[e];
  const auto gradient =
      deformation(x[offset + t[0]], x[offset + t[1]], x[offset + t[2]], element.inverse_edges);
  const Eigen::Matrix2d c = gradient.transpose() * gradient;
  const materials::PlaneStress s = materials::plane_stress(*law_, c, element.fibres, element.factor);
  const double volume = element.thickness * element.area;
  const Eigen::Matrix<double, 3, 2> h = -volume * gradient * s.stress * element.inverse_edges.transpose();
  f[1] = h.col(0);
  f[2] = h.col(1);
  f[0] = -(f[1] + f[2]);
  return volume * s.energy;
}

namespace {

// Angle between the normals of the two triangles of a hinge (edge 0-1, opposite nodes 2 and 3), positive when
// it folds towards the side of the normal; and its gradient (Bridson, Marino and Fedkiw 2003, section 2).
struct HingeGeometry {
  double angle;
  std::array<Vec3, 4> gradient;
};

double angle_of(const Vec3& normal1, const Vec3& normal2, const Vec3& edge) {
  return std::atan2(normal1.cross(normal2).dot(edge) / edge.norm(), normal1.dot(normal2));
}

HingeGeometry hinge_geometry(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3) {
  const Vec3 edge = x1 - x0;
  const Vec3 normal1 = edge.cross(x2 - x0);
  const Vec3 normal2 = (x3 - x0).cross(edge);
  const double length = edge.norm();
  const double square1 = std::max(normal1.squaredNorm(), 1e-20),
               square2 = std::max(normal2.squaredNorm(), 1e-20);
  HingeGeometry g;
  g.angle = angle_of(normal1, normal2, edge);
  const Vec3 u1 = -normal1 / square1, u2 = -normal2 / square2;
  g.gradient[2] = length * u1;
  g.gradient[3] = length * u2;
  g.gradient[0] = ((x2 - x1).dot(edge) / length) * u1 + ((x3 - x1).dot(edge) / length) * u2;
  g.gradient[1] = -((x2 - x0).dot(edge) / length) * u1 - ((x3 - x0).dot(edge) / length) * u2;
  return g;
}

// The difference of two angles, brought to (-pi, pi].
double turn(double angle) {
  return std::remainder(angle, 2 * M_PI);
}

}  // namespace

double Shell::hinge_angle(const Points& x, int h, int offset) const {
  const auto& n = hinges_[h].nodes;
  const Vec3 &x0 = x[offset + n[0]], &x1 = x[offset + n[1]], &x2 = x[offset + n[2]], &x3 = x[offset + n[3]];
  return angle_of((x1 - x0).cross(x2 - x0), (x3 - x0).cross(x1 - x0), x1 - x0);
}

double Shell::hinge_forces(const Points& x, int offset, int h, std::array<Vec3, 4>& f) const {
  const auto& n = hinges_[h].nodes;
  return hinge_forces({x[offset + n[0]], x[offset + n[1]], x[offset + n[2]], x[offset + n[3]]}, h, f);
}

double Shell::hinge_forces(const std::array<Vec3, 4>& at, int h, std::array<Vec3, 4>& f) const {
  const Hinge& hinge = hinges_[h];
  const HingeGeometry g = hinge_geometry(at[0], at[1], at[2], at[3]);
  const double bend = turn(g.angle - hinge.rest_angle);
  for (int k = 0; k < 4; ++k) f[k] = -hinge.stiffness * bend * g.gradient[k];
  return 0.5 * hinge.stiffness * bend * bend;
}

double Shell::add_forces(const Points& x, Points& f, int offset, Part part) const {
  const Range own_elements = share(elements(), part), own_hinges = share(hinges(), part);
  double energy = 0;
  const auto add_element = [&](int e, const std::array<Vec3, 3>& g) {
    for (int k = 0; k < 3; ++k) f[offset + mesh_.triangles[e][k]] += g[k];
  };
  const auto add_hinge = [&](int h, const std::array<Vec3, 4>& g) {
    for (int k = 0; k < 4; ++k) f[offset + hinges_[h].nodes[k]] += g[k];
  };
  const int work = own_elements.end - own_elements.begin;
  if (omp_get_max_threads() == 1 || omp_in_parallel() || work < 500) {
    for (int e = own_elements.begin; e < own_elements.end; ++e) {
      std::array<Vec3, 3> g;
      energy += element_forces(x, offset, e, g);
      add_element(e, g);
    }
    for (int h = own_hinges.begin; h < own_hinges.end; ++h) {
      std::array<Vec3, 4> g;
      energy += hinge_forces(x, offset, h, g);
      add_hinge(h, g);
    }
    return energy;
  }
  // Threads fill slots; one thread adds them up in the order of the loop above, so the bits are the same.
  struct Slot {
    std::array<Vec3, 4> force;
    double energy;
  };
  thread_local std::vector<Slot> storage;
  std::vector<Slot>& slots = storage;  // the calling thread's own, seen by the team
  slots.resize(work + own_hinges.end - own_hinges.begin);
  const int total = static_cast<int>(slots.size());
#pragma omp parallel for schedule(static)
  for (int i = 0; i < total; ++i) {
    Slot& slot = slots[i];
    if (i < work) {
      std::array<Vec3, 3> g;
      slot.energy = element_forces(x, offset, own_elements.begin + i, g);
      for (int k = 0; k < 3; ++k) slot.force[k] = g[k];
    } else {
      slot.energy = hinge_forces(x, offset, own_hinges.begin + i - work, slot.force);
    }
  }
  for (int i = 0; i < work; ++i) {
    energy += slots[i].energy;
    add_element(own_elements.begin + i, {slots[i].force[0], slots[i].force[1], slots[i].force[2]});
  }
  for (int i = work; i < total; ++i) {
    energy += slots[i].energy;
    add_hinge(own_hinges.begin + i - work, slots[i].force);
  }
  return energy;
}

ElementState Shell::element_state(const Points& x, int e, int offset) const {
  const Triangle& t = mesh_.triangles[e];
  const Element& element = elements_[e];
  const auto gradient =
      deformation(x[offset + t[0]], x[offset + t[1]], x[offset + t[2]], element.inverse_edges);
  const Eigen::Matrix2d c = gradient.transpose() * gradient;
  const materials::PlaneStress s = materials::plane_stress(*law_, c, element.fibres, element.factor);
  // Incompressible: J = 1, Cauchy = F S F^T; its two in-plane eigenvalues are those of S C.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> stretch(c);
  const Eigen::Matrix2d root = stretch.operatorSqrt();
  const Eigen::Matrix2d cauchy = root * s.stress * root;
  const double a = cauchy(0, 0), b = cauchy(1, 1), shear = cauchy(0, 1);
  return {std::sqrt(std::max(0.0, a * a - a * b + b * b + 3 * shear * shear)),
          std::sqrt(std::max(0.0, stretch.eigenvalues()[1])),
          std::sqrt(std::max(0.0, stretch.eigenvalues()[0])), s.exponent};
}

double Shell::max_exponent(const Points& x, int offset) const {
  double largest = 0;
  for (int e = 0; e < elements(); ++e) {
    const Triangle& t = mesh_.triangles[e];
    const auto gradient =
        deformation(x[offset + t[0]], x[offset + t[1]], x[offset + t[2]], elements_[e].inverse_edges);
    const Eigen::Matrix2d c = gradient.transpose() * gradient;
    largest = std::max(largest,
                       materials::plane_stress(*law_, c, elements_[e].fibres, elements_[e].factor).exponent);
  }
  return largest;
}

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
    r.noalias() = element_[e - own_elements.begin] * d;
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
  const std::array<int, 4>& nodes = hinges_[h].nodes;
  std::array<Vec3, 4> moved;
  for (int a = 0; a < 4; ++a) moved[a] = x[offset + nodes[a]];
  const double step = 1e-6 * (moved[1] - moved[0]).norm();
  Eigen::MatrixXd k(12, 12);
  for (int column = 0; column < 12; ++column) {
    double& at = moved[column / 3][column % 3];
    const double here = at;
    std::array<Vec3, 4> ahead, behind;
    at = here + step;
    hinge_forces(moved, h, ahead);
    at = here - step;
    hinge_forces(moved, h, behind);
    at = here;
    for (int a = 0; a < 4; ++a) k.block<3, 1>(3 * a, column) = (behind[a] - ahead[a]) / (2 * step);
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
