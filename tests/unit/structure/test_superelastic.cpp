// The one-dimensional superelastic law against closed forms and against its rate equations.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/errors.hpp"
#include "materials/superelastic.hpp"

using namespace valsalva;
using namespace valsalva::materials;

namespace {

const SuperelasticParameters& set() {
  return superelastic_set("nitinol-62.9");
}

double compliance(const SuperelasticParameters& p, double xi) {
  return (1 - xi) / p.austenite_Pa + xi / p.martensite_Pa;
}

// Work per transformed fraction at a stress.
double driving(const SuperelasticParameters& p, double sigma) {
  return 0.5 * (1 / p.martensite_Pa - 1 / p.austenite_Pa) * sigma * sigma + p.transformation_strain * sigma;
}

// Mean of the driving work over a straight line of stress.
double mean_driving(const SuperelasticParameters& p, double a, double b) {
  const double square = (a * a + a * b + b * b) / 3, mean = 0.5 * (a + b);
  return 0.5 * (1 / p.martensite_Pa - 1 / p.austenite_Pa) * square + p.transformation_strain * mean;
}

std::vector<double> random_path(unsigned seed, int turns, double low, double high) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> pick(low, high);
  std::vector<double> path;
  for (int i = 0; i < turns; ++i) path.push_back(pick(random));
  return path;
}

}  // namespace

TEST(SuperelasticLaw, NothingAtRest) {
  const Superelastic law(set());
  const SuperelasticResponse r = law.respond({}, 0);
  EXPECT_EQ(r.state.stress_Pa, 0);
  EXPECT_EQ(r.state.martensite, 0);
  EXPECT_EQ(r.stored_Pa, 0);
  EXPECT_EQ(r.dissipated_Pa, 0);
  EXPECT_DOUBLE_EQ(r.tangent_Pa, set().austenite_Pa);
  // and after a loop
  for (double strain : {0.08, -0.08})
    EXPECT_EQ(law.respond(law.respond({}, strain).state, 0).state.stress_Pa, 0);
}

TEST(SuperelasticLaw, MajorLoopInTensionAndCompressionIsTheClosedForm) {
  for (const SuperelasticSet& one : superelastic_sets()) {
    const SuperelasticParameters& p = one.parameters;
    const Superelastic law(p);
    for (double sign : {1.0, -1.0}) {
      const double c = sign > 0 ? 1 : p.compression_start_Pa / p.loading_start_Pa;
      const auto at = [&](double from, double to, double share) {  // strain and stress on a branch
        const double sigma = c * (from + share * (to - from));
        const bool loading = to > from;
        const double xi = loading ? share : 1 - share;
        return std::pair(sigma * compliance(p, xi) + p.transformation_strain * xi, sigma);
      };
      SuperelasticState state;
      for (double share : {0.0, 0.2, 0.5, 0.9, 1.0}) {
        const auto [strain, sigma] = at(p.loading_start_Pa, p.loading_finish_Pa, share);
        const SuperelasticResponse r = law.respond(state, sign * strain);
        EXPECT_NEAR(r.state.stress_Pa, sign * sigma, 1e-9 * sigma);
        EXPECT_NEAR(r.state.martensite, sign * share, 1e-6);
        state = r.state;
      }
      const double strain = p.transformation_strain + 1.2 * c * p.loading_finish_Pa / p.martensite_Pa;
      state = law.respond(state, sign * strain).state;
      EXPECT_NEAR(state.stress_Pa, sign * 1.2 * c * p.loading_finish_Pa, 1e-6 * p.loading_finish_Pa);
      for (double share : {0.0, 0.3, 0.5, 0.8, 1.0}) {
        const auto [back, sigma] = at(p.unloading_start_Pa, p.unloading_finish_Pa, share);
        const SuperelasticResponse r = law.respond(state, sign * back);
        EXPECT_NEAR(r.state.stress_Pa, sign * sigma, 1e-9 * sigma);
        EXPECT_NEAR(r.state.martensite, sign * (1 - share), 1e-6);
        state = r.state;
      }
      state = law.respond(state, sign * 1e-3).state;
      EXPECT_NEAR(state.stress_Pa, sign * 1e-3 * p.austenite_Pa, 1e-6 * p.austenite_Pa * 1e-3);
    }
  }
}

TEST(SuperelasticLaw, StressDoesNotDependOnTheStepsOfAMonotonicPath) {
  const Superelastic law(set());
  SuperelasticState fine, coarse;
  double from = 0, lost_fine = 0, lost_coarse = 0;
  for (double to : random_path(3, 60, -0.08, 0.08)) {
    for (int i = 1; i <= 97; ++i) {
      const SuperelasticResponse r = law.respond(fine, from + (to - from) * i / 97);
      fine = r.state;
      lost_fine += r.dissipated_Pa;
      EXPECT_GE(r.dissipated_Pa, -1e-6);  // of some 1e7 Pa
    }
    const SuperelasticResponse r = law.respond(coarse, to);
    coarse = r.state;
    lost_coarse += r.dissipated_Pa;
    EXPECT_NEAR(fine.stress_Pa, coarse.stress_Pa, 1e-6 * 5e8);
    EXPECT_NEAR(fine.martensite, coarse.martensite, 1e-7);
    from = to;
  }
  EXPECT_NEAR(lost_fine, lost_coarse, 1e-6 * lost_fine);
}

TEST(SuperelasticLaw, InnerLoopsFollowTheRateEquations) {
  // Independent: Heun's method on d sigma/d eps with the rate equations of the fraction, tension only.
  const SuperelasticParameters& p = set();
  const Superelastic law(p);
  const std::vector<double> path = random_path(5, 14, 0.001, 0.065);
  const auto largest_difference = [&](int steps) {
    double sigma = 0, xi = 0, strain = 0, worst = 0;
    SuperelasticState state;
    for (double to : path) {
      const double h = (to - strain) / steps;
      for (int i = 0; i < steps; ++i) {
        const auto slopes = [&](double s, double x) {  // d sigma/d eps, d xi/d eps
          double rate = 0;                             // d xi/d sigma
          if (h > 0 && s > p.loading_start_Pa && s < p.loading_finish_Pa && x < 1)
            rate = (1 - x) / (p.loading_finish_Pa - s);
          if (h < 0 && s < p.unloading_start_Pa && s > p.unloading_finish_Pa && x > 0)
            rate = x / (s - p.unloading_finish_Pa);
          const double soft = 1 / p.martensite_Pa - 1 / p.austenite_Pa;
          const double slope = 1 / (compliance(p, x) + (soft * s + p.transformation_strain) * rate);
          return std::pair(slope, slope * rate);
        };
        const auto [s1, x1] = slopes(sigma, xi);
        const auto [s2, x2] = slopes(sigma + h * s1, xi + h * x1);
        sigma += 0.5 * h * (s1 + s2);
        xi += 0.5 * h * (x1 + x2);
      }
      strain = to;
      state = law.respond(state, to).state;
      worst = std::max(worst, std::abs(sigma - state.stress_Pa));
    }
    return worst;
  };
  const double coarse = largest_difference(2000), fine = largest_difference(32000);
  EXPECT_LT(fine, 1e-3 * p.loading_start_Pa);
  EXPECT_LT(fine, 0.15 * coarse);  // first order at the kinks, a factor 16 of steps
}

TEST(SuperelasticLaw, DissipationOfALoopAndEnergyBalance) {
  const SuperelasticParameters& p = set();
  const Superelastic law(p);
  for (double sign : {1.0, -1.0}) {
    const double c = sign > 0 ? 1 : p.compression_start_Pa / p.loading_start_Pa;
    const double expected = mean_driving(p, c * p.loading_start_Pa, c * p.loading_finish_Pa) -
                            mean_driving(p, c * p.unloading_finish_Pa, c * p.unloading_start_Pa);
    const SuperelasticResponse out = law.respond({}, sign * 0.09), back = law.respond(out.state, 0);
    EXPECT_NEAR(out.dissipated_Pa + back.dissipated_Pa, expected, 1e-9 * expected);
    const double half = mean_driving(p, c * p.loading_start_Pa, c * p.loading_finish_Pa) -
                        driving(p, 0.5 * c * (p.loading_start_Pa + p.unloading_start_Pa));
    EXPECT_NEAR(out.dissipated_Pa, half, 1e-9 * half);
  }
  const auto imbalance = [&](int steps) {
    SuperelasticState state;
    double strain = 0, work = 0, lost = 0, stored = 0;
    for (double to : random_path(11, 20, -0.08, 0.08)) {
      const double from = strain;
      for (int i = 1; i <= steps; ++i) {
        const double next = from + (to - from) * i / steps;
        const SuperelasticResponse r = law.respond(state, next);
        work += 0.5 * (state.stress_Pa + r.state.stress_Pa) * (next - strain);
        lost += r.dissipated_Pa;
        stored = r.stored_Pa;
        state = r.state;
        strain = next;
      }
    }
    return std::abs(work - stored - lost) / lost;
  };
  const double coarse = imbalance(100), fine = imbalance(400);
  EXPECT_LT(fine, 1e-4);
  EXPECT_LT(fine, 0.15 * coarse);  // second order: 1/16
}

TEST(SuperelasticLaw, TangentIsTheDerivativeToSecondOrder) {
  const Superelastic law(set());
  const SuperelasticState half = law.respond({}, 0.03).state, full = law.respond({}, 0.08).state,
                          pressed = law.respond({}, -0.03).state;
  const std::vector<std::pair<SuperelasticState, double>> cases{
      {{}, 0.004},  {{}, 0.03},  {{}, 0.075},      {half, 0.04},    {half, 0.027}, {full, 0.03},
      {half, 0.02}, {{}, -0.03}, {pressed, -0.02}, {pressed, 0.03}, {full, 0.002}};
  for (const auto& [from, strain] : cases) {
    const double tangent = law.respond(from, strain).tangent_Pa;
    const auto error = [&](double h) {
      return std::abs(
          (law.respond(from, strain + h).state.stress_Pa - law.respond(from, strain - h).state.stress_Pa) /
              (2 * h) -
          tangent);
    };
    const double coarse = error(2e-4), fine = error(1e-4);
    EXPECT_LT(fine, 1e-4 * tangent) << strain;
    if (coarse > 1e-8 * tangent) EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1) << strain;
  }
}

TEST(SuperelasticLaw, AsymmetryIsTheRatioOfTheStartStresses) {
  SuperelasticParameters p = set();
  const double ratio = p.compression_start_Pa / p.loading_start_Pa;
  const Superelastic law(p);
  // Stresses in compression are those in tension of an alloy whose thresholds are larger by the ratio.
  SuperelasticParameters scaled = p;
  for (double* s : {&scaled.loading_start_Pa, &scaled.loading_finish_Pa, &scaled.unloading_start_Pa,
                    &scaled.unloading_finish_Pa})
    *s *= ratio;
  scaled.compression_start_Pa = scaled.loading_start_Pa;
  const Superelastic other(scaled);
  SuperelasticState a, b, c;
  for (double strain : {0.01, 0.04, 0.02, 0.07, 0.03, 0.01, 0.0}) {
    a = law.respond(a, -strain).state;
    b = other.respond(b, strain).state;
    c = other.respond(c, -strain).state;  // symmetric
    EXPECT_NEAR(a.stress_Pa, -b.stress_Pa, 1e-6);
    EXPECT_NEAR(c.stress_Pa, -b.stress_Pa, 1e-6);
  }
}

TEST(SuperelasticLaw, BadParametersAreRefused) {
  EXPECT_THROW(superelastic_set("steel"), InputError);
  const auto refused = [](double SuperelasticParameters::*member, double value) {
    SuperelasticParameters p = set();
    p.*member = value;
    EXPECT_THROW(Superelastic{p}, InputError);
  };
  refused(&SuperelasticParameters::austenite_Pa, 0);
  refused(&SuperelasticParameters::martensite_Pa, -1);
  refused(&SuperelasticParameters::transformation_strain, 0);
  refused(&SuperelasticParameters::unloading_finish_Pa, 0);
  refused(&SuperelasticParameters::unloading_start_Pa, 2e8);
  refused(&SuperelasticParameters::loading_start_Pa, 2.3e8);
  refused(&SuperelasticParameters::loading_finish_Pa, 4e8);
  refused(&SuperelasticParameters::compression_start_Pa, std::nan(""));
}
