// Linear statics of one Kirchhoff-Love shell: K u = f at the reference.
#pragma once

#include <cstdio>

#include "shell_meshes.hpp"
#include "solve/linear_solver.hpp"
#include "structure/kirchhoff_loads.hpp"

namespace valsalva {

struct LinearShell {
  std::shared_ptr<structure::KirchhoffShell> shell;
  Points load;
  std::vector<std::uint8_t> fixed;

  LinearShell(const structure::ShellMesh& mesh, std::shared_ptr<const structure::SectionModel> section,
              const structure::EdgeConditions& conditions)
      : shell(std::make_shared<structure::KirchhoffShell>(mesh, std::move(section), conditions)),
        load(mesh.reference.size(), Vec3::Zero()),
        fixed(3 * mesh.reference.size(), 0) {}

  /// Holds components (a string of x, y, z) of the nodes whose given position satisfies the condition.
  template <class Where>
  void hold(const char* components, const Where& where) {
    const Points& x = shell->mesh().reference;
    for (std::size_t a = 0; a < x.size(); ++a)
      if (where(x[a]))
        for (const char* c = components; *c; ++c) fixed[3 * a + (*c - 'x')] = 1;
  }

  /// A traction on the area: a third of each triangle's to each node.
  template <class Traction>
  void add_area_load(const Traction& traction) {
    const Points& x = shell->mesh().reference;
    for (int e = 0; e < shell->elements(); ++e) {
      const Triangle& t = shell->mesh().triangles[e];
      for (int k = 0; k < 3; ++k)
        load[t[k]] += shell->reference_area(e) / 3 * traction((x[t[0]] + x[t[1]] + x[t[2]]) / 3);
    }
  }

  Points solve() const {
    const Points& x = shell->mesh().reference;
    structure::BlockMatrix k(x.size(), 0);
    shell->add_tangent(x, k);
    Eigen::VectorXd rhs(3 * x.size()), u = Eigen::VectorXd::Zero(3 * x.size());
    for (std::size_t a = 0; a < x.size(); ++a) rhs.segment<3>(3 * a) = load[a];
    solve::LinearSolver solver({solve::LinearMethod::direct});
    solver.solve(k, fixed, rhs, u, x);
    Points displacement(x.size());
    for (std::size_t a = 0; a < x.size(); ++a) displacement[a] = u.segment<3>(3 * a);
    return displacement;
  }
};

/// Root mean square over the nodes, weighted by area, of u - exact, over that of exact.
template <class Exact>
double relative_error(const LinearShell& scene, const Points& u, const Exact& exact) {
  const std::vector<double> area = scene.shell->lumped_area();
  const Points& x = scene.shell->mesh().reference;
  double error = 0, size = 0;
  for (std::size_t a = 0; a < x.size(); ++a) {
    const Vec3 e = exact(x[a]);
    error += area[a] * (u[a] - e).squaredNorm();
    size += area[a] * e.squaredNorm();
  }
  return std::sqrt(error / size);
}

}  // namespace valsalva
