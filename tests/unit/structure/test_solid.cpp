// Solid elements: shape functions, forces, tangents, patch tests; tangents of the other force terms.
#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "materials/library.hpp"
#include "materials/neo_hookean.hpp"
#include "meshes.hpp"
#include "solid_meshes.hpp"
#include "structure/beam.hpp"
#include "structure/pressure.hpp"
#include "structure/shell_term.hpp"
#include "structure/solid_surface.hpp"
#include "structure/tie.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

struct Kind {
  Shape shape;
  Formulation formulation;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all = [] {
    std::vector<Kind> list;
    for (Shape s : {Shape::tet4, Shape::tet10, Shape::hex8, Shape::hex27})
      for (Formulation f : {Formulation::displacement, Formulation::mixed}) list.push_back({s, f});
    return list;
  }();
  return all;
}

std::string label(const Kind& k) {
  return name_of(k.shape) + (k.formulation == Formulation::mixed ? " mixed" : " displacement");
}

std::shared_ptr<const materials::SolidLaw> soft() {
  return std::make_shared<materials::SolidLaw>(
      std::make_shared<materials::NeoHookean>(2.0),
      materials::Volumetric{materials::Volumetric::Form::simo_taylor, 7.0});
}

// A distorted mesh: edges and faces are not straight, elements are still sound.
Vec3 distorted(const Vec3& x) {
  return {1.2 * x.x() + 0.08 * std::sin(3 * x.y() + x.z()), x.y() + 0.07 * std::sin(2 * x.x() * x.z() + 1),
          0.9 * x.z() + 0.06 * std::cos(3 * x.x() - x.y())};
}

// Tetrahedra with straight edges: the four points of tet10 do not integrate curved ones exactly.
SolidMesh straightened(SolidMesh mesh) {
  for (int e = 0; e < mesh.elements(); ++e) {
    if (mesh.shapes[e] != Shape::tet10) continue;
    const auto nodes = mesh.nodes_of(e);
    const std::vector<Vec3> local = node_coordinates(Shape::tet10);
    for (int a = 4; a < 10; ++a) {
      const ShapeValues corners = evaluate(Shape::tet4, local[a]);
      Vec3 at = Vec3::Zero();
      for (int b = 0; b < 4; ++b) at += corners.value[b] * mesh.reference[nodes[b]];
      mesh.reference[nodes[a]] = at;
    }
  }
  return mesh;
}

Points random_direction(std::size_t n, unsigned seed) {
  return shaken(Points(n, Vec3::Zero()), 1, seed);
}

Points along(const Points& x, const Points& d, double h) {
  Points y = x;
  for (std::size_t a = 0; a < x.size(); ++a) y[a] += h * d[a];
  return y;
}

double dot(const Points& a, const Points& b) {
  double s = 0;
  for (std::size_t i = 0; i < a.size(); ++i) s += a[i].dot(b[i]);
  return s;
}

// Second order of the central difference, and its extrapolation on the derivative.
void expect_second_order(double first, double second, double scale, const std::string& what) {
  EXPECT_GT(first / second, 3.6) << what;
  EXPECT_LT(first / second, 4.4) << what;
  EXPECT_LT(second, 0.05 * scale) << what;
}

// |K d + (f(x + h d) - f(x - h d))/2h| of any term, spins included, at two steps.
void check_tangent(const ForceTerm& term, const Configuration& state, const std::string& what,
                   double h = 2e-2) {
  const std::size_t nodes = state.x.size(), turning = state.rotation.size();
  BlockMatrix k(nodes, turning);
  term.add_tangent(state, k);
  Eigen::VectorXd d(3 * k.slots());
  const Points direction = random_direction(nodes + turning, 5);
  for (int i = 0; i < k.slots(); ++i) d.segment<3>(3 * i) = direction[i];
  const Eigen::VectorXd expected = k.times(d);
  const auto force = [&](double step) {
    Configuration now = state;
    for (std::size_t a = 0; a < nodes; ++a) now.x[a] += step * direction[a];
    for (std::size_t r = 0; r < turning; ++r) {
      const Vec3 spin = step * direction[nodes + r];
      now.rotation[r] = Eigen::AngleAxisd(spin.norm(), spin.normalized()) * now.rotation[r];
    }
    Forces out;
    out.reset(nodes, turning);
    term.add_forces(now, out);
    Eigen::VectorXd f(3 * k.slots());
    for (std::size_t a = 0; a < nodes; ++a) f.segment<3>(3 * a) = out.force[a];
    for (std::size_t r = 0; r < turning; ++r) f.segment<3>(3 * (nodes + r)) = out.moment[r];
    return f;
  };
  double error[2];
  for (int i = 0; i < 2; ++i) {
    const double step = i == 0 ? h : h / 2;
    error[i] = (expected + (force(step) - force(-step)) / (2 * step)).norm();
  }
  expect_second_order(error[0], error[1], expected.norm(), what);
}

}  // namespace

TEST(Shapes, PartitionOfUnityAndNodes) {
  for (Shape s : {Shape::tet4, Shape::tet10, Shape::hex8, Shape::hex27, Shape::triangle3, Shape::triangle6,
                  Shape::quad4, Shape::quad9}) {
    const std::vector<Vec3> nodes = node_coordinates(s);
    ASSERT_EQ(int(nodes.size()), nodes_of(s));
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const ShapeValues v = evaluate(s, nodes[a]);
      for (std::size_t b = 0; b < nodes.size(); ++b) EXPECT_NEAR(v.value[b], a == b, 1e-14) << name_of(s);
    }
    const Vec3 at(0.21, 0.17, dimension_of(s) == 3 ? 0.13 : 0);
    const ShapeValues v = evaluate(s, at);
    EXPECT_NEAR(v.value.sum(), 1, 1e-14);
    for (int d = 0; d < dimension_of(s); ++d) {
      const double h = 1e-5;
      const auto difference =
          (evaluate(s, at + h * Vec3::Unit(d)).value - evaluate(s, at - h * Vec3::Unit(d)).value) / (2 * h);
      EXPECT_LT((difference.transpose() - v.gradient.row(d)).norm(), 1e-9) << name_of(s);
    }
  }
}

TEST(Shapes, QuadratureIntegratesMonomials) {
  // Over the unit tetrahedron: a! b! c! / (a + b + c + 3)!; over the cube a product of 2/(n + 1).
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  const auto check = [&](Shape s, Rule rule, int degree) {
    for (int a = 0; a <= degree; ++a)
      for (int b = 0; a + b <= degree; ++b)
        for (int c = 0; a + b + c <= degree; ++c) {
          double sum = 0;
          for (const QuadraturePoint& q : quadrature(s, rule))
            sum += q.weight * std::pow(q.at.x(), a) * std::pow(q.at.y(), b) * std::pow(q.at.z(), c);
          const bool tet = s == Shape::tet4 || s == Shape::tet10;
          const auto line = [](int n) { return n % 2 ? 0 : 2.0 / (n + 1); };
          const double exact = tet ? factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 3)
                                   : line(a) * line(b) * line(c);
          EXPECT_NEAR(sum, exact, 1e-14) << name_of(s) << " " << a << b << c;
        }
  };
  check(Shape::tet4, Rule::stiffness, 1);
  check(Shape::tet10, Rule::stiffness, 2);
  check(Shape::tet10, Rule::rich, 5);
  check(Shape::hex8, Rule::stiffness, 3);
  check(Shape::hex27, Rule::stiffness, 5);
}

TEST(Solid, ForceIsGradientOfEnergyAndTangentOfForce) {
  for (const Kind& kind : kinds()) {
    const auto solid =
        std::make_shared<Solid>(solid_box(kind.shape, {1, 1, 1}, distorted), soft(), kind.formulation);
    const Points x = shaken(solid->mesh().reference, 0.05, 3);
    const Points d = random_direction(x.size(), 7);
    Points f(x.size(), Vec3::Zero());
    solid->add_forces(x, f);
    const double slope = -dot(f, d);
    const double h = kind.shape == Shape::hex27 ? 2e-3 : 1e-2;
    double error[2];
    for (int i = 0; i < 2; ++i) {
      const double step = i == 0 ? h : h / 2;
      Points unused(x.size(), Vec3::Zero());
      const double ahead = solid->add_forces(along(x, d, step), unused);
      const double behind = solid->add_forces(along(x, d, -step), unused);
      error[i] = std::abs((ahead - behind) / (2 * step) - slope);
    }
    expect_second_order(error[0], error[1], std::abs(slope) + largest(f), label(kind) + " force");
    System system;
    const Body body = system.add_body("solid", x, solid->lumped_mass(1));
    check_tangent(SolidTerm(solid, body), system.state, label(kind) + " tangent", h);
  }
}

TEST(Solid, FibreLawTangent) {
  const materials::MaterialSet& set =
      materials::MaterialLibrary::built_in().find("tavr-ifed-2022/porcine-pericardium");
  SolidMesh mesh = solid_box(Shape::hex8, {2, 1, 1}, distorted);
  mesh.fibre1.assign(mesh.elements(), Vec3(0.8, 0.6, 0));
  mesh.fibre2.assign(mesh.elements(), Vec3(0.8, -0.6, 0));
  for (Formulation f : {Formulation::displacement, Formulation::mixed}) {
    const auto solid =
        std::make_shared<Solid>(mesh, std::make_shared<materials::SolidLaw>(set.solid_law()), f);
    Points x;
    for (const Vec3& p : mesh.reference) x.emplace_back(1.1 * p.x() + 0.05 * p.y(), 0.98 * p.y(), p.z());
    System system;
    const Body body = system.add_body("solid", x, solid->lumped_mass(1));
    check_tangent(SolidTerm(solid, body), system.state, "fibres", 1e-3);
  }
}

TEST(Solid, RigidMotionGivesNoForce) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.1, Vec3(1, 2, -1).normalized()));
  for (const Kind& kind : kinds()) {
    const Solid solid(solid_box(kind.shape, {2, 1, 1}, distorted), soft(), kind.formulation);
    const Points x = moved(solid.mesh().reference, turn, Vec3(3, -1, 2));
    Points f(x.size(), Vec3::Zero());
    EXPECT_NEAR(solid.add_forces(x, f), 0, 1e-13) << label(kind);
    EXPECT_LT(largest(f), 1e-13) << label(kind);
  }
}

TEST(Solid, PatchTest) {
  // A homogeneous deformation of a distorted mesh: inner nodes in equilibrium, the stress the law's.
  Mat3 f;
  f << 1.2, 0.15, -0.1, 0.05, 0.9, 0.2, 0.1, -0.05, 1.1;
  const auto law = soft();
  const auto expected = law->respond(f.transpose() * f, {}, 1, materials::Derivatives::stress);
  const Mat3 cauchy = materials::cauchy_stress(f, expected.stress);
  for (const Kind& kind : kinds()) {
    SolidMesh mesh = solid_box(kind.shape, {2, 2, 2}, distorted);
    if (kind.formulation == Formulation::displacement) mesh = straightened(mesh);
    const Solid solid(mesh, law, kind.formulation);
    Points x;
    for (const Vec3& p : solid.mesh().reference) x.push_back(f * p + Vec3(1, 2, 3));
    Points force(x.size(), Vec3::Zero());
    const double energy = solid.add_forces(x, force);
    EXPECT_NEAR(energy, expected.energy * solid.volume(), 1e-12 * energy) << label(kind);
    std::vector<int> rim(x.size(), 0);
    for (const SolidFace& face : boundary_faces(solid.mesh()))
      for (int a : face.nodes) rim[a] = 1;
    int inner = 0;
    for (std::size_t a = 0; a < x.size(); ++a)
      if (!rim[a]) {
        ++inner;
        EXPECT_LT(force[a].norm(), 1e-13) << label(kind);
      }
    EXPECT_GT(inner, 0);
    for (const auto& element : solid.all_points(x))
      for (const SolidPoint& p : element) EXPECT_LT((p.cauchy_Pa - cauchy).norm(), 1e-11) << label(kind);
    // The surface carries the traction sigma n on the present area: momentum of the whole is zero.
    Vec3 total = Vec3::Zero();
    for (const Vec3& v : force) total += v;
    EXPECT_LT(total.norm(), 1e-12);
  }
}

TEST(Solid, NoElementHasSpuriousModes) {
  // Eigenvalues of the unloaded tangent of one element: exactly six zeros.
  for (const Kind& kind : kinds()) {
    if (kind.shape == Shape::tet4 && kind.formulation == Formulation::mixed) continue;  // of patches
    SolidMesh mesh;
    mesh.reference = node_coordinates(kind.shape);
    std::vector<int> nodes(mesh.reference.size());
    for (std::size_t a = 0; a < nodes.size(); ++a) nodes[a] = int(a);
    mesh.add(kind.shape, nodes);
    const Solid solid(mesh, soft(), kind.formulation);
    BlockMatrix k(nodes.size(), 0);
    solid.add_tangent(mesh.reference, k);
    const int n = 3 * int(nodes.size());
    Eigen::MatrixXd dense(n, n);
    for (int i = 0; i < n; ++i) dense.col(i) = k.times(Eigen::VectorXd::Unit(n, i));
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense).eigenvalues();
    const int zeros = 6;
    EXPECT_LT(values.head(zeros).cwiseAbs().maxCoeff(), 1e-12 * values[n - 1]) << label(kind);
    EXPECT_GT(values[zeros], 1e-4 * values[n - 1]) << label(kind);
  }
}

TEST(Solid, MassIsPositiveAndComplete) {
  for (Shape s : {Shape::tet4, Shape::tet10, Shape::hex8, Shape::hex27}) {
    const Solid solid(solid_box(s, {2, 2, 1}), soft(), Formulation::displacement);
    double total = 0;
    for (double m : solid.lumped_mass(3)) {
      EXPECT_GT(m, 0) << name_of(s);
      total += m;
    }
    EXPECT_NEAR(total, 3, 1e-12) << name_of(s);
    EXPECT_NEAR(solid.volume(), 1, 1e-13);
  }
}

TEST(Solid, ErrorsNameTheElement) {
  SolidMesh mesh = solid_box(Shape::hex8, {2, 1, 1});
  std::swap(mesh.connectivity[8], mesh.connectivity[9]);
  try {
    Solid(mesh, soft(), Formulation::displacement);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("element 1"), std::string::npos) << error.what();
  }
  const Solid solid(solid_box(Shape::tet4, {1, 1, 1}), soft(), Formulation::mixed);
  Points x = solid.mesh().reference;
  x[0] += Vec3(3, 0, 0);
  Points f(x.size(), Vec3::Zero());
  try {
    solid.add_forces(x, f);
    FAIL();
  } catch (const NumericalFailure& error) {
    EXPECT_NE(std::string(error.what()).find("element"), std::string::npos) << error.what();
  }
}

TEST(Solid, SameBitsOnAnyNumberOfThreads) {
  const Solid solid(solid_box(Shape::tet4, {3, 3, 3}, distorted), soft(), Formulation::mixed);
  const Points x = shaken(solid.mesh().reference, 0.02, 3);
  Points one(x.size(), Vec3::Zero()), three = one;
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const double energy1 = solid.add_forces(x, one);
  omp_set_num_threads(3);
  const double energy3 = solid.add_forces(x, three);
  omp_set_num_threads(before);
  EXPECT_EQ(energy1, energy3);
  for (std::size_t a = 0; a < x.size(); ++a) EXPECT_EQ(one[a], three[a]);
}

TEST(SolidSurface, PressureOnClosedSurfaceAndTangent) {
  for (Shape s : {Shape::tet4, Shape::tet10, Shape::hex8, Shape::hex27}) {
    const SolidMesh mesh = solid_box(s, {1, 1, 1}, distorted);
    System system;
    const Body body = system.add_body("solid", mesh.reference, std::vector<double>(mesh.reference.size(), 1));
    const SolidPressureTerm term("pressure", boundary_faces(mesh), body, [](double) { return 3.0; });
    Forces out;
    out.reset(system.nodes(), 0);
    term.add_forces(system.state, out);
    Vec3 total = Vec3::Zero();
    double virial = 0;
    for (std::size_t a = 0; a < system.nodes(); ++a) {
      total += out.force[a];
      virial += out.force[a].dot(system.state.x[a]);
    }
    EXPECT_LT(total.norm(), 1e-12) << name_of(s);
    // integral -p n.x dA = -3 p V; exact for the surface's own volume.
    const Solid solid(mesh, soft(), Formulation::displacement);
    EXPECT_NEAR(virial, -9 * solid.volume(), s == Shape::tet10 ? 0.02 : 1e-11) << name_of(s);
    const SolidPressureTerm open("pressure", {boundary_faces(mesh)[0]}, body, [](double) { return 3.0; });
    BlockMatrix k(system.nodes(), 0);
    open.add_tangent(system.state, k);
    const Points d = random_direction(system.nodes(), 4);
    Eigen::VectorXd flat(3 * k.slots());
    for (int a = 0; a < k.slots(); ++a) flat.segment<3>(3 * a) = d[a];
    const auto force = [&](double step) {
      Configuration now = system.state;
      now.x = along(now.x, d, step);
      Forces f;
      f.reset(system.nodes(), 0);
      open.add_forces(now, f);
      Eigen::VectorXd v(3 * k.slots());
      for (int a = 0; a < k.slots(); ++a) v.segment<3>(3 * a) = f.force[a];
      return v;
    };
    // The force is quadratic in the positions: central differences are exact.
    EXPECT_LT((k.times(flat) + (force(1e-2) - force(-1e-2)) / 2e-2).norm(), 1e-11) << name_of(s);
  }
}

TEST(Tangents, BeamsShellsAndTies) {
  BeamMesh beams;
  beams.reference = {Vec3(0, 0, 0), Vec3(1, 0.2, 0), Vec3(1.5, 1, 0.3)};
  beams.elements = {{0, 1}, {1, 2}};
  beams.width_mm = {0.3, 0.3};
  beams.depth_mm = {0.2, 0.2};
  beams.depth_axis = {Vec3::UnitZ(), Vec3::UnitZ()};
  const auto network = std::make_shared<BeamNetwork>(beams, BeamMaterial{1000, 0.3, 1});
  const auto law = std::make_shared<materials::NeoHookean>(5.0);
  ShellMesh sheet = rectangle(2, 2, 2, 2, 0.3);
  for (Vec3& p : sheet.reference) p.z() = 0.1 * p.x() * p.y();
  const auto shell = std::make_shared<Shell>(sheet, law, Bending{400, 0.4});
  System system;
  std::vector<Eigen::Quaterniond> turned;
  for (int a = 0; a < 3; ++a) turned.emplace_back(Eigen::AngleAxisd(0.2 * a, Vec3(1, a, -1).normalized()));
  const Body frame = system.add_rotational_body("frame", shaken(beams.reference, 0.05, 2),
                                                network->lumped_mass(), turned, network->lumped_inertia());
  const Body cloth = system.add_body("cloth", shaken(sheet.reference, 0.1, 4), shell->lumped_mass(1));
  check_tangent(BeamTerm(network, frame), system.state, "beam", 1e-2);
  check_tangent(ShellTerm(shell, cloth), system.state, "shell", 2e-3);
  const TieTerm ties("ties", {{cloth.offset + 1, frame.offset + 1, Vec3(0.4, 0.2, -0.3), 50}}, system);
  check_tangent(ties, system.state, "tie", 1e-2);
}

TEST(Tangents, PressureOnTriangles) {
  const ShellMesh sheet = rectangle(2, 2, 2, 2, 0.3);
  System system;
  const Body body = system.add_body("cloth", shaken(sheet.reference, 0.1, 4), std::vector<double>(9, 1.0));
  const PressureTerm term("pressure", sheet.triangles, body, [](double) { return 2.0; });
  BlockMatrix k(9, 0);
  term.add_tangent(system.state, k);
  const Points d = random_direction(9, 1);
  Eigen::VectorXd flat(27);
  for (int a = 0; a < 9; ++a) flat.segment<3>(3 * a) = d[a];
  Eigen::VectorXd difference(27);
  Forces ahead, behind;
  ahead.reset(9, 0);
  behind.reset(9, 0);
  Configuration now = system.state;
  now.x = along(system.state.x, d, 0.01);
  term.add_forces(now, ahead);
  now.x = along(system.state.x, d, -0.01);
  term.add_forces(now, behind);
  for (int a = 0; a < 9; ++a) difference.segment<3>(3 * a) = (ahead.force[a] - behind.force[a]) / 0.02;
  EXPECT_LT((k.times(flat) + difference).norm(), 1e-11);
}
