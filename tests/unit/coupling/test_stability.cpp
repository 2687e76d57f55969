#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <complex>
#include <functional>
#include <limits>

#include "core/errors.hpp"
#include "coupling/immersed_body.hpp"
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

// One mode of a structure that the flow carries along, as ImmersedFlow steps it (stability.hpp):
//   u' = u + N (1.5 u - 0.5 u_before) - Lambda (x + lead u),  x' = x + u',   dt = 1, N = i theta - D
// The largest |z| of its growth factors.
double growth(double lambda, double lead, double theta, double dissipation) {
  const std::complex<double> n(-dissipation, theta);
  Eigen::Matrix3cd step;  // of (x, u, u_before)
  const std::complex<double> on_u = 1.0 + 1.5 * n - lead * lambda, on_before = -0.5 * n;
  step << 1 - lambda, on_u, on_before, -lambda, on_u, on_before, 0, 1, 0;
  return Eigen::ComplexEigenSolver<Eigen::Matrix3cd>(step, false).eigenvalues().cwiseAbs().maxCoeff();
}

double lambda_at(double lead, double safety) {
  return safety * safety * 4 / (1 + 2 * lead);
}

TEST(ModelOfTheStep, TheLimitIsThatOfTheLead) {
  for (double lead : {0.0, 0.25, 0.5}) {
    EXPECT_LE(growth(lambda_at(lead, 0.999), lead, 0, 0), 1 + 1e-9) << lead;
    EXPECT_GT(growth(lambda_at(lead, 1.01), lead, 0, 0), 1.01) << lead;
  }
}

TEST(ModelOfTheStep, AB2LagsAndFeedsWhatTheFlowCarries) {
  const double theta = 1e-4, phi = 2 * std::asin(0.85),
               fed = std::pow(1 - std::cos(phi), 2) / (2 * std::sin(phi));
  EXPECT_NEAR((growth(lambda_at(0, 0.85), 0, theta, 0) - 1) / theta, fed, 1e-3 * fed);
}

TEST(ModelOfTheStep, DissipationLowersTheLimit) {
  const double d = 0.2;
  EXPECT_LE(growth(4 * (1 - d) * 0.99, 0, 0, d), 1);
  EXPECT_GT(growth(4 * (1 - d) * 1.01, 0, 0, d), 1);
}

// The largest growth of waves of so many cells and more, which the flow carries along either way, at the
// steps that next_step plans with a lead by the CFL number.
double worst_growth(const std::function<double(double)>& lead_of, double convection, double cells = 5,
                    double safety = 0.85) {
  double worst = 0;
  for (double cfl : {0.001, 0.003, 0.01, 0.02, 0.035, 0.05, 0.07, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35}) {
    const double lead = lead_of(cfl);
    for (double kh = 0.2; kh <= 2 * M_PI / cells; kh += 0.1)
      for (double theta : {-cfl * kh, cfl * kh})
        for (double share : {0.1, 0.2, 0.4, 0.6, 0.8, 1.0}) {
          const double upwinding = cfl * std::pow(2 - 2 * std::cos(kh), 2) / 12;
          const double lambda = share * lambda_at(lead, safety) * (1 - convection * cfl);
          worst = std::max(worst, growth(lambda, lead, theta, upwinding));
        }
  }
  return worst;
}

double fixed_lead(double) {
  return step_lead;
}
double leaflet_lead(double cfl) {
  return lead_at(cfl, least_step_lead, step_lead);
}

TEST(ModelOfTheStep, WithLeadAndConvectionInTheLimitNoWaveGrows) {
  const double convection = StepLimits{}.convection;
  EXPECT_LE(worst_growth(fixed_lead, convection), 1 + 1e-9);
  EXPECT_GT(worst_growth([](double) { return 0.0; }, convection), 1.02);
  EXPECT_GT(worst_growth(fixed_lead, 0), 1.02);
}

TEST(ModelOfTheStep, AFluidAtRestNeedsLittleLead) {
  const double convection = StepLimits{}.convection;
  EXPECT_EQ(leaflet_lead(0), least_step_lead);
  EXPECT_EQ(leaflet_lead(0.35), step_lead);
  EXPECT_LE(worst_growth(leaflet_lead, convection), 1 + 1e-9);
  EXPECT_GT(worst_growth([](double) { return least_step_lead; }, convection), 1.02);
}

TEST(ModelOfTheStep, ShortWavesGrowAtTheWholeSafetyAndNotAtHalf) {
  const double convection = StepLimits{}.convection, safety = StepLimits{}.safety;
  EXPECT_GT(worst_growth(fixed_lead, convection, 3, safety), 1.02);
  EXPECT_LE(worst_growth(fixed_lead, convection, 3, Calm::least * safety), 1 + 1e-9);
  EXPECT_LE(worst_growth(leaflet_lead, convection, 3, Calm::least * safety), 1 + 1e-9);
}

TEST(Calm, TremblingHalvesTheStepsAndCalmGivesThemBack) {
  Calm calm;
  for (int step = 0; step < 3; ++step) calm.see(2e-3);
  EXPECT_NEAR(calm.factor(), 0.9 * 0.9 * 0.9, 1e-15);
  for (int step = 0; step < 20; ++step) calm.see(1);
  EXPECT_EQ(calm.factor(), 0.5);
  for (int step = 0; step < 200; ++step) calm.see(5e-4);
  EXPECT_NEAR(calm.factor(), 0.5 * std::pow(1.002, 200), 1e-12);
  for (int step = 0; step < 200; ++step) calm.see(0);
  EXPECT_EQ(calm.factor(), 1);
}

TEST(NextStep, ObeysEveryLimit) {
  const StepLimits limits;
  EXPECT_DOUBLE_EQ(next_step(limits, 1, 0, 1, 0), limits.largest_s);
  EXPECT_DOUBLE_EQ(next_step(limits, 4e-5, 0, 1, 0), 0.85 * 4e-5);
  EXPECT_DOUBLE_EQ(next_step(limits, 1, 1e4, 1, 0), 0.35e-4);
  const double near_both = next_step(limits, 4e-5, 5e3, 1, 0);
  EXPECT_NEAR(near_both * near_both, 0.85 * 0.85 * 16e-10 * (1 - limits.convection * 5e3 * near_both), 1e-20);
  EXPECT_DOUBLE_EQ(next_step(limits, 1, 0, 1, 1e-5), 1.3e-5);
  EXPECT_THROW(next_step(limits, 1e-9, 0, 1, 0), NumericalFailure);
  EXPECT_THROW(next_step(limits, std::nan(""), 0, 1, 0), NumericalFailure);
}

}  // namespace
