#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "coupling/stability.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::coupling;

// A chain of springs with fixed ends: lambda_max = 4 k/m sin^2(n pi / (2 (n + 1))).
void chain(const Points& y, Points& f) {
  for (std::size_t i = 0; i < y.size(); ++i) {
    f[i] = 2 * y[i];
    if (i > 0) f[i] -= y[i - 1];
    if (i + 1 < y.size()) f[i] -= y[i + 1];
  }
}

TEST(PowerIteration, FindsTheLargestEigenvalueOfAChain) {
  const int n = 12;
  PowerIteration power(n);
  power.run(
      chain,
      [](const Points& f, Points& v) {
        for (std::size_t i = 0; i < f.size(); ++i) v[i] = 50 * f[i];
      },
      400);
  const double exact = 200 * std::pow(std::sin(n * M_PI / (2.0 * (n + 1))), 2);
  EXPECT_NEAR(power.eigenvalue() / exact, 1, 1e-6);
  EXPECT_NEAR(power.critical_step(), 2 / std::sqrt(exact), 1e-6);
}

TEST(PowerIteration, IsABoundFromBelowThatGrows) {
  PowerIteration power(30);
  const Operator same = [](const Points& f, Points& v) { v = f; };
  double last = 0;
  for (int i = 0; i < 40; ++i) {
    const double now = power.run(chain, same, 1);
    EXPECT_GE(now, last * (1 - 1e-12));
    EXPECT_LT(now, 4);
    last = now;
  }
}

TEST(PowerIteration, ARestartContinuesBitwise) {
  const Operator same = [](const Points& f, Points& v) { v = f; };
  PowerIteration one(20), two(20);
  one.run(chain, same, 5);
  two.restore(one.direction(), one.eigenvalue());
  EXPECT_EQ(one.run(chain, same, 3), two.run(chain, same, 3));
}

// Two springs that know nothing of each other: a warm start on the one does not see the other stiffen.
TEST(PowerIteration, FindsANewModeAlongTheMotion) {
  double second = 1;
  const Operator springs = [&](const Points& y, Points& f) { f = {10 * y[0], second * y[1]}; };
  const Operator same = [](const Points& f, Points& v) { v = f; };
  PowerIteration power(2);
  power.run(springs, same, 60);
  EXPECT_NEAR(power.eigenvalue(), 10, 1e-9);
  second = 15;
  EXPECT_NEAR(power.run(springs, same, 2), 10, 1e-9);
  const Points motion{Vec3::Zero(), Vec3(1e-3, 0, 0)};
  EXPECT_NEAR(power.look_along(motion, springs, same, 1), 15, 1e-9);
  EXPECT_NEAR(power.run(springs, same, 2), 15, 1e-9);
  EXPECT_NEAR(power.look_along({Vec3(1, 0, 0), Vec3::Zero()}, springs, same, 3), 15, 1e-9);
}

TEST(PowerIteration, NoStiffnessNoLimit) {
  PowerIteration power(3);
  power.run(
      [](const Points&, Points& f) {
        for (Vec3& v : f) v.setZero();
      },
      [](const Points& f, Points& v) { v = f; }, 2);
  EXPECT_EQ(power.critical_step(), std::numeric_limits<double>::infinity());
}

TEST(NextStep, ObeysEveryLimit) {
  const StepLimits limits;
  EXPECT_DOUBLE_EQ(next_step(limits, 1, 0, 1, 0), limits.largest_s);
  EXPECT_DOUBLE_EQ(next_step(limits, 4e-5, 0, 1, 0), 0.85 * 4e-5);
  EXPECT_DOUBLE_EQ(next_step(limits, 1, 1e4, 1, 0), 0.35e-4);
  EXPECT_DOUBLE_EQ(next_step(limits, 1, 0, 1, 1e-5), 1.3e-5);
  EXPECT_THROW(next_step(limits, 1e-9, 0, 1, 0), NumericalFailure);
  EXPECT_THROW(next_step(limits, std::nan(""), 0, 1, 0), NumericalFailure);
}

}  // namespace
