// Friction between bodies: Coulomb's limit, stick, balance, history; and the tangent of contact.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <optional>
#include <random>

#include "core/errors.hpp"
#include "scenes.hpp"
#include "structure/integrator.hpp"

namespace valsalva::contact {
namespace {

using test::at;
using test::forces_for;

constexpr double K = 2e5, mu = 0.4, h = 0.1;

/// A small sheet pressed on a larger one, corners off the lattice of the other.
struct Stack {
  test::Sheet lower = test::sheet(6, 0.5, 0), upper = test::sheet(2, 0.43, 0);
  Points x;
  CollisionMesh mesh;
  int half;

  explicit Stack(double gap = 0.06)
      : x([&] {
          Points all = lower.points;
          // Turned, so that no edge is parallel to one of the other sheet.
          const Eigen::AngleAxisd turn(0.2, Vec3::UnitZ());
          for (const Vec3& p : upper.points) all.push_back(turn * p + Vec3(1.1, 1.03, gap));
          return all;
        }()),
        mesh(x),
        half(int(lower.points.size())) {
    mesh.add_shell({"lower", 0}, 0, lower.triangles, std::vector<double>(lower.points.size(), 0.5 * h));
    mesh.add_shell({"upper", 1}, half, upper.triangles, std::vector<double>(upper.points.size(), 0.5 * h));
    smooth.emplace(contact(0));
  }
  BodyContact contact(double friction = mu, bool even = false) const {
    Candidates candidates(mesh, {K, 0.9, 0.3, 0.05});
    candidates.set_pair("lower", "lower", {false});
    candidates.set_pair("upper", "upper", {false});
    candidates.set_pair("lower", "upper", {true, 0, 0, friction, even});
    return BodyContact(std::move(candidates), Law::barrier);
  }
  Points moved(const Vec3& by) const {
    Points y = x;
    for (std::size_t i = half; i < y.size(); ++i) y[i] += by;
    return y;
  }
  /// What friction adds to the forces: inclined pairs have tangential normal forces of their own.
  Vec3 friction(const BodyContact& contact, const Points& y) const {
    return on_upper(contact.forces(y)) - on_upper(smooth->forces(y));
  }
  std::optional<BodyContact> smooth;
  /// Total force on the upper sheet.
  Vec3 on_upper(const Points& force) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = half; i < force.size(); ++i) sum += force[i];
    return sum;
  }
};

TEST(BodyFriction, TetherGrowsToCoulombsLimitAndStaysThere) {
  Stack stack;
  BodyContact contact = stack.contact();
  contact.begin_step(at(stack.x), 1);
  EXPECT_EQ(stack.friction(contact, stack.x), Vec3(Vec3::Zero()));
  const double range = 0.05 * h;
  for (double way : {0.25, 0.5, 0.999}) {  // elastic
    const Points y = stack.moved(Vec3(way * range, 0, 0));
    const double normal = stack.on_upper(contact.forces(y)).z();
    EXPECT_NEAR(-stack.friction(contact, y).x(), way * mu * normal, 0.01 * mu * normal);
    EXPECT_EQ(contact.report().slipping, 0);
  }
  const Points y = stack.moved(3 * range * Vec3(0.6, 0.8, 0));
  const double normal = stack.on_upper(contact.forces(y)).z();
  const Vec3 slip = stack.friction(contact, y);
  EXPECT_NEAR(slip.x(), -0.6 * mu * normal, 0.03 * mu * normal);  // pairs that are new have no grip yet
  EXPECT_NEAR(slip.y(), -0.8 * mu * normal, 0.03 * mu * normal);
  EXPECT_NEAR(slip.z(), 0, 1e-9 * normal);
}

TEST(BodyFriction, AcceptedSlipIsKeptAndItsWorkIsCounted) {
  Stack stack;
  BodyContact contact = stack.contact();
  const double range = 0.05 * h, way = 0.02;
  contact.begin_step(at(stack.x), 1);
  double work = 0, before = 0;
  for (int i = 1; i <= 100; ++i) {
    const Points y = stack.moved(Vec3(way * i / 100, 0, 0));
    contact.begin_step(at(y), 1);
    const double now = -stack.friction(contact, y).x();
    work += 0.5 * (before + now) * way / 100;
    before = now;
  }
  const double elastic = 0.5 * before * range;
  EXPECT_NEAR(contact.friction_work_nJ(), work - elastic, 0.03 * work);
  const auto pulled = [&](double back) {
    const Points y = stack.moved(Vec3(way - back, 0, 0));
    return stack.friction(contact, y).x() / (mu * stack.on_upper(contact.forces(y)).z());
  };
  EXPECT_NEAR(pulled(0), -1, 0.03);
  EXPECT_NEAR(pulled(range), 0, 0.05);        // unloads elastically,
  EXPECT_NEAR(pulled(2.5 * range), 1, 0.05);  // then slips the other way
}

TEST(BodyFriction, SlidingOverManyTrianglesKeepsTheFullFriction) {
  Stack stack;
  BodyContact contact = stack.contact();
  contact.begin_step(at(stack.x), 1);
  double least = 1e9, most = 0;
  for (int i = 1; i <= 300; ++i) {  // 0.9 mm, two of the lower sheet's cells
    const Points y = stack.moved(0.003 * i * Vec3(0.8, 0.6, 0));
    contact.begin_step(at(y), 1);
    if (i < 6) continue;
    const double normal = stack.on_upper(contact.forces(y)).z();
    const double ratio = -stack.friction(contact, y).dot(Vec3(0.8, 0.6, 0)) / (mu * normal);
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  EXPECT_GT(least, 0.98);
  EXPECT_LT(most, 1 + 1e-9);
}

TEST(BodyFriction, ActionIsReactionAndTheMomentIsThatOfTheGap) {
  Stack stack;
  BodyContact contact = stack.contact();
  contact.begin_step(at(stack.x), 1);
  const Points y = stack.moved(Vec3(0.003, -0.002, 0.001)), force = contact.forces(y);
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  double scale = 0;
  for (std::size_t i = 0; i < y.size(); ++i) {
    sum += force[i];
    moment += y[i].cross(force[i]);
    scale += force[i].norm();
  }
  EXPECT_LT(sum.norm(), 1e-13 * scale);
  // Two flat layers at the distance d: about axes in their plane the moment is that of d e_z x f.
  const Vec3 expected = 0.061 * Vec3::UnitZ().cross(stack.friction(contact, y));
  EXPECT_LT((moment - expected).head<2>().norm(), 1e-10 * scale);
}

TEST(BodyFriction, ARigidMotionOfBothIsNoSlip) {
  Stack stack;
  BodyContact contact = stack.contact();
  contact.begin_step(at(stack.x), 1);
  const double normal = stack.on_upper(contact.forces(stack.x)).z();
  Points y = stack.x;
  const Eigen::AngleAxisd turn(0.3, Vec3(1, 2, 0).normalized());
  for (Vec3& p : y) p = turn * p + Vec3(3, 2, 1);
  EXPECT_LT(stack.friction(contact, y).norm(), 1e-9 * mu * normal);
}

TEST(BodyFriction, ARefusedStepLeavesNothingBehind) {
  Stack stack;
  BodyContact contact = stack.contact();
  contact.begin_step(at(stack.x), 1);
  contact.begin_step(at(stack.moved(Vec3(0.004, 0, 0))), 1);
  const structure::Snapshot before = contact.save();
  contact.begin_step(at(stack.moved(Vec3(0.008, 0.001, 0))), 1);
  contact.forces(stack.moved(Vec3(0.5, 0.5, 0.01)));
  EXPECT_NE(contact.save(), before);
  contact.restore(before);
  EXPECT_EQ(contact.save(), before);
  BodyContact fresh = stack.contact();
  fresh.begin_step(at(stack.x), 1);
  fresh.begin_step(at(stack.moved(Vec3(0.004, 0, 0))), 1);
  const Points y = stack.moved(Vec3(0.0045, 0, 0));
  EXPECT_EQ(contact.forces(y), fresh.forces(y));
}

TEST(BodyFriction, RestartBitForBit) {
  const auto build = [](structure::System& system, const Stack& stack) {
    system.add_body("both", stack.x, std::vector<double>(stack.x.size(), 1e-4));
    for (int i = 0; i < stack.half; ++i) system.hold(i);
    for (std::size_t i = stack.half; i < stack.x.size(); ++i) system.state.v[i] = Vec3(60, 20, -30);
    return std::make_shared<BodyContact>(stack.contact());
  };
  structure::IntegratorSettings settings;
  settings.step_s = 2e-6;
  const Stack stack;
  structure::System one, two, three;
  const auto c1 = build(one, stack), c2 = build(two, stack), c3 = build(three, stack);
  structure::Integrator whole(one, {c1}, settings), first(two, {c2}, settings), second(three, {c3}, settings);
  for (int i = 0; i < 400; ++i) whole.step();
  for (int i = 0; i < 170; ++i) first.step();
  second.restore(first.save());
  for (int i = 170; i < 400; ++i) second.step();
  EXPECT_GT(c1->friction_work_nJ(), 0);
  EXPECT_EQ(whole.save(), second.save());
}

TEST(BodyFriction, WithoutACoefficientNothingIsStored) {
  Stack stack;
  BodyContact contact = stack.contact(0);
  contact.begin_step(at(stack.x), 1);
  EXPECT_TRUE(contact.save().empty());
  EXPECT_EQ(contact.friction_work_nJ(), 0);
  EXPECT_THROW(BodyContact(Candidates(stack.mesh, {K, 0.9, 0.3, 0.05}), Law::barrier, 0), InputError);
}

/// K u against central differences of the forces; the error at a step.
double tangent_error(const BodyContact& contact, const Points& x, double step) {
  const auto now = at(x);
  structure::BlockMatrix k(x.size(), 0);
  contact.add_tangent(now, k);
  std::mt19937 random(12);
  std::normal_distribution<double> normal;
  Eigen::VectorXd u(3 * x.size()), change(3 * x.size());
  for (double& value : u) value = normal(random);
  const auto force = [&](double s) {
    Points y = x;
    for (std::size_t i = 0; i < x.size(); ++i) y[i] += s * u.segment<3>(3 * i);
    Eigen::VectorXd f(3 * x.size());
    const Points all = contact.forces(y);
    for (std::size_t i = 0; i < x.size(); ++i) f.segment<3>(3 * i) = all[i];
    return f;
  };
  change = (force(-step) - force(step)) / (2 * step);
  return (k.times(u) - change).norm() / change.norm();
}

Points rough(const Points& x, double size) {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> uniform(-size, size);
  Points y = x;
  for (Vec3& p : y) p += Vec3(uniform(random), uniform(random), uniform(random));
  return y;
}

TEST(ContactTangent, IsTheDerivativeOfTheNormalForcesToSecondOrder) {
  for (bool even : {false, true}) {
    Stack stack;
    BodyContact contact = stack.contact(0, even);
    const Points x = rough(stack.x, 0.012);
    contact.begin_step(at(x), 1);
    EXPECT_GT(tangent_error(contact, x, 1e-5), 0);
    const double coarse = tangent_error(contact, x, 2e-5), fine = tangent_error(contact, x, 1e-5);
    EXPECT_LT(fine, 1e-4);
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.3);
  }
}

TEST(EvenContact, ForcesAreTheGradientAndSumToZero) {
  Stack stack;
  BodyContact contact = stack.contact(0, true);
  const Points x = rough(stack.x, 0.012), force = contact.forces(x);
  std::mt19937 random(31);
  std::normal_distribution<double> normal;
  Points u(x.size());
  double slope = 0, size = 0, error[2];
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    u[i] = Vec3(normal(random), normal(random), normal(random));
    slope -= u[i].dot(force[i]);
    sum += force[i];
    moment += x[i].cross(force[i]);
    size += force[i].norm();
  }
  EXPECT_LT(sum.norm(), 1e-13 * size);
  EXPECT_LT(moment.norm(), 1e-13 * size);
  const auto energy = [&](double t) {
    Points y = x;
    for (std::size_t i = 0; i < y.size(); ++i) y[i] += t * u[i];
    auto ignored = forces_for(at(y));
    return contact.add_forces(at(y), ignored);
  };
  for (int level = 0; level < 2; ++level) {
    const double step = level == 0 ? 4e-6 : 2e-6;
    error[level] = std::abs((energy(step) - energy(-step)) / (2 * step) - slope) / std::abs(slope);
  }
  EXPECT_LT(error[1], 1e-5);
  EXPECT_NEAR(error[0] / error[1], 4, 0.6);
}

/// A small triangle above the middle of an edge of a flat mesh, and on both sides of it: what pushes aside.
TEST(EvenContact, APointOverAFlatMeshIsNotPushedAside) {
  const test::Sheet lower = test::sheet(4, 0.5, 0);
  Points x = lower.points;
  const int first = int(x.size());
  for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(2, 0.1, 2), Vec3(0.1, 2, 2)}) x.push_back(corner);
  double aside[2] = {0, 0};
  for (bool even : {false, true}) {
    CollisionMesh mesh(x);
    mesh.add_shell({"lower", 0}, 0, lower.triangles, std::vector<double>(lower.points.size(), 0.5 * h));
    mesh.add_shell({"tip", 1}, first, {{0, 1, 2}}, std::vector<double>(3, 0.5 * h));
    Candidates candidates(mesh, {K, 0.9, 0.3, 0.05});
    candidates.set_pair("lower", "lower", {false});
    candidates.set_pair("tip", "tip", {false});
    candidates.set_pair("lower", "tip", {true, 0, 0, 0, even});
    BodyContact contact(std::move(candidates), Law::barrier);
    for (int i = 0; i <= 40; ++i) {
      Points y = x;
      for (int k = 0; k < 3; ++k) y[first + k] += Vec3(0.6 + 0.01 * i, 0.8 + 0.0025 * i, 0.06);
      Vec3 on_tip = Vec3::Zero();
      const Points force = contact.forces(y);
      for (int k = 0; k < 3; ++k) on_tip += force[first + k];
      aside[even] = std::max(aside[even], on_tip.head<2>().norm() / on_tip.z());
    }
  }
  std::printf("a tip over a flat mesh: pushed aside %.3f of the normal force, %.3f when even\n", aside[0],
              aside[1]);
  EXPECT_GT(aside[0], 0.05);
  EXPECT_LT(aside[1], 0.3 * aside[0]);
}

TEST(EvenContact, FlatLayersArePushedAsideLess) {
  Stack stack;
  double square[2] = {0, 0}, most[2] = {0, 0};
  constexpr int places = 400;
  for (bool even : {false, true}) {
    BodyContact contact = stack.contact(0, even);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-0.5, 0.5);
    for (int i = 0; i < places; ++i) {
      const Vec3 force =
          stack.on_upper(contact.forces(stack.moved(Vec3(uniform(random), uniform(random), 0))));
      const double aside = force.head<2>().norm() / force.z();
      square[even] += aside * aside / places;
      most[even] = std::max(most[even], aside);
    }
  }
  std::printf(
      "flat layers: pushed aside, of the normal force: root mean square %.4f, most %.4f; even %.4f, %.4f\n",
      std::sqrt(square[0]), most[0], std::sqrt(square[1]), most[1]);
  EXPECT_LT(square[1], 0.25 * square[0]);
}

TEST(EvenContact, FrictionIsWhatItPressesTimesTheCoefficient) {
  Stack stack;
  BodyContact rubbing = stack.contact(mu, true), smooth = stack.contact(0, true);
  rubbing.begin_step(at(stack.x), 1);
  double least = 1e9, most = 0;
  for (int i = 1; i <= 300; ++i) {
    const Points y = stack.moved(0.003 * i * Vec3(0.8, 0.6, 0));
    rubbing.begin_step(at(y), 1);
    if (i < 6) continue;
    const Vec3 normal = stack.on_upper(smooth.forces(y));
    const Vec3 friction = stack.on_upper(rubbing.forces(y)) - normal;
    const double ratio = -friction.dot(Vec3(0.8, 0.6, 0)) / (mu * normal.z());
    least = std::min(least, ratio);
    most = std::max(most, ratio);
  }
  std::printf("even contact: friction %.4f to %.4f of mu N\n", least, most);
  EXPECT_GT(least, 0.98);
  EXPECT_LT(most, 1.02);
}

TEST(ContactTangent, OfFrictionWhereItSticksAndWhereItSlips) {
  for (double way : {0.002, 0.012}) {
    Stack stack;
    stack.x = rough(stack.x, 1e-3);
    BodyContact contact = stack.contact();
    contact.begin_step(at(stack.x), 1);
    contact.begin_step(at(stack.moved(Vec3(0.5 * way, 0, 0))), 1);
    const Points x = stack.moved(Vec3(way, 0.2 * way, 0));
    contact.forces(x);
    EXPECT_EQ(contact.report().slipping > 0, way > 0.005);
    // What is left out: the change of the normal and of the nearest points in friction.
    const double error = tangent_error(contact, x, 1e-7);
    EXPECT_LT(error, 0.1) << way;
  }
}

}  // namespace
}  // namespace valsalva::contact
