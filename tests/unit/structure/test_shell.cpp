#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Eigenvalues>

#include "core/errors.hpp"
#include "materials/hgo.hpp"
#include "materials/neo_hookean.hpp"
#include "meshes.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

std::shared_ptr<const materials::InvariantLaw> neo_hookean(double mu = 1e5) {
  return std::make_shared<materials::NeoHookean>(mu);
}

// A curved patch with fibres, thickness and stiffness that vary.
Shell rich_shell() {
  ShellMesh mesh = rectangle(4, 3, 4, 3, 0.4);
  for (Vec3& p : mesh.reference) p.z() = 0.1 * p.x() * p.x() - 0.05 * p.x() * p.y();
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
  return {mesh, std::make_shared<materials::Hgo>(materials::native_leaflet_healthy), {2e5, 0.5}};
}

double energy_of(const Shell& shell, const Points& x) {
  Points f(x.size(), Vec3::Zero());
  return shell.add_forces(x, f);
}

Points forces_of(const Shell& shell, const Points& x) {
  Points f(x.size(), Vec3::Zero());
  shell.add_forces(x, f);
  return f;
}

}  // namespace

TEST(Shell, ForceIsTheGradientOfTheEnergyToSecondOrder) {
  const Shell shell = rich_shell();
  const Points x = shaken(shell.mesh().reference, 0.08, 1);
  const Points direction = shaken(Points(x.size(), Vec3::Zero()), 1, 2);
  const Points f = forces_of(shell, x);
  double exact = 0;
  for (std::size_t a = 0; a < x.size(); ++a) exact -= f[a].dot(direction[a]);
  const auto error = [&](double h) {
    Points plus = x, minus = x;
    for (std::size_t a = 0; a < x.size(); ++a) {
      plus[a] += h * direction[a];
      minus[a] -= h * direction[a];
    }
    return std::abs((energy_of(shell, plus) - energy_of(shell, minus)) / (2 * h) - exact);
  };
  const double coarse = error(2e-4), fine = error(1e-4);
  EXPECT_LT(fine, 1e-4 * std::abs(exact));
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
}

TEST(Shell, TangentIsTheGradientOfTheForceWhereNothingIsClipped) {
  // A flat sheet in biaxial tension: the geometric stress is positive, and flat hinges have no force.
  ShellMesh mesh = rectangle(4, 3, 4, 3, 0.4);
  const Shell shell(mesh, std::make_shared<materials::Hgo>(materials::porcine_pericardium), {1e5, 0.5});
  Points x = mesh.reference;
  for (Vec3& p : x) p = Vec3(1.06 * p.x() + 0.01 * p.y(), 1.04 * p.y(), 0);
  const Points direction = shaken(Points(x.size(), Vec3::Zero()), 1, 3);
  Points product(x.size(), Vec3::Zero());
  shell.add_tangent_product(x, direction, product);
  const auto error = [&](double h) {
    Points plus = x, minus = x;
    for (std::size_t a = 0; a < x.size(); ++a) {
      plus[a] += h * direction[a];
      minus[a] -= h * direction[a];
    }
    const Points up = forces_of(shell, plus), down = forces_of(shell, minus);
    double total = 0;
    for (std::size_t a = 0; a < x.size(); ++a)
      total += ((down[a] - up[a]) / (2 * h) - product[a]).squaredNorm();
    return std::sqrt(total);
  };
  const double coarse = error(2e-4), fine = error(1e-4);
  EXPECT_LT(fine, 1e-4 * largest(product));
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
}

TEST(Shell, TangentIsSymmetricAndPositiveSemiDefiniteAnywhere) {
  const Shell shell = rich_shell();
  const Points x = shaken(shell.mesh().reference, 0.15, 7);
  const int n = 3 * shell.nodes();
  Eigen::MatrixXd k(n, n);
  ShellTangent tangent(shell);
  tangent.update(x);
  for (int j = 0; j < n; ++j) {
    Points direction(x.size(), Vec3::Zero()), out(x.size(), Vec3::Zero());
    direction[j / 3][j % 3] = 1;
    tangent.apply(direction, out);
    for (int i = 0; i < n; ++i) k(i, j) = out[i / 3][i % 3];
  }
  EXPECT_LT((k - k.transpose()).norm(), 1e-12 * k.norm());
  const Eigen::VectorXd eigen = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(k).eigenvalues();
  EXPECT_GE(eigen[0], -1e-10 * eigen[n - 1]);
  // The row sums bound the largest eigenvalue.
  std::vector<double> bound(x.size(), 0.0);
  shell.add_stiffness_bound(x, bound);
  EXPECT_GE(*std::max_element(bound.begin(), bound.end()), eigen[n - 1]);
}

TEST(Shell, RigidMotionCostsNothing) {
  const Shell shell = rich_shell();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()));
  const Points x = moved(shell.mesh().reference, turn, {3, -4, 10});
  const Points deformed = shaken(shell.mesh().reference, 0.1, 5);
  EXPECT_LT(energy_of(shell, x), 1e-18 * energy_of(shell, deformed) + 1e-12);
  EXPECT_LT(largest(forces_of(shell, x)), 1e-9 * largest(forces_of(shell, deformed)));
  // And frame indifference: forces turn with the body.
  const Points f = forces_of(shell, deformed), g = forces_of(shell, moved(deformed, turn, {3, -4, 10}));
  for (std::size_t a = 0; a < f.size(); ++a) EXPECT_LT((turn * f[a] - g[a]).norm(), 1e-9 * largest(f));
}

TEST(Shell, ForcesBalance) {
  const Shell shell = rich_shell();
  const Points x = shaken(shell.mesh().reference, 0.1, 9);
  const Points f = forces_of(shell, x);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t a = 0; a < x.size(); ++a) {
    force += f[a];
    moment += x[a].cross(f[a]);
  }
  EXPECT_LT(force.norm(), 1e-11 * largest(f) * x.size());
  EXPECT_LT(moment.norm(), 1e-10 * largest(f) * x.size());
}

TEST(Shell, MembranePatchTest) {
  // A homogeneous deformation: inner nodes are in equilibrium on an irregular mesh, and the energy is exact.
  ShellMesh mesh = rectangle(4, 3, 4, 3, 0.5);
  for (std::size_t a = 0; a < mesh.reference.size(); ++a) {
    const bool inner = mesh.reference[a].x() > 0 && mesh.reference[a].x() < 4 && mesh.reference[a].y() > 0 &&
                       mesh.reference[a].y() < 3;
    if (inner) mesh.reference[a] += Vec3(0.2 * std::sin(3.0 * a), 0.2 * std::cos(5.0 * a), 0);
  }
  const double mu = 2e5;
  const Shell shell(mesh, neo_hookean(mu), {1e6, 0.3});
  Eigen::Matrix3d stretch;
  stretch << 1.2, 0.1, 0, 0.05, 0.9, 0, 0.3, 0, 1;
  Points x;
  for (const Vec3& p : mesh.reference) x.push_back(stretch * p);
  const Points f = forces_of(shell, x);
  for (std::size_t a = 0; a < x.size(); ++a) {
    const Vec3& p = mesh.reference[a];
    if (p.x() > 1e-9 && p.x() < 4 - 1e-9 && p.y() > 1e-9 && p.y() < 3 - 1e-9)
      EXPECT_LT(f[a].norm(), 1e-10 * largest(f)) << a;
  }
  const Eigen::Matrix2d c = (stretch.transpose() * stretch).topLeftCorner<2, 2>();
  const double exact = 4 * 3 * 0.5 * 0.5 * mu * (c.trace() + 1 / c.determinant() - 3);
  EXPECT_NEAR(energy_of(shell, x), exact, 1e-10 * exact);
}

namespace {

// Energy of a sheet rolled onto a cylinder along a direction, over that of the plate, D kappa^2/2 an area.
double rolled_energy_ratio(const ShellMesh& mesh, double direction) {
  const double thickness = 0.1, young = 1e6, nu = 0.3, radius = 20;
  const double rigidity = young * std::pow(thickness, 3) / (12 * (1 - nu * nu));
  const Shell shell(mesh, neo_hookean(1e-12), {young, nu});
  const Vec3 along(std::cos(direction), std::sin(direction), 0), across(-along.y(), along.x(), 0);
  Points x;
  for (const Vec3& p : mesh.reference) {
    const double s = p.dot(along) / radius;
    x.push_back(radius * std::sin(s) * along + p.dot(across) * across +
                radius * (1 - std::cos(s)) * Vec3::UnitZ());
  }
  double area = 0;
  for (int e = 0; e < shell.elements(); ++e) area += shell.reference_area(e);
  return energy_of(shell, x) / (0.5 * rigidity / (radius * radius) * area);
}

// Rows of equilateral triangles.
ShellMesh equilateral(int n, double edge) {
  ShellMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      mesh.reference.emplace_back(edge * (i + 0.5 * (j % 2)), edge * j * std::sqrt(3.0) / 2, 0);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      if (j % 2) {
        mesh.triangles.push_back({a, b, d});
        mesh.triangles.push_back({a, d, c});
      } else {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({b, d, c});
      }
    }
  mesh.thickness_mm.assign(mesh.reference.size(), 0.1);
  return mesh;
}

}  // namespace

TEST(Shell, BendingPatchTest) {
  // Along the mesh lines the plate's energy is met, up to the free half rows at the two ends (one cell in
  // nx); on equilateral triangles in every direction.
  EXPECT_NEAR(rolled_energy_ratio(rectangle(10, 2, 20, 4, 0.1), 0), 1 - 1.0 / 20, 1e-3);
  EXPECT_NEAR(rolled_energy_ratio(rectangle(10, 2, 80, 16, 0.1), 0), 1 - 1.0 / 80, 1e-3);
  for (double direction : {0.0, 0.3, 0.8, M_PI / 2})
    EXPECT_NEAR(rolled_energy_ratio(equilateral(40, 0.25), direction), 1, 0.05) << direction;
}

TEST(Shell, BendingDependsOnTheMeshAndByHowMuch) {
  // The documented weakness of hinges, kept in sight: bending at 45 degrees to a mesh of right triangles.
  const double skew = rolled_energy_ratio(rectangle(10, 10, 40, 40, 0.1), M_PI / 4);
  RecordProperty("energy_ratio_at_45_degrees", std::to_string(skew));
  EXPECT_GT(skew, 0.6);
  EXPECT_LT(skew, 1.6);
}

TEST(Shell, HingeAngleIsSignedAndReachesBeyondARightAngle) {
  ShellMesh mesh;
  mesh.reference = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  mesh.thickness_mm.assign(4, 0.1);
  const Shell shell(mesh, neo_hookean(), {1e6, 0.3});
  ASSERT_EQ(shell.hinges(), 1);
  const auto fold = [&](double angle) {
    Points x = mesh.reference;
    x[3] = Vec3(0.5, -std::cos(angle), std::sin(angle));
    return shell.hinge_angle(x, 0);
  };
  EXPECT_EQ(fold(0), 0);
  for (double angle : {0.3, 1.0, 2.0, 3.0}) EXPECT_NEAR(std::abs(fold(angle)), angle, 1e-12);
  EXPECT_NEAR(fold(0.5), -fold(-0.5), 1e-12);
}

TEST(Shell, SharesOfTheWorkAddUpToTheWhole) {
  const Shell shell = rich_shell();
  const Points x = shaken(shell.mesh().reference, 0.1, 11);
  const Points whole = forces_of(shell, x);
  Points parts(x.size(), Vec3::Zero());
  double energy = 0;
  for (int p = 0; p < 3; ++p) energy += shell.add_forces(x, parts, 0, {p, 3});
  EXPECT_NEAR(energy, energy_of(shell, x), 1e-12 * energy);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_LT((whole[a] - parts[a]).norm(), 1e-12 * largest(whole));

  const Points direction = shaken(Points(x.size(), Vec3::Zero()), 1, 4);
  Points full(x.size(), Vec3::Zero()), shared(x.size(), Vec3::Zero());
  shell.add_tangent_product(x, direction, full);
  for (int p = 0; p < 3; ++p) {
    ShellTangent tangent(shell, {p, 3});
    tangent.update(x);
    tangent.apply(direction, shared);
  }
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_LT((full[a] - shared[a]).norm(), 1e-12 * largest(full));
}

TEST(Shell, ThreadsDoNotChangeABit) {
  const ShellMesh mesh = rectangle(20, 20, 30, 30, 0.4);
  const Shell shell(mesh, std::make_shared<materials::Hgo>(materials::porcine_pericardium), {1e6, 0.5});
  const Points x = shaken(mesh.reference, 0.05, 13);
  const int before = omp_get_max_threads();
  Points one(x.size(), Vec3::Zero()), four(x.size(), Vec3::Zero());
  omp_set_num_threads(1);
  const double e1 = shell.add_forces(x, one);
  omp_set_num_threads(4);
  const double e4 = shell.add_forces(x, four);
  omp_set_num_threads(before);
  EXPECT_EQ(e1, e4);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_EQ(one[a], four[a]);
}

TEST(Shell, StressAndStretchOfUniaxialTension) {
  const double mu = 1e5, l = 1.3;
  const ShellMesh mesh = rectangle(2, 2, 1, 1, 0.5);
  const Shell shell(mesh, neo_hookean(mu), {});
  Points x;
  for (const Vec3& p : mesh.reference) x.emplace_back(l * p.x(), p.y() / std::sqrt(l), 0);
  const ElementState state = shell.element_state(x, 0);
  EXPECT_NEAR(state.von_mises_Pa, mu * (l * l - 1 / l), 1e-6 * mu);
  EXPECT_NEAR(state.stretch_major, l, 1e-12);
  EXPECT_NEAR(state.stretch_minor, 1 / std::sqrt(l), 1e-12);
}

TEST(Shell, MassAndAreaAreThoseOfTheBody) {
  const ShellMesh mesh = rectangle(4, 3, 4, 3, 0.5);
  const Shell shell(mesh, neo_hookean(), {});
  double mass = 0, area = 0;
  for (double m : shell.lumped_mass(1.1e-3)) mass += m;
  for (double a : shell.lumped_area()) area += a;
  EXPECT_NEAR(mass, 4 * 3 * 0.5 * 1.1e-3, 1e-15);
  EXPECT_NEAR(area, 12, 1e-12);
}

TEST(Shell, BadMeshesAreRefused) {
  const auto refused = [](ShellMesh mesh) {
    try {
      Shell(std::move(mesh), neo_hookean(), {1e5, 0.3});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  ShellMesh mesh = rectangle(1, 1, 2, 2, 0.1);
  mesh.thickness_mm[3] = -0.1;
  EXPECT_NE(refused(mesh).find("thickness of node 3"), std::string::npos);
  mesh = rectangle(1, 1, 2, 2, 0.1);
  mesh.triangles[1] = {0, 1, 99};
  EXPECT_NE(refused(mesh).find("node 99"), std::string::npos);
  mesh = rectangle(1, 1, 2, 2, 0.1);
  mesh.reference[1] = mesh.reference[0];
  EXPECT_NE(refused(mesh).find("no area"), std::string::npos);
  mesh = rectangle(1, 1, 2, 2, 0.1);
  mesh.stiffness_factor.assign(mesh.triangles.size(), 1);
  mesh.stiffness_factor[2] = -5;
  EXPECT_NE(refused(mesh).find("stiffness factor of triangle 2"), std::string::npos);
  mesh = rectangle(1, 1, 1, 1, 0.1);
  mesh.reference.emplace_back(0.5, 0.5, 1);
  mesh.thickness_mm.push_back(0.1);
  mesh.triangles.push_back({1, 2, 4});
  EXPECT_NE(refused(mesh).find("not manifold"), std::string::npos);
}
