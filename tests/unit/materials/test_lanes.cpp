// Eight at a time gives what one at a time gives.
#include <gtest/gtest.h>

#include <cmath>

#include "materials/fibre_exponential.hpp"
#include "materials/hgo.hpp"
#include "materials/lanes.hpp"
#include "materials/neo_hookean.hpp"

using namespace valsalva;
using namespace valsalva::materials;

namespace {

TEST(Lanes, AnglesAreThoseOfTheArcTangent) {
  for (int i = -4000; i <= 4000; ++i) {
    const double angle = i * M_PI / 4000;
    Lanes sine, cosine;
    for (int l = 0; l < lane_count; ++l) {
      const double length = std::pow(10, l - 4);
      sine[l] = length * std::sin(angle);
      cosine[l] = length * std::cos(angle);
    }
    const Lanes found = angle_of(sine, cosine);
    for (int l = 0; l < lane_count; ++l)
      EXPECT_NEAR(found[l], std::atan2(sine[l], cosine[l]), 4e-15 + 4e-15 * std::abs(angle)) << angle;
  }
  const Lanes zero = Lanes::Zero(), one = Lanes::Ones();
  EXPECT_EQ(angle_of(zero, one)[0], 0);
  EXPECT_NEAR(angle_of(zero, -one)[0], M_PI, 1e-15);
  EXPECT_EQ(angle_of(zero, zero)[0], 0);
}

TEST(Lanes, WhatIsNotANumberStaysSo) {
  const double nan = std::nan("");
  EXPECT_TRUE(std::isnan(capped_exponential<double>(nan).value));
  EXPECT_TRUE(std::isnan(fibre_exponential<double>(1, 1, nan).first));
  EXPECT_TRUE(capped_exponential<Lanes>(Lanes::Constant(nan)).value.isNaN().all());
  EXPECT_TRUE(fibre_exponential<Lanes>(1, 1, Lanes::Constant(nan)).first.isNaN().all());
}

PlaneFibres two_fibres() {
  PlaneFibres fibres{.count = 2};
  fibres.direction = {Eigen::Vector2d(std::cos(0.4), std::sin(0.4)),
                      Eigen::Vector2d(std::cos(0.4), -std::sin(0.4))};
  return fibres;
}

void expect_equal(const PlaneLaw& law) {
  const PlaneFibres fibres = two_fibres();
  PlaneLanes at;
  at.families = 2;
  std::array<Eigen::Matrix2d, lane_count> c;
  for (int l = 0; l < lane_count; ++l) {
    const double a = 0.8 + 0.1 * l;  // pressed, at rest, stretched to beyond the cap of the exponential
    c[l] << a * a, 0.05 * l, 0.05 * l, 1.1;
    at.c11[l] = c[l](0, 0);
    at.c22[l] = c[l](1, 1);
    at.c12[l] = c[l](0, 1);
    at.factor[l] = 1 + l;
    for (int i = 0; i < 2; ++i)
      for (int d = 0; d < 2; ++d) at.fibre[i][d][l] = fibres.direction[i][d];
  }
  const PlaneStressLanes found = law.plane_stress_lanes(at);
  for (int l = 0; l < lane_count; ++l) {
    const PlaneStress one = law.plane_stress(c[l], fibres, 1 + l);
    const double scale = 1e-13 * one.stress.norm();
    EXPECT_NEAR(found.s11[l], one.stress(0, 0), scale) << l;
    EXPECT_NEAR(found.s22[l], one.stress(1, 1), scale) << l;
    EXPECT_NEAR(found.s12[l], one.stress(0, 1), scale) << l;
    EXPECT_NEAR(found.energy[l], one.energy, 1e-12 * std::abs(one.energy) + 1e-9) << l;
    EXPECT_NEAR(found.exponent[l], one.exponent, 1e-13 * (1 + one.exponent)) << l;
  }
}

TEST(Lanes, StressesOfALawWithItsOwnFormAndOfOneWithout) {
  expect_equal(Hgo(native_leaflet_healthy));
  expect_equal(Hgo({146.3, 26.21, 7072.0, 147.5, 0.2}));
  expect_equal(NeoHookean(3e4));
}

}  // namespace
