#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "beam_networks.hpp"
#include "core/errors.hpp"
#include "meshes.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

BeamNetwork network() {
  return {crossing(), {5e10, 0.33, 6.45e-3}};
}

BeamNetwork straight(double length, int count, double width, double depth, double young, double poisson) {
  BeamMesh mesh;
  for (int i = 0; i <= count; ++i) mesh.reference.emplace_back(length * i / count, 0, 0);
  for (int i = 0; i < count; ++i) mesh.elements.push_back({i, i + 1});
  mesh.width_mm.assign(count, width);
  mesh.depth_mm.assign(count, depth);
  mesh.depth_axis.assign(count, Vec3::UnitZ());
  return {mesh, {young, poisson, 1e-3}};
}

}  // namespace

TEST(Beam, NoLoadIsExactlyZeroForce) {
  for (const BeamNetwork& beams : {network(), straight(1.0 / 3, 7, 0.1, 0.3, 1e11, 0.3)}) {
    const Rotations identity(beams.nodes(), Eigen::Quaterniond::Identity());
    const Response r = respond(beams, beams.mesh().reference, identity);
    EXPECT_EQ(r.energy, 0);
    for (int a = 0; a < beams.nodes(); ++a) {
      EXPECT_EQ(r.force[a], Vec3::Zero());
      EXPECT_EQ(r.moment[a], Vec3::Zero());
    }
  }
}

TEST(Beam, ForceAndMomentAreTheGradientOfTheEnergyToSecondOrder) {
  const BeamNetwork beams = network();
  const Points x = shaken(beams.mesh().reference, 0.15, 1);
  const Rotations r = turned(x.size(), 0.3, 2);
  const Points dx = shaken(Points(x.size(), Vec3::Zero()), 1, 3),
               dr = shaken(Points(x.size(), Vec3::Zero()), 1, 4);
  const Response at = respond(beams, x, r);
  double exact = 0;
  for (std::size_t a = 0; a < x.size(); ++a) exact -= at.force[a].dot(dx[a]) + at.moment[a].dot(dr[a]);
  const auto error = [&](double h) {
    const auto energy = [&](double s) {
      Points y = x;
      Rotations q = r;
      for (std::size_t a = 0; a < x.size(); ++a) {
        y[a] += s * dx[a];
        q[a] = exponential(s * dr[a]) * r[a];
      }
      return respond(beams, y, q).energy;
    };
    return std::abs((energy(h) - energy(-h)) / (2 * h) - exact);
  };
  const double coarse = error(1e-2), fine = error(5e-3);
  EXPECT_LT(fine, 1e-2 * std::abs(exact));
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
}

TEST(Beam, FrameIndifferenceAndBalance) {
  const BeamNetwork beams = network();
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.2, Vec3(1, 2, -1).normalized()));
  const Vec3 shift(10, -20, 5);
  const Points x = shaken(beams.mesh().reference, 0.15, 5);
  const Rotations r = turned(x.size(), 0.2, 6);
  Rotations turned_too;
  for (const auto& q : r) turned_too.push_back(turn * q);
  const Response one = respond(beams, x, r), two = respond(beams, moved(x, turn, shift), turned_too);
  EXPECT_NEAR(one.energy, two.energy, 1e-10 * one.energy);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t a = 0; a < x.size(); ++a) {
    EXPECT_LT((turn * one.force[a] - two.force[a]).norm(), 1e-9 * largest(one.force));
    EXPECT_LT((turn * one.moment[a] - two.moment[a]).norm(), 1e-9 * largest(one.moment));
    force += one.force[a];
    moment += x[a].cross(one.force[a]) + one.moment[a];
  }
  EXPECT_LT(force.norm(), 1e-9 * largest(one.force));
  EXPECT_LT(moment.norm(), 1e-8 * largest(one.force));
  // A rigid motion of the reference costs nothing.
  const Rotations rigid(x.size(), turn);
  EXPECT_LT(respond(beams, moved(beams.mesh().reference, turn, shift), rigid).energy, 1e-16 * one.energy);
}

TEST(Beam, PatchTestTensionTorsionAndPureBending) {
  const double length = 6, young = 2e5, nu = 0.25, width = 0.4, depth = 0.2;
  const int count = 6;
  const BeamNetwork beams = straight(length, count, width, depth, young, nu);
  const Points& reference = beams.mesh().reference;
  const Rotations identity(reference.size(), Eigen::Quaterniond::Identity());
  const auto inner_is_free = [&](const Response& r) {
    for (int a = 1; a < count; ++a) {
      EXPECT_LT(r.force[a].norm(), 1e-10 * (1 + largest(r.force)));
      EXPECT_LT(r.moment[a].norm(), 1e-10 * (1 + largest(r.moment)));
    }
  };
  Points x = reference;
  for (Vec3& p : x) p.x() *= 1.01;
  Response r = respond(beams, x, identity);
  inner_is_free(r);
  EXPECT_NEAR(r.force[0].x(), young * width * depth * 0.01, 1e-9 * young);

  Rotations twisted;
  for (const Vec3& p : reference) twisted.emplace_back(Eigen::AngleAxisd(0.02 * p.x(), Vec3::UnitX()));
  r = respond(beams, reference, twisted);
  inner_is_free(r);
  EXPECT_NEAR(r.moment[0].x(), young / (2 * (1 + nu)) * torsion_constant(width, depth) * 0.02, 1e-6);

  // The depth lies along z: bending in the xz plane has I = b d^3/12, in the xy plane d b^3/12.
  for (const bool in_depth : {true, false}) {
    const double radius = 9;
    const double inertia = in_depth ? width * std::pow(depth, 3) / 12 : depth * std::pow(width, 3) / 12;
    const double step = length / count;  // chords of unchanged length
    const double turn = 2 * std::asin(step / (2 * radius));
    Rotations bent;
    Points arc;
    for (int a = 0; a <= count; ++a) {
      const double t = turn * a, s = radius * std::sin(t), c = radius * (1 - std::cos(t));
      arc.push_back(in_depth ? Vec3(s, 0, c) : Vec3(s, c, 0));
      bent.emplace_back(Eigen::AngleAxisd(t, in_depth ? Vec3(-Vec3::UnitY()) : Vec3(Vec3::UnitZ())));
    }
    r = respond(beams, arc, bent);
    inner_is_free(r);
    EXPECT_NEAR(r.moment[0].norm(), young * inertia * turn / step, 1e-9 * young);
    const double strain = beams.element_state(arc, bent, 2).max_strain;
    EXPECT_NEAR(strain, (in_depth ? depth : width) / 2 * turn / step, 1e-9);
  }
}

TEST(Beam, SectionConstants) {
  EXPECT_NEAR(torsion_constant(1, 1), 0.1406, 0.001);      // square: 0.1406 b^4
  EXPECT_NEAR(torsion_constant(2, 1), 0.229 * 2, 0.002);   // tables: 0.229 b d^3
  EXPECT_NEAR(torsion_constant(1, 10), 0.312 * 10, 0.02);  // thin: 0.312 b d^3, either order
}

TEST(Beam, GivenTorsionConstantReplacesTheRectangles) {
  BeamMesh mesh = straight(2, 1, 0.4, 0.2, 2e5, 0.25).mesh();
  mesh.torsion_mm4 = {0.0123};
  const BeamNetwork beams(mesh, {2e5, 0.25, 1e-3});
  Rotations twisted{Eigen::Quaterniond::Identity(),
                    Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Vec3::UnitX()))};
  EXPECT_NEAR(respond(beams, mesh.reference, twisted).moment[0].x(), 8e4 * 0.0123 * 0.1 / 2, 1e-9);
  mesh.torsion_mm4 = {0};
  EXPECT_THROW(BeamNetwork(mesh, {2e5, 0.25, 1e-3}), InputError);
}

TEST(Beam, ShearAreaGivesTimoshenkosDeflection) {
  // One element, small tip load P: w = P L^3/(3 EI) + P L/(G A_s), the tip's slope P L^2/(2 EI).
  const double length = 2, young = 2e5, nu = 0.25, width = 0.4, depth = 0.5;
  BeamMesh mesh = straight(length, 1, width, depth, young, nu).mesh();
  mesh.shear_area_mm2 = {5.0 / 6 * width * depth};
  const BeamNetwork beams(mesh, {young, nu, 1e-3});
  const double inertia = width * std::pow(depth, 3) / 12, shear = young / (2 * (1 + nu));
  const double load = 1e-4;
  const double w =
      load * std::pow(length, 3) / (3 * young * inertia) + load * length / (shear * mesh.shear_area_mm2[0]);
  const double slope = load * length * length / (2 * young * inertia);
  const Points x{mesh.reference[0], mesh.reference[1] + Vec3(0, 0, w)};
  const Response r =
      respond(beams, x,
              {Eigen::Quaterniond::Identity(), Eigen::Quaterniond(Eigen::AngleAxisd(-slope, Vec3::UnitY()))});
  EXPECT_NEAR(-r.force[1].z(), load, 1e-4 * load);
  EXPECT_NEAR(r.moment[1].norm(), 0, 1e-4 * load * length);
  mesh.shear_area_mm2 = {1e30};  // rigid in shear: the same as none, to the last digits
  const Rotations turn = turned(2, 0.1, 7);
  const double stiff = respond({mesh, {young, nu, 1e-3}}, x, turn).energy;
  EXPECT_NEAR(stiff, respond(straight(length, 1, width, depth, young, nu), x, turn).energy, 1e-12 * stiff);
}

TEST(Beam, StiffnessBoundCoversTheLargestEigenvalue) {
  const BeamNetwork beams = network();
  const int n = beams.nodes();
  const Points& x = beams.mesh().reference;
  Eigen::MatrixXd k(6 * n, 6 * n);
  const double h = 1e-6;
  for (int j = 0; j < 6 * n; ++j) {
    const auto pushed = [&](double s) {
      Points y = x;
      Rotations r(n, Eigen::Quaterniond::Identity());
      Vec3 unit = Vec3::Zero();
      unit[j % 3] = s;
      if (j < 3 * n)
        y[j / 3] += unit;
      else
        r[j / 3 - n] = exponential(unit);
      return respond(beams, y, r);
    };
    const Response plus = pushed(h), minus = pushed(-h);
    for (int a = 0; a < n; ++a) {
      k.block<3, 1>(3 * a, j) = (minus.force[a] - plus.force[a]) / (2 * h);
      k.block<3, 1>(3 * (n + a), j) = (minus.moment[a] - plus.moment[a]) / (2 * h);
    }
  }
  StiffnessBound bound;
  bound.reset(n, n);
  beams.add_stiffness_bound(x, bound);
  const std::vector<double> mass = beams.lumped_mass(), inertia = beams.lumped_inertia();
  Eigen::VectorXd root(6 * n);
  double claimed = 0;
  for (int a = 0; a < n; ++a) {
    root.segment<3>(3 * a).setConstant(1 / std::sqrt(mass[a]));
    root.segment<3>(3 * (n + a)).setConstant(1 / std::sqrt(inertia[a]));
    claimed = std::max({claimed, bound.translation[a] / mass[a], bound.rotation[a] / inertia[a]});
  }
  const Eigen::MatrixXd scaled = root.asDiagonal() * (0.5 * (k + k.transpose())) * root.asDiagonal();
  const double exact = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().maxCoeff();
  EXPECT_GE(claimed, exact);
  EXPECT_LT(claimed, 20 * exact);
}

TEST(Beam, BadNetworksAreRefused) {
  BeamMesh mesh = network().mesh();
  mesh.width_mm[2] = 0;
  EXPECT_THROW(BeamNetwork(mesh, {1e9, 0.3, 1e-3}), InputError);
  mesh = network().mesh();
  mesh.elements[1] = {1, 1};
  EXPECT_THROW(BeamNetwork(mesh, {1e9, 0.3, 1e-3}), InputError);
  EXPECT_THROW(BeamNetwork(network().mesh(), {-1e9, 0.3, 1e-3}), InputError);
}
