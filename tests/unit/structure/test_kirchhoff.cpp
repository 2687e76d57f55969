#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/errors.hpp"
#include "materials/hgo.hpp"
#include "meshes.hpp"
#include "shell_meshes.hpp"
#include "structure/kirchhoff_loads.hpp"

using namespace valsalva;
using namespace valsalva::structure;
using test::Pattern;

namespace {

enum class Section { koiter, laws };

// A curved patch with thickness, fibres and stiffness that vary, every kind of border, irregular nodes.
struct Rich {
  std::shared_ptr<KirchhoffShell> shell;
  Points x;  // deformed

  explicit Rich(Section section, Pattern pattern = Pattern::unstructured) {
    const test::SheetMesh sheet = test::sheet(4, 3, 5, 4, pattern, 3);
    ShellMesh mesh = test::shell_mesh(
        sheet,
        test::mapped(sheet,
                     [](double u, double v) { return Vec3(u, v, 0.06 * u * u - 0.02 * (v - 3) * (v - 3)); }),
        0.4);
    for (std::size_t a = 0; a < mesh.reference.size(); ++a)
      mesh.thickness_mm[a] = 0.3 + 0.05 * mesh.reference[a].x();
    for (std::size_t e = 0; e < mesh.triangles.size(); ++e) {
      const Triangle& t = mesh.triangles[e];
      const Vec3 u = (mesh.reference[t[1]] - mesh.reference[t[0]]).normalized();
      const Vec3 n = u.cross(mesh.reference[t[2]] - mesh.reference[t[0]]).normalized();
      const Vec3 w = n.cross(u);
      mesh.fibre1.push_back(std::cos(0.5) * u + std::sin(0.5) * w);
      mesh.fibre2.push_back(std::cos(0.5) * u - std::sin(0.5) * w);
      mesh.stiffness_factor.push_back(e % 2 ? 1 : 5);
    }
    EdgeConditions conditions;
    for (const Edge& e : test::border_edges(sheet, [](double u, double) { return u == 0; }))
      conditions[e] = {EdgeSupport::clamped, Vec3::Zero(), 0};
    for (const Edge& e : test::border_edges(sheet, [](double, double v) { return v == 3; }))
      conditions[e] = {EdgeSupport::symmetry, Vec3(0, 1, 0), 0};
    const auto model =
        section == Section::koiter
            ? koiter_section(1e6, 0.3, {0.8, 1.2})
            : law_section(std::make_shared<materials::Hgo>(materials::native_leaflet_healthy), 3, {0.8, 1.2});
    shell = std::make_shared<KirchhoffShell>(mesh, model, conditions);
    x = shaken(shell->mesh().reference, 0.06, 1);
  }
};

double energy_of(const KirchhoffShell& shell, const Points& x) {
  Points f(x.size(), Vec3::Zero());
  return shell.add_forces(x, f);
}

Points forces_of(const KirchhoffShell& shell, const Points& x) {
  Points f(x.size(), Vec3::Zero());
  shell.add_forces(x, f);
  return f;
}

Points along(Points x, const Points& direction, double h) {
  for (std::size_t a = 0; a < x.size(); ++a) x[a] += h * direction[a];
  return x;
}

}  // namespace

TEST(KirchhoffShell, ForceIsTheGradientOfTheEnergyToSecondOrder) {
  for (Section section : {Section::koiter, Section::laws}) {
    const Rich rich(section);
    const Points direction = shaken(Points(rich.x.size(), Vec3::Zero()), 1, 2);
    const Points f = forces_of(*rich.shell, rich.x);
    double exact = 0;
    for (std::size_t a = 0; a < f.size(); ++a) exact -= f[a].dot(direction[a]);
    const auto error = [&](double h) {
      return std::abs((energy_of(*rich.shell, along(rich.x, direction, h)) -
                       energy_of(*rich.shell, along(rich.x, direction, -h))) /
                          (2 * h) -
                      exact);
    };
    const double coarse = error(4e-4), fine = error(2e-4);
    EXPECT_LT(fine, 1e-3 * std::abs(exact));
    EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
  }
}

TEST(KirchhoffShell, TangentIsTheGradientOfTheForceToSecondOrder) {
  for (Section section : {Section::koiter, Section::laws}) {
    const Rich rich(section);
    const Points direction = shaken(Points(rich.x.size(), Vec3::Zero()), 1, 3);
    BlockMatrix k(rich.x.size(), 0);
    rich.shell->add_tangent(rich.x, k);
    Eigen::VectorXd d(3 * rich.x.size());
    for (std::size_t a = 0; a < rich.x.size(); ++a) d.segment<3>(3 * a) = direction[a];
    const Eigen::VectorXd exact = k.times(d);
    const auto error = [&](double h) {
      const Points up = forces_of(*rich.shell, along(rich.x, direction, h));
      const Points down = forces_of(*rich.shell, along(rich.x, direction, -h));
      double total = 0;
      for (std::size_t a = 0; a < up.size(); ++a)
        total += ((down[a] - up[a]) / (2 * h) - exact.segment<3>(3 * a)).squaredNorm();
      return std::sqrt(total);
    };
    const double coarse = error(4e-4), fine = error(2e-4);
    EXPECT_LT(fine, 1e-3 * exact.norm());
    EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
  }
}
