#include "structure/subdivision_shell.hpp"

#include <omp.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <exception>
#include <map>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Row15 = Eigen::Matrix<double, 1, 15>;

struct Range {
  int begin, end;
};

Range share(int count, Part part) {
  const auto at = [&](int index) { return static_cast<int>(static_cast<long>(count) * index / part.count); };
  return {at(part.index), at(part.index + 1)};
}

template <class Count>
void require_size(const char* what, Count found, Count expected) {
  if (found != expected)
    throw InputError("shell: {} has {} entries; expected {}: one each", what, found, expected);
}

void check(const ShellMesh& mesh) {
  require_size("thickness (per node)", mesh.thickness_mm.size(), mesh.reference.size());
  for (std::size_t a = 0; a < mesh.thickness_mm.size(); ++a)
    if (!(mesh.thickness_mm[a] > 0) || !std::isfinite(mesh.thickness_mm[a]))
      throw InputError("shell: thickness of node {} is {} mm; expected a positive one", a,
                       mesh.thickness_mm[a]);
  if (!mesh.fibre1.empty()) require_size("fibre1 (per triangle)", mesh.fibre1.size(), mesh.triangles.size());
  if (!mesh.fibre2.empty()) require_size("fibre2 (per triangle)", mesh.fibre2.size(), mesh.triangles.size());
  if (mesh.stiffness_factor.empty()) return;
  require_size("stiffness factor (per triangle)", mesh.stiffness_factor.size(), mesh.triangles.size());
  for (std::size_t e = 0; e < mesh.stiffness_factor.size(); ++e)
    if (!(mesh.stiffness_factor[e] > 0))
      throw InputError("shell: stiffness factor of triangle {} is {}; expected a positive one", e,
                       mesh.stiffness_factor[e]);
}

struct ParameterPoint {
  double r, s, weight;
};

std::vector<ParameterPoint> quadrature(ShellQuadrature rule, bool regular) {
  if (rule == ShellQuadrature::one) return {{1. / 3, 1. / 3, 0.5}};
  const std::vector<ParameterPoint> three{
      {1. / 6, 1. / 6, 1. / 6}, {2. / 3, 1. / 6, 1. / 6}, {1. / 6, 2. / 3, 1. / 6}};
  if (regular) return three;
  std::vector<ParameterPoint> quarters;
  for (const ParameterPoint& p : three) {
    quarters.push_back({0.5 * p.r, 0.5 * p.s, 0.25 * p.weight});
    quarters.push_back({0.5 * (1 + p.r), 0.5 * p.s, 0.25 * p.weight});
    quarters.push_back({0.5 * p.r, 0.5 * (1 + p.s), 0.25 * p.weight});
    quarters.push_back({0.5 * (1 - p.r), 0.5 * (1 - p.s), 0.25 * p.weight});
  }
  return quarters;
}

// The middle surface at a point, from its derivatives x,1 x,2 x,11 x,22 x,12.
struct Surface {
  Vec3 a1, a2, n, dual1, dual2;
  Matrix2d metric, inverse;
  std::array<double, 3> b;                     // b11, b22, b12
  std::array<std::array<double, 3>, 2> gamma;  // G^1_ab, G^2_ab

  explicit Surface(const Eigen::Matrix<double, 3, 5>& j) : a1(j.col(0)), a2(j.col(1)) {
    n = a1.cross(a2);
    n /= std::max(n.norm(), 1e-300);
    metric << a1.dot(a1), a1.dot(a2), a1.dot(a2), a2.dot(a2);
    const double det = std::max(metric(0, 0) * metric(1, 1) - metric(0, 1) * metric(0, 1), 1e-300);
    inverse << metric(1, 1) / det, -metric(0, 1) / det, -metric(0, 1) / det, metric(0, 0) / det;
    dual1 = inverse(0, 0) * a1 + inverse(0, 1) * a2;
    dual2 = inverse(1, 0) * a1 + inverse(1, 1) * a2;
    for (int i = 0; i < 3; ++i) {
      b[i] = n.dot(j.col(2 + i));
      gamma[0][i] = dual1.dot(j.col(2 + i));
      gamma[1][i] = dual2.dot(j.col(2 + i));
    }
  }
  Matrix2d curvature() const { return (Matrix2d() << b[0], b[2], b[2], b[1]).finished(); }
};

// Strains of the parameters (11, 22, 2 12) to those of the orthonormal basis: e' = m^T e m.
Matrix3d to_basis(const Matrix2d& m) {
  const double p = m(0, 0), q = m(0, 1), r = m(1, 0), s = m(1, 1);
  return (Matrix3d() << p * p, r * r, p * r, q * q, s * s, q * s, 2 * p * q, 2 * r * s, p * s + q * r)
      .finished();
}

}  // namespace

struct SubdivisionShell::Response {
  Vec3 p1, p2;  // d(energy)/d(x,1), d(x,2)
  double m11, m22, m12;
  Vec3 n;
  double energy, exponent;
};

SubdivisionShell::SubdivisionShell(ShellMesh mesh, std::shared_ptr<const SectionModel> section,
                                   const EdgeConditions& conditions, ShellQuadrature rule,
                                   SubdivisionSurface::Given given)
    : mesh_((check(mesh), std::move(mesh))),
      section_(std::move(section)),
      surface_(mesh_.reference, mesh_.triangles, conditions, given) {
  VALSALVA_ASSERT(section_);
  Points vertices;
  surface_.gather(surface_.reference(), 0, vertices);
  // Triangles with equal rings share their basis functions.
  std::map<std::array<std::vector<int>, 3>, int> tables;
  for (int e = 0; e < elements(); ++e) {
    const TrianglePatch patch = surface_.patch(e);
    elements_.push_back({static_cast<int>(vertices_.size()), static_cast<int>(points_.size())});
    vertices_.insert(vertices_.end(), patch.vertices.begin(), patch.vertices.end());
    const std::vector<ParameterPoint> rule_points = quadrature(rule, patch.rings.regular());
    const auto [entry, created] = tables.try_emplace(patch.rings.rings, static_cast<int>(basis_.size()));
    if (created)
      for (const ParameterPoint& q : rule_points) {
        const BasisTable table = loop_basis(patch.rings, q.r, q.s);
        basis_.insert(basis_.end(), table.data(), table.data() + table.size());
      }
    int basis = entry->second;
    for (const ParameterPoint& q : rule_points) {
      const Eigen::Map<const BasisTable> table(basis_.data() + basis, 6, patch.rings.vertices);
      points_.push_back(make_point(e, basis, table, patch, q.r, q.s, q.weight, vertices));
      basis += 6 * patch.rings.vertices;
    }
  }
  elements_.push_back({static_cast<int>(vertices_.size()), static_cast<int>(points_.size())});
  std::vector<std::vector<int>> of_vertex(surface_.vertices());
  for (std::size_t i = 0; i < vertices_.size(); ++i) of_vertex[vertices_[i]].push_back(static_cast<int>(i));
  for (const std::vector<int>& slots : of_vertex) {
    const int begin = static_cast<int>(gather_slots_.size());
    gather_slots_.insert(gather_slots_.end(), slots.begin(), slots.end());
    gather_.push_back({begin, static_cast<int>(gather_slots_.size())});
  }
}

SubdivisionShell::Point SubdivisionShell::make_point(int e, int basis, const BasisTable& table,
                                                     const TrianglePatch& patch, double r, double s,
                                                     double parameter, const Points& vertices) const {
  Jet j = Jet::Zero();
  for (int a = 0; a < patch.rings.vertices; ++a)
    j += vertices[patch.vertices[a]] * table.col(a).tail<5>().transpose();
  const Triangle& t = mesh_.triangles[e];
  const double longest = std::max({(mesh_.reference[t[1]] - mesh_.reference[t[0]]).squaredNorm(),
                                   (mesh_.reference[t[2]] - mesh_.reference[t[1]]).squaredNorm(),
                                   (mesh_.reference[t[0]] - mesh_.reference[t[2]]).squaredNorm()});
  const double stretch = j.col(0).cross(j.col(1)).norm();
  if (!(stretch > 1e-6 * longest))
    throw InputError(
        "shell: the surface of triangle {} (nodes {}, {}, {}) has no area in the reference shape; remesh it",
        e, t[0], t[1], t[2]);
  const Surface surface(j);
  const Vec3 e1 = surface.a1.normalized(), e2 = surface.n.cross(e1);
  Matrix2d tangents;
  tangents << surface.a1.dot(e1), surface.a2.dot(e1), surface.a1.dot(e2), surface.a2.dot(e2);
  Point p;
  p.basis = basis;
  p.parameter = parameter;
  p.area = parameter * stretch;
  p.map = tangents.inverse();
  const auto& thickness = mesh_.thickness_mm;
  p.section.thickness = (1 - r - s) * thickness[t[0]] + r * thickness[t[1]] + s * thickness[t[2]];
  p.section.curvature = p.map.transpose() * surface.curvature() * p.map;
  p.section.factor = mesh_.stiffness_factor.empty() ? 1 : mesh_.stiffness_factor[e];
  p.section.fibres.count = 0;
  for (const std::vector<Vec3>* fibres : {&mesh_.fibre1, &mesh_.fibre2}) {
    if (fibres->empty()) continue;
    const Eigen::Vector2d in_plane((*fibres)[e].dot(e1), (*fibres)[e].dot(e2));
    if (!(in_plane.norm() > 0.1))
      throw InputError("shell: fibre of triangle {} does not lie in it; expected a unit tangent vector", e);
    p.section.fibres.direction[p.section.fibres.count++] = in_plane.normalized();
  }
  try {
    section_->check(p.section);
  } catch (const InputError& error) {
    throw InputError("shell: triangle {} (nodes {}, {}, {}): {}", e, t[0], t[1], t[2], error.what());
  }
  return p;
}

double SubdivisionShell::reference_area(int e) const {
  double area = 0;
  for (int q = elements_[e].point; q < elements_[e + 1].point; ++q) area += points_[q].area;
  return area;
}

double SubdivisionShell::thickness(int e) const {
  const Triangle& t = mesh_.triangles[e];
  return (mesh_.thickness_mm[t[0]] + mesh_.thickness_mm[t[1]] + mesh_.thickness_mm[t[2]]) / 3;
}

std::vector<double> SubdivisionShell::lumped_area() const {
  std::vector<double> area(nodes(), 0.0);
  for (int e = 0; e < elements(); ++e)
    for (int a : mesh_.triangles[e]) area[a] += reference_area(e) / 3;
  return area;
}

std::vector<double> SubdivisionShell::lumped_mass(double density_g_per_mm3) const {
  std::vector<double> mass(nodes(), 0.0);
  for (int e = 0; e < elements(); ++e) {
    double volume = 0;
    for (int q = elements_[e].point; q < elements_[e + 1].point; ++q)
      volume += points_[q].area * points_[q].section.thickness;
    for (int a : mesh_.triangles[e]) mass[a] += density_g_per_mm3 * volume / 3;
  }
  return mass;
}

SubdivisionShell::Quadrature SubdivisionShell::quadrature_point(int q) const {
  const auto after = std::upper_bound(elements_.begin(), elements_.end(), q,
                                      [](int point, const Element& e) { return point < e.point; });
  const int e = static_cast<int>(after - elements_.begin()) - 1;
  return {{vertices_.data() + elements_[e].vertex, static_cast<std::size_t>(vertices_of(e))},
          basis_.data() + points_[q].basis,
          points_[q].area,
          points_[q].parameter};
}

SubdivisionShell::Jet SubdivisionShell::jet(const Points& vertices, int e, const Point& p) const {
  Jet j = Jet::Zero();
  const double* basis = basis_.data() + p.basis;
  const int* v = vertices_.data() + elements_[e].vertex;
  for (int a = 0, n = vertices_of(e); a < n; ++a, basis += 6) {
    const Vec3& x = vertices[v[a]];
    for (int d = 0; d < 5; ++d) j.col(d) += basis[1 + d] * x;
  }
  return j;
}

SubdivisionShell::Response SubdivisionShell::respond(const Point& p, const Jet& j) const {
  const Surface s(j);
  const SectionResponse section = section_->respond(p.section, p.map.transpose() * s.metric * p.map,
                                                    p.map.transpose() * s.curvature() * p.map, false);
  const Matrix2d n = p.area * p.map * section.force * p.map.transpose();
  const Matrix2d m = p.area * p.map * section.moment * p.map.transpose();
  Response r;
  r.m11 = m(0, 0), r.m22 = m(1, 1), r.m12 = m(0, 1);
  r.n = s.n;
  const auto turned = [&](int c) {
    return r.m11 * s.gamma[c][0] + r.m22 * s.gamma[c][1] + 2 * r.m12 * s.gamma[c][2];
  };
  r.p1 = n(0, 0) * s.a1 + n(0, 1) * s.a2 - turned(0) * s.n;
  r.p2 = n(1, 0) * s.a1 + n(1, 1) * s.a2 - turned(1) * s.n;
  r.energy = p.area * section.energy;
  r.exponent = section.exponent;
  return r;
}

double SubdivisionShell::element_forces(const Points& vertices, int e, Vec3* force) const {
  const int n = vertices_of(e);
  for (int a = 0; a < n; ++a) force[a].setZero();
  double energy = 0;
  for (int q = elements_[e].point; q < elements_[e + 1].point; ++q) {
    const Point& p = points_[q];
    const Response r = respond(p, jet(vertices, e, p));
    const double* basis = basis_.data() + p.basis;
    for (int a = 0; a < n; ++a, basis += 6)
      force[a] -= basis[1] * r.p1 + basis[2] * r.p2 +
                  (basis[3] * r.m11 + basis[4] * r.m22 + 2 * basis[5] * r.m12) * r.n;
    energy += r.energy;
  }
  return energy;
}

double SubdivisionShell::add_forces(const Points& x, Points& f, int offset, Part part,
                                    std::span<const Mat3> clamps) const {
  const Range own = share(elements(), part);
  thread_local Points vertex_storage, force_storage, slot_storage;
  thread_local std::vector<double> energy_storage;
  Points &vertices = vertex_storage, &forces = force_storage, &slots = slot_storage;
  std::vector<double>& energies = energy_storage;
  surface_.gather(x, offset, vertices, clamps);
  forces.assign(surface_.vertices(), Vec3::Zero());
  const int first = elements_[own.begin].vertex;
  double energy = 0;
  if (omp_get_max_threads() == 1 || omp_in_parallel() || own.end - own.begin < 200) {
    for (int e = own.begin; e < own.end; ++e) {
      slots.resize(std::max<std::size_t>(slots.size(), vertices_of(e)));
      energy += element_forces(vertices, e, slots.data());
      for (int a = 0; a < vertices_of(e); ++a) forces[vertices_[elements_[e].vertex + a]] += slots[a];
    }
  } else {
    // Threads fill slots; every vertex adds up its own in the order of the elements, as the loop above does.
    slots.resize(std::max<std::size_t>(slots.size(), elements_[own.end].vertex - first));
    energies.resize(own.end - own.begin);
    int failed = own.end;
    std::exception_ptr failure;
#pragma omp parallel
    {
#pragma omp for schedule(static)
      for (int e = own.begin; e < own.end; ++e) try {
          energies[e - own.begin] = element_forces(vertices, e, slots.data() + elements_[e].vertex - first);
        } catch (...) {
#pragma omp critical(subdivision_shell)
          if (e < failed) {
            failed = e;
            failure = std::current_exception();
          }
        }
#pragma omp for schedule(static)
      for (int v = 0; v < surface_.vertices(); ++v)
        for (int i = gather_[v][0]; i < gather_[v][1]; ++i) {
          const int slot = gather_slots_[i];
          if (slot >= first && slot < elements_[own.end].vertex) forces[v] += slots[slot - first];
        }
    }
    if (failure) std::rethrow_exception(failure);
    for (double part_energy : energies) energy += part_energy;
  }
  surface_.scatter(forces, f, offset);
  return energy;
}

SubdivisionShell::Hessian SubdivisionShell::hessian(const Point& p, const Jet& j, bool positive) const {
  const Surface s(j);
  const SectionResponse section = section_->respond(p.section, p.map.transpose() * s.metric * p.map,
                                                    p.map.transpose() * s.curvature() * p.map, true);
  Section6 tangent = section.tangent;
  Matrix2d force = section.force;
  if (positive) {
    const Eigen::LDLT<Section6> factors(tangent);
    if (factors.vectorD().minCoeff() < 0) {
      const Eigen::SelfAdjointEigenSolver<Section6> eigen(tangent);
      tangent = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
                eigen.eigenvectors().transpose();
    }
    Eigen::SelfAdjointEigenSolver<Matrix2d> eigen;
    eigen.computeDirect(force);
    force = (eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() *
             eigen.eigenvectors().transpose())
                .eval();
  }
  // Strains (11, 22, 2 12) and curvatures (11, 22, 2 12) of the parameters by the jet.
  Eigen::Matrix<double, 6, 15> strain = Eigen::Matrix<double, 6, 15>::Zero();
  strain.block<1, 3>(0, 0) = s.a1.transpose();
  strain.block<1, 3>(1, 3) = s.a2.transpose();
  strain.block<1, 3>(2, 0) = s.a2.transpose();
  strain.block<1, 3>(2, 3) = s.a1.transpose();
  for (int i = 0; i < 3; ++i) {
    const double twice = i == 2 ? 2 : 1;
    strain.block<1, 3>(3 + i, 6 + 3 * i) = twice * s.n.transpose();
    for (int c = 0; c < 2; ++c) strain.block<1, 3>(3 + i, 3 * c) = -twice * s.gamma[c][i] * s.n.transpose();
  }
  Section6 turn = Section6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = to_basis(p.map);
  const Eigen::Matrix<double, 6, 15> in_basis = turn * strain;
  Hessian h = p.area * in_basis.transpose() * tangent * in_basis;
  const Matrix2d n = p.area * p.map * force * p.map.transpose();
  for (int c = 0; c < 2; ++c)
    for (int d = 0; d < 2; ++d) h.block<3, 3>(3 * c, 3 * d).diagonal().array() += n(c, d);
  if (positive) return h;
  const Matrix2d moment = p.area * p.map * section.moment * p.map.transpose();
  const std::array<double, 3> m{moment(0, 0), moment(1, 1), 2 * moment(0, 1)};
  double bent = 0;               // m : b
  Eigen::Vector2d turned(0, 0);  // m : G^c
  for (int i = 0; i < 3; ++i) {
    bent += m[i] * s.b[i];
    for (int c = 0; c < 2; ++c) turned[c] += m[i] * s.gamma[c][i];
  }
  const std::array<Vec3, 2> dual{s.dual1, s.dual2};
  for (int c = 0; c < 2; ++c) {
    for (int d = 0; d < 2; ++d)
      h.block<3, 3>(3 * c, 3 * d) += turned[c] * dual[d] * s.n.transpose() +
                                     turned[d] * s.n * dual[c].transpose() -
                                     s.inverse(c, d) * bent * s.n * s.n.transpose();
    for (int i = 0; i < 3; ++i) {
      const Mat3 pull = -m[i] * s.n * dual[c].transpose();
      h.block<3, 3>(3 * c, 6 + 3 * i) += pull;
      h.block<3, 3>(6 + 3 * i, 3 * c) += pull.transpose();
    }
  }
  return h;
}

double SubdivisionShell::max_exponent(const Points& x, int offset) const {
  Points vertices;
  surface_.gather(x, offset, vertices);
  double largest = 0;
  for (int e = 0; e < elements(); ++e)
    for (int q = elements_[e].point; q < elements_[e + 1].point; ++q)
      largest = std::max(largest, respond(points_[q], jet(vertices, e, points_[q])).exponent);
  return largest;
}

}  // namespace valsalva::structure
