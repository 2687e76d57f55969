// Superelastic beams: fibres over the section, with their history.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "beam_networks.hpp"
#include "core/errors.hpp"
#include "meshes.hpp"
#include "structure/integrator.hpp"

using namespace valsalva;
using namespace valsalva::structure;

namespace {

BeamMaterial alloy(FibreGrid grid = {}) {
  const materials::SuperelasticParameters& p = materials::superelastic_set("nitinol-62.9");
  return {0, 0, 6.45e-3, std::make_shared<materials::Superelastic>(p), grid};
}

BeamMaterial austenite() {
  const materials::SuperelasticParameters& p = materials::superelastic_set("nitinol-62.9");
  return {p.austenite_Pa, p.poisson, 6.45e-3};
}

struct Scene {
  System system;
  std::shared_ptr<BeamNetwork> network;
  std::shared_ptr<BeamTerm> term;
  Scene(const BeamMesh& mesh, const BeamMaterial& material)
      : network(std::make_shared<BeamNetwork>(mesh, material)) {
    const Body body = system.add_rotational_body(
        "frame", mesh.reference, network->lumped_mass(),
        Rotations(mesh.reference.size(), Eigen::Quaterniond::Identity()), network->lumped_inertia());
    term = std::make_shared<BeamTerm>(network, body);
  }
};

// A cantilever that is thrown upwards hard enough to transform.
Scene thrown(double speed) {
  BeamMesh mesh;
  for (int i = 0; i <= 6; ++i) mesh.reference.emplace_back(0.5 * i, 0, 0);
  for (int i = 0; i < 6; ++i) mesh.elements.push_back({i, i + 1});
  mesh.width_mm.assign(6, 0.25);
  mesh.depth_mm.assign(6, 0.3);
  mesh.depth_axis.assign(6, Vec3::UnitZ());
  Scene scene(mesh, alloy({3, 5, 2}));
  scene.system.hold(0);
  for (int i = 1; i <= 6; ++i) scene.system.state.v[i] = Vec3(0, 0.3, 1) * speed * i / 6;
  return scene;
}

IntegratorSettings with_step(double step) {
  IntegratorSettings s;
  s.step_s = step;
  s.mass_scaling = false;
  s.scaling_interval = 1;
  s.speed_limit_mm_per_s = 1e7;
  return s;
}

}  // namespace

TEST(BeamFibres, NoLoadIsExactlyZeroForce) {
  const BeamNetwork beams(crossing(), alloy());
  const Response r =
      respond(beams, beams.mesh().reference, Rotations(beams.nodes(), Eigen::Quaterniond::Identity()));
  EXPECT_EQ(r.energy, 0);
  for (int a = 0; a < beams.nodes(); ++a) {
    EXPECT_EQ(r.force[a], Vec3::Zero());
    EXPECT_EQ(r.moment[a], Vec3::Zero());
  }
}

TEST(BeamFibres, BelowTransformationTheyAreTheLinearBeam) {
  const BeamNetwork fibres(crossing(), alloy({2, 2, 2})), linear(crossing(), austenite());
  const Points x = shaken(linear.mesh().reference, 1e-3, 1);
  const Rotations r = turned(x.size(), 1e-3, 2);
  const Response a = respond(fibres, x, r), b = respond(linear, x, r);
  EXPECT_NEAR(a.energy, b.energy, 1e-11 * b.energy);
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_LT((a.force[i] - b.force[i]).norm(), 1e-11 * largest(b.force));
    EXPECT_LT((a.moment[i] - b.moment[i]).norm(), 1e-11 * largest(b.moment));
  }
}

TEST(BeamFibres, ForcesAreTheGradientOfStoredAndDissipatedEnergy) {
  // From one history the increment has a potential: what is stored plus what has been dissipated since.
  const BeamNetwork beams(crossing(), alloy());
  const Points start = shaken(beams.mesh().reference, 0.04, 7), x = shaken(start, 0.01, 1);
  const Rotations from = turned(x.size(), 0.1, 8), r = turned(x.size(), 0.08, 2);
  FibreHistory history = beams.rest();
  beams.advance(start, from, history);
  EXPECT_GT(history.dissipated_nJ, 0);
  const Points dx = shaken(Points(x.size(), Vec3::Zero()), 0.1, 3),
               dr = shaken(Points(x.size(), Vec3::Zero()), 0.1, 4);
  const Response at = respond(beams, x, r, &history);
  double exact = 0;
  for (std::size_t a = 0; a < x.size(); ++a) exact -= at.force[a].dot(dx[a]) + at.moment[a].dot(dr[a]);
  const auto error = [&](double h) {
    const auto potential = [&](double s) {
      Points y = x;
      Rotations q = r;
      for (std::size_t a = 0; a < x.size(); ++a) {
        y[a] += s * dx[a];
        q[a] = exponential(s * dr[a]) * r[a];
      }
      FibreHistory then = history;
      beams.advance(y, q, then);
      return respond(beams, y, q, &history).energy + then.dissipated_nJ;
    };
    return std::abs((potential(h) - potential(-h)) / (2 * h) - exact);
  };
  const double coarse = error(4e-3), fine = error(1e-3);
  EXPECT_LT(fine, 1e-4 * std::abs(exact));
  EXPECT_GT(std::log2(coarse / fine) / 2, 1.7);  // second order, disturbed by fibres that start to transform
}

TEST(BeamFibres, TangentIsTheDerivativeOfTheForces) {
  for (const bool superelastic : {false, true}) {
    Scene scene(crossing(), superelastic ? alloy() : austenite());
    const int n = scene.network->nodes();
    Configuration& now = scene.system.state;
    now.x = shaken(scene.network->mesh().reference, 0.04, 7);
    now.rotation = turned(n, 0.1, 8);
    scene.term->begin_step(now, 1);
    now.x = shaken(now.x, 0.01, 9);
    BlockMatrix k(n, n);
    scene.term->add_tangent(now, k);
    const auto error = [&](double h) {
      Eigen::VectorXd u(6 * n), difference(6 * n);
      std::mt19937 random(5);
      std::uniform_real_distribution<double> uniform(-1, 1);
      for (double& value : u) value = uniform(random);
      for (int side : {0, 1}) {
        Configuration there = now;
        for (int a = 0; a < n; ++a) {
          const double s = (side ? -h : h);
          there.x[a] += s * u.segment<3>(3 * a);
          there.rotation[a] = exponential(s * u.segment<3>(3 * (n + a))) * now.rotation[a];
        }
        Forces f;
        f.reset(n, n);
        scene.term->add_forces(there, f);
        for (int a = 0; a < n; ++a) {
          const double sign = side ? 1 : -1;
          if (side == 0) difference.segment<3>(3 * a).setZero(), difference.segment<3>(3 * (n + a)).setZero();
          difference.segment<3>(3 * a) += sign * f.force[a] / (2 * h);
          difference.segment<3>(3 * (n + a)) += sign * f.moment[a] / (2 * h);
        }
      }
      const Eigen::VectorXd ku = k.times(u);
      return (ku - difference).norm() / ku.norm();
    };
    if (superelastic) {
      EXPECT_LT(error(1e-6), 1e-5);  // small enough that no fibre changes its branch
    } else {
      EXPECT_LT(error(1e-3), 1e-3);
      EXPECT_NEAR(std::log2(error(2e-3) / error(1e-3)), 2, 0.1);
    }
  }
}

TEST(BeamFibres, FrameIndifferenceAndBalance) {
  const BeamNetwork beams(crossing(), alloy());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.2, Vec3(1, 2, -1).normalized()));
  const Points x = shaken(beams.mesh().reference, 0.05, 5);
  const Rotations r = turned(x.size(), 0.1, 6);
  Rotations too;
  for (const auto& q : r) too.push_back(turn * q);
  const Response one = respond(beams, x, r), two = respond(beams, moved(x, turn, Vec3(10, -20, 5)), too);
  EXPECT_NEAR(one.energy, two.energy, 1e-9 * one.energy);
  Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t a = 0; a < x.size(); ++a) {
    EXPECT_LT((turn * one.force[a] - two.force[a]).norm(), 1e-8 * largest(one.force));
    force += one.force[a];
    moment += x[a].cross(one.force[a]) + one.moment[a];
  }
  EXPECT_LT(force.norm(), 1e-9 * largest(one.force));
  EXPECT_LT(moment.norm(), 1e-8 * largest(one.force));
}

TEST(BeamFibres, StiffnessBoundCoversTheTangentAtAnyState) {
  Scene scene(crossing(), alloy());
  const int n = scene.network->nodes();
  Configuration& now = scene.system.state;
  for (const double size : {0.0, 0.02}) {
    now.x = shaken(scene.network->mesh().reference, size, 3);
    now.rotation = turned(n, 2 * size, 4);
    BlockMatrix k(n, n);
    scene.term->add_tangent(now, k);
    StiffnessBound bound;
    bound.reset(n, n);
    scene.term->add_stiffness_bound(now, bound);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6 * n, 6 * n);
    for (int i = 0; i < 2 * n; ++i)
      for (std::size_t c = 0; c < k.row(i).columns.size(); ++c)
        dense.block<3, 3>(3 * i, 3 * k.row(i).columns[c]) = k.row(i).blocks[c];
    Eigen::VectorXd root(6 * n);
    double claimed = 0;
    for (int a = 0; a < n; ++a) {
      const double mass = scene.system.mass(a), inertia = scene.system.inertia(a);
      root.segment<3>(3 * a).setConstant(1 / std::sqrt(mass));
      root.segment<3>(3 * (n + a)).setConstant(1 / std::sqrt(inertia));
      claimed = std::max({claimed, bound.translation[a] / mass, bound.rotation[a] / inertia});
    }
    const Eigen::MatrixXd scaled =
        root.asDiagonal() * (0.5 * (dense + dense.transpose())) * root.asDiagonal();
    EXPECT_GE(claimed, Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues().maxCoeff());
  }
}

TEST(BeamFibres, ARefusedStepLeavesNothingBehind) {
  Scene scene(crossing(), alloy());
  const int n = scene.network->nodes();
  Configuration& now = scene.system.state;
  now.x = shaken(scene.network->mesh().reference, 0.04, 7);
  const Configuration accepted = now;
  const Snapshot before = scene.term->save();
  scene.term->begin_step(now, 1);  // a step begins ...
  EXPECT_NE(scene.term->save(), before);
  Forces f;
  now.x = shaken(now.x, 0.1, 8);
  for (int trial = 0; trial < 3; ++trial) {  // ... its trials do not touch the history ...
    f.reset(n, n);
    scene.term->add_forces(now, f);
  }
  now = accepted;
  scene.term->restore(before);  // ... and refusing it restores what was.
  EXPECT_EQ(scene.term->save(), before);
  scene.term->begin_step(now, 1);
  const Snapshot again = scene.term->save();
  Scene fresh(crossing(), alloy());
  fresh.term->begin_step(accepted, 1);
  EXPECT_EQ(fresh.term->save(), again);
}

TEST(BeamFibres, EnergyBalanceHoldsWithDissipationToSecondOrder) {
  const auto imbalance = [](double step) {
    Scene scene = thrown(8e4);
    Integrator integrator(scene.system, {scene.term}, with_step(step));
    double first = 0, worst = 0;
    for (int i = 0; scene.system.state.time_s < 1.2e-4; ++i) {
      integrator.step();
      // At the half step: kinetic energy there, stored and dissipated as the means of both sides.
      const double stored = integrator.energies().stored, lost = scene.term->dissipated_nJ();
      Forces f;
      f.reset(scene.system.nodes(), scene.system.rotational_nodes());
      FibreHistory then = scene.term->history();
      const Configuration& now = scene.system.state;
      scene.network->advance(now.x, now.rotation, then);
      const double next = scene.term->add_forces(now, f);
      const double total =
          integrator.energies().kinetic + 0.5 * (stored + next) + 0.5 * (lost + then.dissipated_nJ);
      if (i == 0) first = total;
      worst = std::max(worst, std::abs(total - first) / first);
    }
    EXPECT_GT(scene.term->dissipated_nJ(), 0.05 * first);
    EXPECT_GT(scene.term->largest_martensite(), 0.1);
    return worst;
  };
  const double coarse = imbalance(2e-8), fine = imbalance(1e-8);
  EXPECT_LT(fine, 0.01);
  EXPECT_GT(std::log2(coarse / fine), 1.7);
}

TEST(BeamFibres, RestartBitForBit) {
  Scene whole = thrown(8e4), first = thrown(8e4), second = thrown(8e4);
  Integrator one(whole.system, {whole.term}, with_step(2e-8)),
      two(first.system, {first.term}, with_step(2e-8)), three(second.system, {second.term}, with_step(2e-8));
  for (int i = 0; i < 3000; ++i) one.step();
  for (int i = 0; i < 1700; ++i) two.step();
  three.restore(two.save());
  for (int i = 1700; i < 3000; ++i) three.step();
  EXPECT_GT(whole.term->largest_martensite(), 0.1);
  EXPECT_EQ(one.save(), three.save());
}

TEST(BeamFibres, BadInputIsNamed) {
  EXPECT_THROW(BeamNetwork(crossing(), alloy({0, 5, 2})), InputError);
  EXPECT_THROW(BeamNetwork(crossing(), alloy({5, 5, 21})), InputError);
  BeamMesh sheared = crossing();
  sheared.shear_area_mm2.assign(5, 0.1);
  EXPECT_THROW(BeamNetwork(sheared, alloy()), InputError);
  Scene scene(crossing(), alloy()), linear(crossing(), austenite());
  EXPECT_THROW(scene.term->restore(linear.term->save()), InputError);
  FibreHistory wrong;
  wrong.fibre.resize(3);
  EXPECT_THROW(BeamTerm(scene.network, scene.system.body("frame"), wrong), InputError);
}
