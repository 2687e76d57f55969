#include "structure/kirchhoff_shell.hpp"

#include <omp.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <exception>

#include "core/errors.hpp"
#include "structure/kirchhoff_element.hpp"
#include "structure/share.hpp"

namespace valsalva::structure {
namespace {

using Eigen::Matrix2d;

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
    e.edges = edges_.of_triangle(i);
    e.area = 0.5 * normal.norm();
    const Vec3 n = normal.normalized(), e1 = edge1.normalized(), e2 = n.cross(e1);
    for (int k = 0; k < 3; ++k) {
      const ShellEdge& edge = edges_.edge(e.edges[k]);
      const Vec3 side = x[t[(k + 1) % 3]] - x[t[k]], out = side.cross(n);  // as long as the side
      const Eigen::Vector2d outward(out.dot(e1), out.dot(e2));
      e.gradients.col((k + 2) % 3) = -outward / (2 * e.area);
      const double share = (edge.triangles[0] == i ? 1 : -1) / (e.area * side.norm());
      e.bends.col(k) =
          share * Vec3(outward[0] * outward[0], outward[1] * outward[1], outward[0] * outward[1]);
      const double way = (edge.triangles[0] == i ? 1 : -1) / side.norm();
      e.samples[k] = {{way * side.dot(e1), way * side.dot(e2)}, Eigen::Vector3d::Zero()};
      e.sampled[k] = edges_.trust(e.edges[k]) * e.area / 3;
    }
    const Jet j = jet(vertices, i);
    const Bending bending(e, j, Surface(j).n);
    e.section.curvature = bending.curvature();
    for (int k = 0; k < 3; ++k) e.samples[k].rest = bending.variation[k];
    build_section(i, e1, e2);
    e.rigidity = section_->respond(e.section, Matrix2d::Identity(), e.section.curvature, true)
                     .tangent.bottomRightCorner<3, 3>();
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

KirchhoffShell::Jet KirchhoffShell::jet(const Points& vertices, int i) const {
  const Element& e = elements_[i];
  Jet j;
  j.leftCols<2>().setZero();
  for (int k = 0; k < 3; ++k) {
    j.leftCols<2>() += vertices[mesh_.triangles[i][k]] * e.gradients.col(k).transpose();
    for (int v = 0; v < ShellEdges::vectors; ++v)
      j.col(2 + ShellEdges::vectors * k + v) = vertices[edges_.vertex(e.edges[k]) + v];
  }
  return j;
}

KirchhoffShell::ElementForces KirchhoffShell::element_forces(const Points& vertices, int i) const {
  const Element& e = elements_[i];
  const Jet j = jet(vertices, i);
  const Surface s(j);
  const Bending bending(e, j, s.n);
  const SectionResponse section = section_->respond(e.section, s.metric, bending.curvature(), false);
  ElementForces out;
  out.energy = e.area * section.energy;
  const auto pull = bending.pull(e, section.moment, &out.energy);
  const Matrix2d n = -e.area * section.force;
  const Vec3 bent = j.rightCols<jets - 2>() * pull;  // sum of the vectors by their factors
  const Vec3 p1 = n(0, 0) * s.a1 + n(0, 1) * s.a2 + s.dual1.dot(bent) * s.n;
  const Vec3 p2 = n(1, 0) * s.a1 + n(1, 1) * s.a2 + s.dual2.dot(bent) * s.n;
  for (int k = 0; k < 3; ++k) {
    out.nodes[k] = e.gradients(0, k) * p1 + e.gradients(1, k) * p2;
    out.edges.col(k) = -pull.segment<ShellEdges::vectors>(ShellEdges::vectors * k);
  }
  out.normal = s.n;
  return out;
}

double KirchhoffShell::add_forces(const Points& x, Points& f, int offset, Part part,
                                  std::span<const Mat3> clamps) const {
  const Range own = share(elements(), part);
  thread_local Points vertex_storage, force_storage;
  thread_local std::vector<ElementForces> element_storage;
  Points &vertices = vertex_storage, &forces = force_storage;
  std::vector<ElementForces>& of = element_storage;
  edges_.gather(x, offset, vertices, clamps);
  forces.assign(edges_.vertices(), Vec3::Zero());
  double energy = 0;
  const auto add = [&](int i, const ElementForces& own_forces) {
    energy += own_forces.energy;
    for (int k = 0; k < 3; ++k) {
      forces[mesh_.triangles[i][k]] += own_forces.nodes[k];
      Vec3* edge = &forces[edges_.vertex(elements_[i].edges[k])];
      for (int v = 0; v < ShellEdges::vectors; ++v) edge[v] += own_forces.edges(v, k) * own_forces.normal;
    }
  };
  if (omp_get_max_threads() == 1 || omp_in_parallel() || own.end - own.begin < 500) {
    for (int i = own.begin; i < own.end; ++i) add(i, element_forces(vertices, i));
  } else {
    // Threads fill slots; one thread adds them up in the order of the loop above, so the bits are the same.
    of.resize(own.end - own.begin);
    int failed = own.end;
    std::exception_ptr failure;
#pragma omp parallel for schedule(static)
    for (int i = own.begin; i < own.end; ++i) try {
        of[i - own.begin] = element_forces(vertices, i);
      } catch (...) {
#pragma omp critical(kirchhoff_shell)
        if (i < failed) {
          failed = i;
          failure = std::current_exception();
        }
      }
    if (failure) std::rethrow_exception(failure);
    for (int i = own.begin; i < own.end; ++i) add(i, of[i - own.begin]);
  }
  edges_.scatter(forces, f, offset);
  return energy;
}

}  // namespace valsalva::structure
