#include "structure/shell.hpp"

#include <omp.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.hpp"
#include "structure/share.hpp"
#include "structure/shell_kinematics.hpp"

namespace valsalva::structure {
namespace {

int groups_of(int count) {
  return (count + lanes - 1) / lanes;
}

Lanes dot(const LaneVector& a, const LaneVector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

LaneVector cross(const LaneVector& a, const LaneVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

LaneVector difference(const LaneVector& a, const LaneVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
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
  build_groups();
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

void Shell::build_groups() {
  const auto each = [](int count, auto&& action) {
    for (int i = 0; i < groups_of(count) * lanes; ++i) action(i / lanes, i % lanes, std::min(i, count - 1));
  };
  element_groups_.resize(groups_of(elements()));
  each(elements(), [&](int g, int l, int e) {
    const Element& element = elements_[e];
    ElementGroup& group = element_groups_[g];
    for (int r = 0; r < 2; ++r)
      for (int c = 0; c < 2; ++c) {
        group.inverse_edges[r][c][l] = element.inverse_edges(r, c);
        group.fibre[r][c][l] = element.fibres.direction[r][c];
      }
    group.volume[l] = element.thickness * element.area;
    group.factor[l] = element.factor;
  });
  hinge_groups_.resize(groups_of(hinges()));
  each(hinges(), [&](int g, int l, int h) {
    hinge_groups_[g].rest_angle[l] = hinges_[h].rest_angle;
    hinge_groups_[g].stiffness[l] = hinges_[h].stiffness;
  });
}

void Shell::element_forces(const Points& x, int offset, int g, GroupForces& out) const {
  const ElementGroup& group = element_groups_[g];
  LaneVector edge1, edge2;
  for (int l = 0; l < lanes; ++l) {
    const Triangle& t = mesh_.triangles[std::min(g * lanes + l, elements() - 1)];
    const Vec3 &x0 = x[offset + t[0]], &x1 = x[offset + t[1]], &x2 = x[offset + t[2]];
    for (int d = 0; d < 3; ++d) {
      edge1[d][l] = x1[d] - x0[d];
      edge2[d][l] = x2[d] - x0[d];
    }
  }
  const auto& m = group.inverse_edges;
  LaneVector f1, f2;  // columns of the deformation gradient
  for (int d = 0; d < 3; ++d) {
    f1[d] = edge1[d] * m[0][0] + edge2[d] * m[1][0];
    f2[d] = edge1[d] * m[0][1] + edge2[d] * m[1][1];
  }
  const materials::PlaneStressLanes s = law_->plane_stress_lanes({.c11 = dot(f1, f1),
                                                                  .c22 = dot(f2, f2),
                                                                  .c12 = dot(f1, f2),
                                                                  .factor = group.factor,
                                                                  .families = elements_.front().fibres.count,
                                                                  .fibre = group.fibre});
  for (int d = 0; d < 3; ++d) {
    const Lanes p1 = -group.volume * (f1[d] * s.s11 + f2[d] * s.s12),
                p2 = -group.volume * (f1[d] * s.s12 + f2[d] * s.s22);
    out.force[1][d] = p1 * m[0][0] + p2 * m[0][1];
    out.force[2][d] = p1 * m[1][0] + p2 * m[1][1];
    out.force[0][d] = -(out.force[1][d] + out.force[2][d]);
  }
  out.energy = group.volume * s.energy;
  out.exponent = s.exponent;
}

double Shell::hinge_angle(const Points& x, int h, int offset) const {
  const auto& n = hinges_[h].nodes;
  const Vec3 &x0 = x[offset + n[0]], &x1 = x[offset + n[1]], &x2 = x[offset + n[2]], &x3 = x[offset + n[3]];
  return angle_of((x1 - x0).cross(x2 - x0), (x3 - x0).cross(x1 - x0), x1 - x0);
}

void Shell::hinge_forces(const Points& x, int offset, int g, GroupForces& out) const {
  std::array<LaneVector, 4> at;
  for (int l = 0; l < lanes; ++l) {
    const auto& nodes = hinges_[std::min(g * lanes + l, hinges() - 1)].nodes;
    for (int k = 0; k < 4; ++k)
      for (int d = 0; d < 3; ++d) at[k][d][l] = x[offset + nodes[k]][d];
  }
  hinge_forces(at, hinge_groups_[g], out);
}

// hinge_geometry above, eight times.
void Shell::hinge_forces(const std::array<LaneVector, 4>& at, const HingeGroup& group,
                         GroupForces& out) const {
  const LaneVector edge = difference(at[1], at[0]);
  const LaneVector to2 = difference(at[2], at[0]), to3 = difference(at[3], at[0]);
  const LaneVector normal1 = cross(edge, to2), normal2 = cross(to3, edge);
  const Lanes length = dot(edge, edge).sqrt(), per_length = length.inverse();
  const Lanes sine = dot(cross(normal1, normal2), edge) * per_length, cosine = dot(normal1, normal2);
  Lanes bend = materials::angle_of(sine, cosine) - group.rest_angle;  // brought to (-pi, pi]
  bend -=
      (bend > M_PI).select(Lanes::Constant(2 * M_PI), (bend < -M_PI).select(Lanes::Constant(-2 * M_PI), 0.0));
  const Lanes moment = group.stiffness * bend;
  const Lanes on1 = moment / dot(normal1, normal1).max(1e-20),
              on2 = moment / dot(normal2, normal2).max(1e-20);
  const Lanes along2 = dot(to2, edge) * per_length, along3 = dot(to3, edge) * per_length;
  for (int d = 0; d < 3; ++d) {
    const Lanes u1 = on1 * normal1[d], u2 = on2 * normal2[d];
    out.force[2][d] = length * u1;
    out.force[3][d] = length * u2;
    out.force[0][d] = (along2 - length) * u1 + (along3 - length) * u2;
    out.force[1][d] = -along2 * u1 - along3 * u2;
  }
  out.energy = 0.5 * moment * bend;
}

double Shell::add_forces(const Points& x, Points& f, int offset, Part part, double* largest_exponent) const {
  const Range own_elements = share(elements(), part), own_hinges = share(hinges(), part);
  double energy = 0, exponent = 0;
  const auto add = [&](const Range& own, int group, const GroupForces& g, const auto& nodes_of) {
    const int end = std::min(own.end, (group + 1) * lanes);
    for (int i = std::max(own.begin, group * lanes); i < end; ++i) {
      const auto& nodes = nodes_of(i);
      for (std::size_t k = 0; k < nodes.size(); ++k)
        for (int d = 0; d < 3; ++d) f[offset + nodes[k]][d] += g.force[k][d][i % lanes];
      energy += g.energy[i % lanes];
    }
  };
  const auto add_elements = [&](int group, const GroupForces& g) {
    add(own_elements, group, g, [&](int e) -> const Triangle& { return mesh_.triangles[e]; });
    const int end = std::min(own_elements.end, (group + 1) * lanes);
    for (int e = std::max(own_elements.begin, group * lanes); e < end; ++e)
      exponent = std::max(exponent, g.exponent[e % lanes]);
  };
  const auto add_hinges = [&](int group, const GroupForces& g) {
    add(own_hinges, group, g, [&](int h) -> const std::array<int, 4>& { return hinges_[h].nodes; });
  };
  const Range element_range{own_elements.begin / lanes, groups_of(own_elements.end)};
  const Range hinge_range{own_hinges.begin / lanes, groups_of(own_hinges.end)};
  const int work = element_range.end - element_range.begin;
  if (omp_get_max_threads() == 1 || omp_in_parallel() || own_elements.end - own_elements.begin < 500) {
    GroupForces g;
    for (int e = element_range.begin; e < element_range.end; ++e) {
      element_forces(x, offset, e, g);
      add_elements(e, g);
    }
    for (int h = hinge_range.begin; h < hinge_range.end; ++h) {
      hinge_forces(x, offset, h, g);
      add_hinges(h, g);
    }
  } else {
    // Threads fill slots; one thread adds them up in the order of the loops above, so the bits are the same.
    thread_local std::vector<GroupForces> storage;
    std::vector<GroupForces>& slots = storage;  // the calling thread's own, seen by the team
    slots.resize(work + hinge_range.end - hinge_range.begin);
    const int total = static_cast<int>(slots.size());
#pragma omp parallel for schedule(static)
    for (int i = 0; i < total; ++i) {
      if (i < work)
        element_forces(x, offset, element_range.begin + i, slots[i]);
      else
        hinge_forces(x, offset, hinge_range.begin + i - work, slots[i]);
    }
    for (int i = 0; i < work; ++i) add_elements(element_range.begin + i, slots[i]);
    for (int i = work; i < total; ++i) add_hinges(hinge_range.begin + i - work, slots[i]);
  }
  if (largest_exponent) *largest_exponent = exponent;
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

}  // namespace valsalva::structure
