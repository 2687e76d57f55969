// Finite differences of energy, stress and tangent over a grid of states, with the order of accuracy
// asserted.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <memory>
#include <vector>

#include "core/errors.hpp"
#include "materials/capped_exponential.hpp"
#include "materials/hgo.hpp"
#include "materials/neo_hookean.hpp"
#include "materials/plane_stress.hpp"

using namespace valsalva;
using namespace valsalva::materials;

namespace {

Eigen::Matrix2d right_cauchy_green(double stretch1, double stretch2, double angle) {
  const Eigen::Rotation2Dd turn(angle);
  const Eigen::Matrix2d u = turn * Eigen::Vector2d(stretch1, stretch2).asDiagonal() * turn.inverse();
  return u * u;
}

PlaneFibres two_families() {
  PlaneFibres fibres;
  fibres.count = 2;
  fibres.direction = {Eigen::Vector2d(std::cos(0.4), std::sin(0.4)),
                      Eigen::Vector2d(std::cos(0.4), -std::sin(0.4))};
  return fibres;
}

struct Named {
  const char* name;
  std::shared_ptr<const InvariantLaw> law;
};

std::vector<Named> laws() {
  return {{"native", std::make_shared<Hgo>(native_leaflet_healthy)},
          {"pericardium", std::make_shared<Hgo>(porcine_pericardium)},
          {"neo-hookean", std::make_shared<NeoHookean>(1e5)}};
}

// Strain increments in Voigt order: 11, 22, and 12 with engineering shear.
Eigen::Matrix2d strain_direction(int k) {
  Eigen::Matrix2d d = Eigen::Matrix2d::Zero();
  if (k < 2)
    d(k, k) = 1;
  else
    d(0, 1) = d(1, 0) = 0.5;
  return d;
}

Eigen::Vector3d voigt(const Eigen::Matrix2d& m) {
  return {m(0, 0), m(1, 1), m(0, 1)};
}

// States well inside the smooth regions of the fibres' switch, stretched and shortened.
const std::vector<std::array<double, 3>> states = {{1.04, 1.03, 0.3},  {1.10, 1.02, 0.1}, {0.93, 0.95, 0.2},
                                                   {1.08, 0.90, 0.05}, {1.20, 1.15, 0.7}, {0.8, 0.7, 1.1}};

}  // namespace

TEST(Laws, StressIsTheGradientOfTheEnergyToSecondOrder) {
  const PlaneFibres fibres = two_families();
  for (const Named& named : laws())
    for (const auto& [l1, l2, angle] : states) {
      const Eigen::Matrix2d c = right_cauchy_green(l1, l2, angle);
      const Eigen::Vector3d exact = voigt(plane_stress(*named.law, c, fibres, 1.5).stress);
      const auto error = [&](double h) {
        Eigen::Vector3d difference;
        for (int k = 0; k < 3; ++k) {
          const Eigen::Matrix2d dc = 2 * h * strain_direction(k);  // C = 1 + 2 E
          difference[k] = (plane_stress(*named.law, c + dc, fibres, 1.5).energy -
                           plane_stress(*named.law, c - dc, fibres, 1.5).energy) /
                          (2 * h);
        }
        return (difference - exact).norm();
      };
      const double coarse = error(1e-3), fine = error(5e-4);
      EXPECT_LT(fine, 1e-2 * exact.norm() + 1e-6) << named.name << " " << l1 << " " << l2;
      EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.15) << named.name << " " << l1 << " " << l2;
    }
}

TEST(Laws, TangentIsTheGradientOfTheStressToSecondOrder) {
  const PlaneFibres fibres = two_families();
  for (const Named& named : laws())
    for (const auto& [l1, l2, angle] : states) {
      const Eigen::Matrix2d c = right_cauchy_green(l1, l2, angle);
      const Eigen::Matrix3d exact = plane_tangent(*named.law, c, fibres, 0.7).tangent;
      const auto error = [&](double h) {
        Eigen::Matrix3d difference;
        for (int k = 0; k < 3; ++k) {
          const Eigen::Matrix2d dc = 2 * h * strain_direction(k);
          difference.col(k) = voigt(plane_stress(*named.law, c + dc, fibres, 0.7).stress -
                                    plane_stress(*named.law, c - dc, fibres, 0.7).stress) /
                              (2 * h);
        }
        return (difference - exact).norm();
      };
      const double coarse = error(4e-4), fine = error(2e-4);
      EXPECT_LT(fine, 1e-2 * exact.norm()) << named.name << " " << l1 << " " << l2;
      EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.15) << named.name << " " << l1 << " " << l2;
    }
}

TEST(Laws, MaterialTangentIsPositiveSemiDefinite) {
  const PlaneFibres fibres = two_families();
  for (const Named& named : laws())
    for (double l1 : {0.6, 0.9, 1.0, 1.1, 1.3, 2.0})
      for (double l2 : {0.6, 0.9, 1.0, 1.1, 1.3, 2.0}) {
        const Eigen::Matrix3d d =
            plane_tangent(*named.law, right_cauchy_green(l1, l2, 0.4), fibres, 1).tangent;
        const Eigen::Vector3d eigen = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(d).eigenvalues();
        EXPECT_GE(eigen[0], -1e-10 * eigen[2]) << named.name << " " << l1 << " " << l2;
      }
}

TEST(Laws, StressFreeInTheReference) {
  for (const Named& named : laws()) {
    const PlaneStress s = plane_stress(*named.law, Eigen::Matrix2d::Identity(), two_families(), 1);
    EXPECT_EQ(s.energy, 0) << named.name;
    EXPECT_EQ(s.stress.norm(), 0) << named.name;
  }
}

TEST(Laws, SmallStrainModulusIsThatOfTheMatrix) {
  // Uniaxial: E = 3 mu for the neo-Hookean solid, 6 C10 C01 for the exponential one without fibres.
  const Hgo hgo(porcine_pericardium);
  const NeoHookean neo(7e4);
  const auto young = [](const InvariantLaw& law) {
    const Eigen::Matrix3d d = plane_tangent(law, Eigen::Matrix2d::Identity(), PlaneFibres{}, 1).tangent;
    return d(0, 0) - d(0, 1) * d(1, 0) / d(1, 1);
  };
  EXPECT_NEAR(young(hgo), hgo.matrix_modulus_Pa(), 1e-9 * hgo.matrix_modulus_Pa());
  EXPECT_NEAR(young(neo), 3 * 7e4, 1e-6);
}

TEST(Laws, UniaxialNeoHookeanFollowsTheClosedForm) {
  // Nominal stress mu (l - l^-2) in the direction of pull when the other in-plane direction is free: l2 =
  // l^-1/2.
  const NeoHookean law(1e5);
  for (double l : {0.7, 1.1, 1.5, 2.5}) {
    const PlaneStress s = plane_stress(law, right_cauchy_green(l, 1 / std::sqrt(l), 0), PlaneFibres{}, 1);
    EXPECT_NEAR(l * s.stress(0, 0), 1e5 * (l - 1 / (l * l)), 1e-7 * 1e5);
    EXPECT_NEAR(s.stress(1, 1), 0, 1e-7 * 1e5);
  }
}

TEST(Laws, FibresBearNoCompression) {
  const Hgo law(native_leaflet_healthy);
  PlaneFibres along;
  along.count = 1;
  const Eigen::Matrix2d shortened = right_cauchy_green(0.9, 1.0, 0);
  EXPECT_EQ(plane_stress(law, shortened, along, 1).energy,
            plane_stress(law, shortened, PlaneFibres{}, 1).energy);
  const Eigen::Matrix2d stretched = right_cauchy_green(1.1, 1.0, 0);
  EXPECT_GT(plane_stress(law, stretched, along, 1).energy,
            plane_stress(law, stretched, PlaneFibres{}, 1).energy);
}

TEST(Laws, FactorScalesTheMatrixOnly) {
  const Hgo law(native_leaflet_healthy);
  const Invariants at{3.05, 3.05, {1.1, 1.0}};
  const InvariantResponse one = law.derivatives(at, 2, 1), thousand = law.derivatives(at, 2, 1000);
  EXPECT_NEAR(thousand.d1, 1000 * one.d1, 1e-9 * thousand.d1);
  EXPECT_EQ(thousand.d4[0], one.d4[0]);
}

TEST(Laws, ExponentialIsContinuedTwiceDifferentiably) {
  const double step = 1e-6;
  const CappedExponential below = capped_exponential(exponent_cap - step),
                          above = capped_exponential(exponent_cap + step);
  const double e = std::exp(exponent_cap);
  EXPECT_NEAR(above.value - below.value, 2 * step * e, 1e-9 * e);
  EXPECT_NEAR(above.first - below.first, 2 * step * e, 1e-9 * e);
  EXPECT_NEAR(above.second, below.second, 2e-6 * e);
  EXPECT_LT(capped_exponential(700.0).value, 1e9);  // the plain exponential would be 1e304
  const Hgo law(native_leaflet_healthy);
  EXPECT_GT(law.derivatives({3.5, 3.5, {1, 1}}, 2, 1).exponent, exponent_cap);
  EXPECT_LT(law.derivatives({3.1, 3.1, {1, 1}}, 2, 1).exponent, exponent_cap);
}

TEST(Laws, CollapsedTrianglesStayFiniteAndRepel) {
  const Hgo law(porcine_pericardium);
  for (double l : {1e-1, 1e-2, 1e-4, 0.0}) {
    const PlaneStress s = plane_stress(law, right_cauchy_green(l, l, 0), PlaneFibres{}, 1);
    EXPECT_TRUE(std::isfinite(s.energy));
    EXPECT_TRUE(s.stress.allFinite());
  }
  EXPECT_LT(plane_stress(law, right_cauchy_green(0.02, 0.05, 0), PlaneFibres{}, 1).stress(0, 0), 0);
}

TEST(Laws, WrongParametersAreRefusedByName) {
  const auto message = [](auto&& make) -> std::string {
    try {
      make();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(message([] { Hgo({-1, 1, 1, 1}); }).find("C10"), std::string::npos);
  EXPECT_NE(message([] { Hgo({1, 0, 1, 1}); }).find("C01"), std::string::npos);
  EXPECT_NE(message([] { Hgo({1, 1, -1, 1}); }).find("k1"), std::string::npos);
  EXPECT_NE(message([] { Hgo({1, 1, 1, std::nan("")}); }).find("k2"), std::string::npos);
  EXPECT_NE(message([] { NeoHookean(0); }).find("shear modulus"), std::string::npos);
}
