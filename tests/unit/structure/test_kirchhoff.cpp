#include <gtest/gtest.h>

#include <omp.h>

#include <Eigen/Dense>

#include "core/errors.hpp"
#include "materials/hgo.hpp"
#include "materials/neo_hookean.hpp"
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

TEST(KirchhoffShell, BendingPatchTest) {
  // w = (x^2 + 3 x y - 2 y^2)/2 on an unstructured mesh: exact curvature everywhere, no force on inner nodes.
  const test::SheetMesh sheet = test::sheet(4, 3, 8, 6, Pattern::unstructured, 7);
  const KirchhoffShell shell(test::shell_mesh(sheet, sheet.plane, 0.1), koiter_section(1e6, 0.3));
  const double small = 1e-7;
  Points x = sheet.plane;
  for (Vec3& p : x) p.z() = small * 0.5 * (p.x() * p.x() + 3 * p.x() * p.y() - 2 * p.y() * p.y());
  const Eigen::Matrix2d exact = (Eigen::Matrix2d() << 1, 1.5, 1.5, -2).finished();
  for (int e = 0; e < shell.elements(); ++e) {
    const Triangle& t = sheet.triangles[e];
    const Vec3 e1 = (sheet.plane[t[1]] - sheet.plane[t[0]]).normalized();
    Eigen::Matrix2d turn;
    turn << e1.x(), -e1.y(), e1.y(), e1.x();
    EXPECT_LT((turn * shell.bending_strain(x, e) * turn.transpose() - small * exact).norm(), 1e-9 * small);
  }
  const Points f = forces_of(shell, x);
  double inner = 0, rim = 0;
  for (std::size_t a = 0; a < f.size(); ++a) {
    // Edge vectors reach two rows of nodes.
    const double depth = std::min({x[a].x(), 4 - x[a].x(), x[a].y(), 3 - x[a].y()});
    (depth > 1.4 ? inner : rim) = std::max(depth > 1.4 ? inner : rim, std::abs(f[a].z()));
  }
  EXPECT_GT(inner, 0);
  EXPECT_LT(inner, 1e-7 * rim);
}

TEST(KirchhoffShell, MembranePatchTest) {
  const test::SheetMesh sheet = test::sheet(4, 3, 8, 6, Pattern::unstructured, 9);
  const KirchhoffShell shell(test::shell_mesh(sheet, sheet.plane, 0.1),
                             law_section(std::make_shared<materials::Hgo>(materials::porcine_pericardium)));
  Points x = sheet.plane;
  for (Vec3& p : x) p = Vec3(1.1 * p.x() + 0.05 * p.y(), 0.95 * p.y(), 0.2 * p.x());
  const Points f = forces_of(shell, x);
  double inner = 0;
  for (std::size_t a = 0; a < f.size(); ++a) {
    const Vec3& p = sheet.plane[a];
    if (p.x() > 0 && p.x() < 4 && p.y() > 0 && p.y() < 3) inner = std::max(inner, f[a].norm());
  }
  EXPECT_LT(inner, 1e-10 * largest(f));
}

TEST(KirchhoffShell, RigidMotionCostsNothingAndForcesTurnWithTheBody) {
  for (Section section : {Section::koiter, Section::laws}) {
    const Rich rich(section);
    // Free of its symmetry plane, which does not turn.
    const KirchhoffShell shell(
        rich.shell->mesh(),
        section == Section::koiter
            ? koiter_section(1e6, 0.3)
            : law_section(std::make_shared<materials::Hgo>(materials::native_leaflet_healthy)));
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()));
    const Points rest = moved(shell.mesh().reference, turn, {3, -4, 10});
    EXPECT_LT(largest(forces_of(shell, rest)), 1e-9 * largest(forces_of(shell, rich.x)));
    const Points f = forces_of(shell, rich.x), g = forces_of(shell, moved(rich.x, turn, {3, -4, 10}));
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    for (std::size_t a = 0; a < f.size(); ++a) {
      EXPECT_LT((turn * f[a] - g[a]).norm(), 1e-9 * largest(f));
      force += f[a];
      moment += rich.x[a].cross(f[a]);
    }
    EXPECT_LT(force.norm(), 1e-11 * largest(f) * f.size());
    EXPECT_LT(moment.norm(), 1e-10 * largest(f) * f.size());
  }
}

TEST(KirchhoffShell, OnlyRigidMotionsHaveNoEnergy) {
  for (Pattern pattern : {Pattern::one_way, Pattern::alternating, Pattern::unstructured}) {
    const test::SheetMesh sheet = test::sheet(3, 3, 4, 4, pattern, 3);
    const Points shape =
        test::mapped(sheet, [](double u, double v) { return Vec3(u, v, 0.1 * u * u - 0.05 * v * v); });
    const KirchhoffShell shell(test::shell_mesh(sheet, shape, 0.3), koiter_section(1e6, 0.3));
    const int n = 3 * shell.nodes();
    BlockMatrix k(shell.nodes(), 0);
    shell.add_tangent(shape, k);
    Eigen::MatrixXd dense(n, n);
    for (int j = 0; j < n; ++j) dense.col(j) = k.times(Eigen::VectorXd::Unit(n, j));
    EXPECT_LT((dense - dense.transpose()).norm(), 1e-12 * dense.norm());
    const Eigen::VectorXd eigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
    EXPECT_LT(eigen.head(6).cwiseAbs().maxCoeff(), 1e-10 * eigen[n - 1]);
    EXPECT_GT(eigen[6], 1e-6 * eigen[n - 1]);
  }
}

TEST(KirchhoffShell, PositiveTangentIsPositiveAndBounded) {
  const Rich rich(Section::laws);
  const int n = 3 * rich.shell->nodes();
  Eigen::MatrixXd dense(n, n);
  BlockMatrix k(rich.x.size(), 0);
  rich.shell->add_positive_tangent(rich.x, k);
  for (int j = 0; j < n; ++j) dense.col(j) = k.times(Eigen::VectorXd::Unit(n, j));
  const Eigen::VectorXd eigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
  EXPECT_LT((dense - dense.transpose()).norm(), 1e-12 * dense.norm());
  EXPECT_GE(eigen[0], -1e-10 * eigen[n - 1]);
  std::vector<double> bound(n / 3, 0.0);
  rich.shell->add_stiffness_bound(rich.x, bound);
  EXPECT_GE(*std::max_element(bound.begin(), bound.end()), eigen[n - 1]);
}

TEST(KirchhoffShell, LawsAgreeWithKoiterAtSmallStrain) {
  // Neo-Hookean mu: E = 3 mu, nu = 1/2. Two and three layers integrate bending exactly.
  const test::SheetMesh sheet = test::sheet(4, 3, 5, 4, Pattern::unstructured, 3);
  const ShellMesh mesh = test::shell_mesh(sheet, sheet.plane, 0.2);
  const Points x = along(sheet.plane, shaken(Points(sheet.plane.size(), Vec3::Zero()), 1, 4), 1e-6);
  const double exact = energy_of(KirchhoffShell(mesh, koiter_section(3e5, 0.5, {0.7, 1.3})), x);
  for (int layers : {2, 3, 4, 5}) {
    const auto section = law_section(std::make_shared<materials::NeoHookean>(1e5), layers, {0.7, 1.3});
    EXPECT_NEAR(energy_of(KirchhoffShell(mesh, section), x), exact, 1e-4 * exact) << layers;
  }
}

TEST(KirchhoffShell, ThreadsAndSharesDoNotChangeTheResult) {
  const test::SheetMesh sheet = test::sheet(4, 3, 24, 18, Pattern::unstructured, 3);
  const KirchhoffShell shell(test::shell_mesh(sheet, sheet.plane, 0.2), koiter_section(3e5, 0.4));
  const Points x = shaken(sheet.plane, 0.02, 5);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const Points one = forces_of(shell, x);
  omp_set_num_threads(3);
  const Points three = forces_of(shell, x);
  omp_set_num_threads(threads);
  EXPECT_EQ(one, three);
  Points shares(x.size(), Vec3::Zero());
  for (int i = 0; i < 4; ++i) shell.add_forces(x, shares, 0, {i, 4});
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_LT((shares[a] - one[a]).norm(), 1e-12 * largest(one));
}

TEST(KirchhoffShell, EdgeMomentTangentIsTheGradientOfItsForce) {
  const Rich rich(Section::koiter);
  System system;
  const Body body = system.add_body("shell", rich.x, rich.shell->lumped_mass(1e-3));
  const test::SheetMesh sheet = test::sheet(4, 3, 5, 4, Pattern::unstructured, 3);
  const std::vector<Edge> edges = test::border_edges(sheet, [](double u, double) { return u == 4; });
  const EdgeMomentTerm term("moment", rich.shell, body, edges, [](double) { return 10.0; });
  const Points direction = shaken(Points(rich.x.size(), Vec3::Zero()), 1, 6);
  const auto forces = [&](double h) {
    Configuration now;
    now.x = along(rich.x, direction, h);
    Forces out;
    out.reset(rich.x.size(), 0);
    term.add_forces(now, out);
    return out.force;
  };
  Configuration now;
  now.x = rich.x;
  BlockMatrix k(rich.x.size(), 0);
  term.add_tangent(now, k);
  Eigen::VectorXd d(3 * rich.x.size());
  for (std::size_t a = 0; a < rich.x.size(); ++a) d.segment<3>(3 * a) = direction[a];
  const Eigen::VectorXd exact = k.times(d);
  const auto error = [&](double h) {
    const Points up = forces(h), down = forces(-h);
    double total = 0;
    for (std::size_t a = 0; a < up.size(); ++a)
      total += ((down[a] - up[a]) / (2 * h) - exact.segment<3>(3 * a)).squaredNorm();
    return std::sqrt(total);
  };
  EXPECT_LT(error(2e-4), 1e-3 * exact.norm());
  EXPECT_NEAR(std::log2(error(4e-4) / error(2e-4)), 2.0, 0.1);
}

TEST(KirchhoffShell, WrongInputIsNamed) {
  const auto build = [](const Points& x, const std::vector<Triangle>& triangles,
                        const EdgeConditions& conditions = {}) {
    ShellMesh mesh;
    mesh.reference = x;
    mesh.triangles = triangles;
    mesh.thickness_mm.assign(x.size(), 0.1);
    KirchhoffShell(mesh, koiter_section(1e6, 0.3), conditions);
  };
  const auto message = [](const std::function<void()>& work) -> std::string {
    try {
      work();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  const Points x{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  EXPECT_NE(message([&] {
              build(x, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
            }).find("edge 0-1"),
            std::string::npos);
  EXPECT_NE(message([&] {
              build({x[0], x[1], x[2], x[3]}, {{0, 1, 2}, {0, 1, 3}});
            }).find("edge 0-1"),
            std::string::npos);
  EXPECT_NE(message([&] { build(x, {{0, 1, 2}, {1, 0, 3}}); }).find("node 4"), std::string::npos);
  EXPECT_NE(message([&] {
              build({x[0], x[1], x[2], x[3]}, {{0, 1, 2}, {1, 0, 3}},
                    {{{0, 1}, {EdgeSupport::clamped, Vec3::Zero(), 0}}});
            }).find("edge 0-1"),
            std::string::npos);
  EXPECT_NE(message([&] { build({x[0], x[1], 2 * x[1]}, {{0, 1, 2}}); }).find("no area"), std::string::npos);
}
