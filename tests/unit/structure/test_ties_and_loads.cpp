#include <gtest/gtest.h>

#include "core/errors.hpp"
#include "meshes.hpp"
#include "structure/pressure.hpp"
#include "structure/tie.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

System sewn() {
  System system;
  system.add_rotational_body("frame", {{5, 0, 0}, {5, 1, 0}}, {1e-3, 1e-3},
                             {Eigen::Quaterniond::Identity(), Eigen::Quaterniond::Identity()}, {1e-4, 1e-4});
  system.add_body("leaflets", {{4.5, 0.1, 0.3}, {4.4, 0.9, -0.2}, {4, 0, 1}}, {1e-4, 1e-4, 1e-4});
  return system;
}

std::vector<Tie> ties_of(const System& system) {
  return ties_in_reference({{4.5, 0.1, 0.3}, {4.4, 0.9, -0.2}, {4, 0, 1}}, {{5, 0, 0}, {5, 1, 0}},
                           {{0, 0}, {1, 1}, {2, 0}}, system.body("leaflets"), system.body("frame"), 3e4);
}

}  // namespace

TEST(Tie, NothingInTheReferenceAndUnderRigidMotion) {
  System system = sewn();
  const TieTerm ties("ties", ties_of(system), system);
  Forces f;
  f.reset(5, 2);
  EXPECT_EQ(ties.add_forces(system.state, f), 0);
  EXPECT_EQ(largest(f.force), 0);
  EXPECT_EQ(largest(f.moment), 0);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.3, Vec3(1, 1, 0.2).normalized()));
  system.state.x = moved(system.state.x, turn, {1, 2, 3});
  for (auto& q : system.state.rotation) q = turn * q;
  EXPECT_LT(ties.max_gap(system.state), 1e-14);
}

TEST(Tie, GradientOfTheEnergyToSecondOrderAndMomentumConserved) {
  System system = sewn();
  const TieTerm ties("ties", ties_of(system), system);
  system.state.x = shaken(system.state.x, 0.2, 1);
  system.state.rotation[0] = Eigen::AngleAxisd(0.4, Vec3(1, -1, 0.3).normalized());
  system.state.rotation[1] = Eigen::AngleAxisd(-0.7, Vec3(0, 1, 0.5).normalized());
  Forces f;
  f.reset(5, 2);
  ties.add_forces(system.state, f);
  Vec3 force = Vec3::Zero(), moment = f.moment[0] + f.moment[1];
  for (int a = 0; a < 5; ++a) {
    force += f.force[a];
    moment += system.state.x[a].cross(f.force[a]);
  }
  EXPECT_LT(force.norm(), 1e-11 * largest(f.force));
  EXPECT_LT(moment.norm(), 1e-11 * largest(f.force));

  const Points dx = shaken(Points(5, Vec3::Zero()), 1, 2), dr = shaken(Points(2, Vec3::Zero()), 1, 3);
  double exact = 0;
  for (int a = 0; a < 5; ++a) exact -= f.force[a].dot(dx[a]);
  for (int r = 0; r < 2; ++r) exact -= f.moment[r].dot(dr[r]);
  const auto error = [&](double h) {
    const auto energy = [&](double s) {
      Configuration now = system.state;
      for (int a = 0; a < 5; ++a) now.x[a] += s * dx[a];
      for (int r = 0; r < 2; ++r)
        now.rotation[r] = Eigen::AngleAxisd(s * dr[r].norm(), dr[r].normalized()) * now.rotation[r];
      Forces ignored;
      ignored.reset(5, 2);
      return ties.add_forces(now, ignored);
    };
    return std::abs((energy(h) - energy(-h)) / (2 * h) - exact);
  };
  const double coarse = error(2e-2), fine = error(1e-2);
  EXPECT_LT(fine, 1e-3 * std::abs(exact));
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
}

TEST(Tie, WrongPairsAreRefused) {
  System system = sewn();
  EXPECT_THROW(TieTerm("ties", {{0, 9, Vec3::Zero(), 1}}, system), InputError);
  EXPECT_THROW(TieTerm("ties", {{2, 0, Vec3::Zero(), 0}}, system), InputError);
  EXPECT_THROW(
      ties_in_reference({{0, 0, 0}}, {{0, 0, 0}}, {{7, 0}}, system.body("leaflets"), system.body("frame"), 1),
      InputError);
}

TEST(Pressure, ClosedSurfaceHasNoResultantAndAFlatOneItsArea) {
  // An octahedron; then a flat rectangle.
  const Points x = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const std::vector<Triangle> closed = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                        {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  System system;
  const Body body = system.add_body("ball", x, std::vector<double>(6, 1));
  const PressureTerm pressure("pressure", closed, body, [](double) { return 100.0; });
  Forces f;
  f.reset(6, 0);
  pressure.add_forces(system.state, f);
  Vec3 total = Vec3::Zero();
  for (const Vec3& g : f.force) total += g;
  EXPECT_LT(total.norm(), 1e-12);
  EXPECT_GT(f.force[4].z(), 0);  // outward

  const ShellMesh mesh = rectangle(4, 3, 4, 3, 0.1);
  System flat;
  const Body sheet = flat.add_body("sheet", mesh.reference, std::vector<double>(mesh.reference.size(), 1));
  const PressureTerm load("load", mesh.triangles, sheet, [](double t) { return 1000 * t; });
  flat.state.time_s = 0.5;
  f.reset(mesh.reference.size(), 0);
  load.add_forces(flat.state, f);
  total.setZero();
  for (const Vec3& g : f.force) total += g;
  EXPECT_NEAR(total.z(), 500 * 12, 1e-9);
}
