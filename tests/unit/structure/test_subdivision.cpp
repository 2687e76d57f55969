#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/errors.hpp"
#include "materials/hgo.hpp"
#include "meshes.hpp"
#include "shell_meshes.hpp"
#include "structure/subdivision_loads.hpp"

using namespace valsalva;
using namespace valsalva::structure;
using test::Pattern;

namespace {

// A fan of rings around a triangle with given valences, as a separate patch.
TriangleRings rings_of(const std::vector<Triangle>& triangles, int nodes, int triangle,
                       Points* place = nullptr, const Points& x = {}) {
  const SubdivisionSurface surface(x.empty() ? Points(nodes, Vec3::Zero()) : x, triangles, {},
                                   SubdivisionSurface::Given::control_net);
  const TrianglePatch patch = surface.patch(triangle);
  if (place) {
    Points vertices;
    surface.gather(surface.reference(), 0, vertices);
    for (int v : patch.vertices) place->push_back(vertices[v]);
  }
  return patch.rings;
}

}  // namespace

TEST(SubdivisionBasis, RegularTriangleReproducesQuadratics) {
  const test::SheetMesh mesh = test::sheet(6, 6, 6, 6, Pattern::one_way);
  Points place;
  const TriangleRings rings = rings_of(mesh.triangles, 49, 2 * (6 * 3 + 3), &place, mesh.plane);
  ASSERT_TRUE(rings.regular());
  ASSERT_EQ(rings.vertices, 12);
  const double r = 0.2, s = 0.35;
  const BasisTable n = loop_basis(rings, r, s);
  Eigen::Matrix<double, 6, 1> one = Eigen::Matrix<double, 6, 1>::Zero(), x = one, xx = one, xy = one;
  for (int a = 0; a < 12; ++a) {
    one += n.col(a);
    x += n.col(a) * place[a].x();
    xx += n.col(a) * place[a].x() * place[a].x();
    xy += n.col(a) * place[a].x() * place[a].y();
  }
  const double at = place[0].x() + r, up = place[0].y() + s;
  EXPECT_LT((one - (Eigen::Matrix<double, 6, 1>() << 1, 0, 0, 0, 0, 0).finished()).norm(), 1e-13);
  EXPECT_LT((x - (Eigen::Matrix<double, 6, 1>() << at, 1, 0, 0, 0, 0).finished()).norm(), 1e-12);
  // Up to the constant by which control values of a quadratic stand off it.
  EXPECT_LT((xx - (Eigen::Matrix<double, 6, 1>() << xx[0], 2 * at, 0, 2, 0, 0).finished()).norm(), 1e-11);
  EXPECT_LT((xy - (Eigen::Matrix<double, 6, 1>() << xy[0], up, at, 0, 0, 1).finished()).norm(), 1e-11);
  EXPECT_NEAR(xx[0] - at * at, 1. / 3, 1e-12);
}

TEST(SubdivisionBasis, DerivativesAgreeWithDifferencesOnIrregularTriangles) {
  const test::SheetMesh mesh = test::sheet(6, 6, 6, 6, Pattern::unstructured, 5);
  int irregular = 0;
  for (int e = 0; e < int(mesh.triangles.size()); ++e) {
    const TriangleRings rings = rings_of(mesh.triangles, 49, e, nullptr, mesh.plane);
    irregular += !rings.regular();
    for (const auto& [r, s] : {std::pair{0.11, 0.17}, {0.71, 0.1}, {0.13, 0.8}, {0.3, 0.3}}) {
      const double h = 1e-5;
      const BasisTable n = loop_basis(rings, r, s);
      const BasisTable east = loop_basis(rings, r + h, s), west = loop_basis(rings, r - h, s);
      const BasisTable north = loop_basis(rings, r, s + h), south = loop_basis(rings, r, s - h);
      EXPECT_NEAR(n.row(0).sum(), 1, 1e-13);
      EXPECT_LT((n.bottomRows<5>().rowwise().sum()).norm(), 1e-11);
      EXPECT_LT(((east.row(0) - west.row(0)) / (2 * h) - n.row(1)).norm(), 1e-8);
      EXPECT_LT(((north.row(0) - south.row(0)) / (2 * h) - n.row(2)).norm(), 1e-8);
      EXPECT_LT(((east.row(1) - west.row(1)) / (2 * h) - n.row(3)).norm(), 1e-7);
      EXPECT_LT(((north.row(2) - south.row(2)) / (2 * h) - n.row(4)).norm(), 1e-7);
      EXPECT_LT(((north.row(1) - south.row(1)) / (2 * h) - n.row(5)).norm(), 1e-7);
    }
  }
  EXPECT_GT(irregular, 10);
}

namespace {

enum class Section { koiter, laws };

// A curved patch with thickness, fibres and stiffness that vary, every kind of border, irregular nodes.
struct Rich {
  std::shared_ptr<SubdivisionShell> shell;
  Points x;  // deformed

  explicit Rich(Section section, Pattern pattern = Pattern::unstructured,
                ShellQuadrature quadrature = ShellQuadrature::three) {
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
    for (const Edge& e : test::border_edges(sheet, [](double u, double) { return u == 4; }))
      conditions[e] = {EdgeSupport::hinged, Vec3::Zero(), 0};
    const auto model =
        section == Section::koiter
            ? koiter_section(1e6, 0.3, {0.8, 1.2})
            : law_section(std::make_shared<materials::Hgo>(materials::native_leaflet_healthy), 3, {0.8, 1.2});
    shell = std::make_shared<SubdivisionShell>(mesh, model, conditions, quadrature);
    x = shaken(shell->reference(), 0.06, 1);
  }
};

double energy_of(const SubdivisionShell& shell, const Points& x) {
  Points f(x.size(), Vec3::Zero());
  return shell.add_forces(x, f);
}

Points forces_of(const SubdivisionShell& shell, const Points& x) {
  Points f(x.size(), Vec3::Zero());
  shell.add_forces(x, f);
  return f;
}

Points along(Points x, const Points& direction, double h) {
  for (std::size_t a = 0; a < x.size(); ++a) x[a] += h * direction[a];
  return x;
}

}  // namespace

TEST(SubdivisionShell, ForceIsTheGradientOfTheEnergyToSecondOrder) {
  for (Section section : {Section::koiter, Section::laws})
    for (ShellQuadrature quadrature : {ShellQuadrature::one, ShellQuadrature::three}) {
      const Rich rich(section, Pattern::unstructured, quadrature);
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

TEST(SubdivisionShell, TangentIsTheGradientOfTheForceToSecondOrder) {
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
