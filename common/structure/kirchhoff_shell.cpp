#include "structure/kirchhoff_shell.hpp"

#include <omp.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <exception>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

using Eigen::Matrix2d;

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

}  // namespace

KirchhoffShell::KirchhoffShell(ShellMesh mesh, std::shared_ptr<const SectionModel> section,
                               const EdgeConditions& conditions)
    : mesh_((check(mesh), std::move(mesh))),
      section_(std::move(section)),
      edges_(mesh_.reference, mesh_.triangles, conditions) {
  VALSALVA_ASSERT(section_);
  build_elements();
}

void KirchhoffShell::build_elements() {
  const Points& x = mesh_.reference;
  Points vertices;
  edges_.gather(x, 0, vertices);
  elements_.resize(mesh_.triangles.size());
  for (int i = 0; i < elements(); ++i) {
    const Triangle& t = mesh_.triangles[i];
    const Vec3 edge1 = x[t[1]] - x[t[0]], edge2 = x[t[2]] - x[t[0]];
    const Vec3 normal = edge1.cross(edge2);
    const double longest =
        std::max({edge1.squaredNorm(), edge2.squaredNorm(), (edge2 - edge1).squaredNorm()});
    if (!(normal.norm() > 1e-6 * longest))
      throw InputError("shell: triangle {} (nodes {}, {}, {}) has no area in the reference shape; remesh it",
                       i, t[0], t[1], t[2]);
    Element& e = elements_[i];
    e.area = 0.5 * normal.norm();
    const Vec3 n = normal.normalized(), e1 = edge1.normalized(), e2 = n.cross(e1);
    for (int k = 0; k < 3; ++k) {
      const ShellEdge& edge = edges_.edge(edges_.of_triangle(i)[k]);
      e.vertices[k] = t[k];
      e.vertices[3 + k] = nodes() + edges_.of_triangle(i)[k];
      const Vec3 side = x[t[(k + 1) % 3]] - x[t[k]], out = side.cross(n);  // as long as the side
      const Eigen::Vector2d outward(out.dot(e1), out.dot(e2));
      e.gradients.col((k + 2) % 3) = -outward / (2 * e.area);
      const double share = (edge.triangles[0] == i ? 1 : -1) / (e.area * side.norm());
      e.bends.col(k) =
          share * Vec3(outward[0] * outward[0], outward[1] * outward[1], outward[0] * outward[1]);
    }
    const Surface surface(jet(vertices, e));
    e.section.curvature = surface.curvature();
    build_section(i, e1, e2);
  }
}

void KirchhoffShell::build_section(int i, const Vec3& e1, const Vec3& e2) {
  const Triangle& t = mesh_.triangles[i];
  SectionPoint& section = elements_[i].section;
  section.thickness = (mesh_.thickness_mm[t[0]] + mesh_.thickness_mm[t[1]] + mesh_.thickness_mm[t[2]]) / 3;
  section.factor = mesh_.stiffness_factor.empty() ? 1 : mesh_.stiffness_factor[i];
  for (const std::vector<Vec3>* fibres : {&mesh_.fibre1, &mesh_.fibre2}) {
    if (fibres->empty()) continue;
    const Eigen::Vector2d in_plane((*fibres)[i].dot(e1), (*fibres)[i].dot(e2));
    if (!(in_plane.norm() > 0.1))
      throw InputError("shell: fibre of triangle {} does not lie in it; expected a unit tangent vector", i);
    section.fibres.direction[section.fibres.count++] = in_plane.normalized();
  }
  try {
    section_->check(section);
  } catch (const InputError& error) {
    throw InputError("shell: triangle {} (nodes {}, {}, {}): {}", i, t[0], t[1], t[2], error.what());
  }
}

std::vector<double> KirchhoffShell::lumped_area() const {
  std::vector<double> area(nodes(), 0.0);
  for (int i = 0; i < elements(); ++i)
    for (int a : mesh_.triangles[i]) area[a] += elements_[i].area / 3;
  return area;
}

std::vector<double> KirchhoffShell::lumped_mass(double density_g_per_mm3) const {
  std::vector<double> mass(nodes(), 0.0);
  for (int i = 0; i < elements(); ++i)
    for (int a : mesh_.triangles[i]) mass[a] += density_g_per_mm3 * thickness(i) * elements_[i].area / 3;
  return mass;
}

KirchhoffShell::Jet KirchhoffShell::jet(const Points& vertices, const Element& e) const {
  Jet j = Jet::Zero();
  for (int k = 0; k < 3; ++k) {
    j.leftCols<2>() += vertices[e.vertices[k]] * e.gradients.col(k).transpose();
    j.rightCols<3>() += vertices[e.vertices[3 + k]] * e.bends.col(k).transpose();
  }
  return j;
}

SectionResponse KirchhoffShell::respond(const Element& e, const Jet& j, bool tangent) const {
  const Surface s(j);
  return section_->respond(e.section, s.metric, s.curvature(), tangent);
}

double KirchhoffShell::element_forces(const Points& vertices, const Element& e, Vec3* force) const {
  const Jet j = jet(vertices, e);
  const Surface s(j);
  const SectionResponse section = section_->respond(e.section, s.metric, s.curvature(), false);
  const Matrix2d n = -e.area * section.force;
  const Vec3 m = -e.area * Vec3(section.moment(0, 0), section.moment(1, 1), 2 * section.moment(0, 1));
  const auto turned = [&](int c) {
    return m[0] * s.gamma[c][0] + m[1] * s.gamma[c][1] + m[2] * s.gamma[c][2];
  };
  const Vec3 p1 = n(0, 0) * s.a1 + n(0, 1) * s.a2 - turned(0) * s.n;
  const Vec3 p2 = n(1, 0) * s.a1 + n(1, 1) * s.a2 - turned(1) * s.n;
  for (int k = 0; k < 3; ++k) {
    force[k] = e.gradients(0, k) * p1 + e.gradients(1, k) * p2;
    force[3 + k] = m.dot(e.bends.col(k)) * s.n;
  }
  return e.area * section.energy;
}

double KirchhoffShell::add_forces(const Points& x, Points& f, int offset, Part part,
                                  std::span<const Mat3> clamps) const {
  const Range own = share(elements(), part);
  thread_local Points vertex_storage, force_storage, slot_storage;
  thread_local std::vector<double> energy_storage;
  Points &vertices = vertex_storage, &forces = force_storage, &slots = slot_storage;
  std::vector<double>& energies = energy_storage;
  edges_.gather(x, offset, vertices, clamps);
  forces.assign(edges_.vertices(), Vec3::Zero());
  double energy = 0;
  const auto add = [&](int i, const Vec3* force) {
    for (int k = 0; k < 6; ++k) forces[elements_[i].vertices[k]] += force[k];
  };
  if (omp_get_max_threads() == 1 || omp_in_parallel() || own.end - own.begin < 500) {
    for (int i = own.begin; i < own.end; ++i) {
      std::array<Vec3, 6> force;
      energy += element_forces(vertices, elements_[i], force.data());
      add(i, force.data());
    }
  } else {
    // Threads fill slots; one thread adds them up in the order of the loop above, so the bits are the same.
    slots.resize(6 * static_cast<std::size_t>(own.end - own.begin));
    energies.resize(own.end - own.begin);
    int failed = own.end;
    std::exception_ptr failure;
#pragma omp parallel for schedule(static)
    for (int i = own.begin; i < own.end; ++i) try {
        energies[i - own.begin] = element_forces(vertices, elements_[i],
                                                 slots.data() + 6 * static_cast<std::size_t>(i - own.begin));
      } catch (...) {
#pragma omp critical(kirchhoff_shell)
        if (i < failed) {
          failed = i;
          failure = std::current_exception();
        }
      }
    if (failure) std::rethrow_exception(failure);
    for (int i = own.begin; i < own.end; ++i) {
      energy += energies[i - own.begin];
      add(i, slots.data() + 6 * static_cast<std::size_t>(i - own.begin));
    }
  }
  edges_.scatter(forces, f, offset);
  return energy;
}

KirchhoffShell::Hessian KirchhoffShell::hessian(const Element& e, const Jet& j, bool positive) const {
  const Surface s(j);
  const SectionResponse section = respond(e, j, true);
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
  Hessian h = e.area * strain.transpose() * tangent * strain;
  const Matrix2d n = e.area * force;
  for (int c = 0; c < 2; ++c)
    for (int d = 0; d < 2; ++d) h.block<3, 3>(3 * c, 3 * d).diagonal().array() += n(c, d);
  if (positive) return h;
  const Matrix2d moment = e.area * section.moment;
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

}  // namespace valsalva::structure
