// The laws under test: every published set that can be reached from the library is tested in
// test_library.cpp; these cover what the sets leave out (second terms, dispersion, straight fibres) with
// round constants.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "materials/library.hpp"
#include "materials/voigt.hpp"

namespace valsalva::materials::samples {

struct Sample {
  std::string name;
  std::shared_ptr<const ElasticLaw> law;
  bool quadratic =
      false;  ///< the matrix is of second degree in C at most: differences are exact in slack fibres
  bool psd_plane = false;   ///< its header promises a positive semi-definite plane-stress tangent
  bool fibre_term = false;  ///< has fibres that bear no compression
};

inline std::vector<Sample> all() {
  const auto make = [](const char* law, const ParameterValues& p) { return make_law(law, p); };
  return {
      {"neo-hookean", make("neo-hookean", {{"mu_Pa", 1e5}}), true, true, false},
      {"mooney-rivlin", make("mooney-rivlin", {{"c1_Pa", 4e4}, {"c2_Pa", 1e4}}), true, false, false},
      {"st-venant-kirchhoff", make("st-venant-kirchhoff", {{"lambda_Pa", 9e4}, {"mu_Pa", 4e4}}), true, false,
       false},
      {"ogden one term", make("ogden", {{"mu1_Pa", 59782.4}, {"alpha1", 12.97}}), false, false, false},
      {"ogden three terms",
       make("ogden", {{"mu1_Pa", 6.3e5},
                      {"alpha1", 1.3},
                      {"mu2_Pa", 1.2e3},
                      {"alpha2", 5},
                      {"mu3_Pa", -1e4},
                      {"alpha3", -2}}),
       false, false, false},
      {"exponential-neo-hookean", make("exponential-neo-hookean", {{"c10_Pa", 1.5e4}, {"c01", 13.48}}), false,
       true, false},
      {"hgo", make("hgo", {{"c10_Pa", 146.3}, {"c01", 26.21}, {"k1_Pa", 7072}, {"k2", 147.5}}), false, true,
       true},
      {"hgo dispersed",
       make("hgo", {{"c10_Pa", 119}, {"c01", 22.59}, {"k1_Pa", 2.38e5}, {"k2", 49.8}, {"kappa", 0.2}}), false,
       true, false},
      {"holzapfel",
       make("holzapfel", {{"mu_Pa", 2e4}, {"a1_Pa", 5e4}, {"b1", 30}, {"a2_Pa", 2e4}, {"b2", 12}}), true,
       true, true},
      {"straightened-fibre",
       make("straightened-fibre", {{"c1_Pa", 6e4}, {"c2_Pa", 1e3}, {"c3_Pa", 1.17e5}, {"c4", 9.19}}), true,
       false, true},
      {"straightened-fibre straight",
       make("straightened-fibre",
            {{"c1_Pa", 6e4}, {"c3_Pa", 1e5}, {"c4", 40}, {"straightening_stretch", 1.03}}),
       true, false, true},
      {"fung", make("fung", {{"ch_Pa", 5.89e5}, {"b1", 4.19}, {"b2", 0.299}, {"b3", 0.8}}), false, false,
       false},
      {"lee-sacks",
       make("lee-sacks", {{"c0_Pa", 6.8e4}, {"c1_Pa", 1.3e4}, {"c2", 38}, {"c3", 20}, {"w", 0.4}}), false,
       true, true},
  };
}

inline Fibres two_fibres() {
  return {2, {Vec3(std::cos(0.4), std::sin(0.4), 0), Vec3(std::cos(0.4), -std::sin(0.4), 0)}};
}

inline PlaneFibres two_plane_fibres() {
  PlaneFibres f;
  f.count = 2;
  f.direction = {Eigen::Vector2d(std::cos(0.4), std::sin(0.4)),
                 Eigen::Vector2d(std::cos(0.4), -std::sin(0.4))};
  return f;
}

// Deformations with det F near 1, away from the fibres' switch: pull, squeeze, shear, all three turned.
inline std::vector<Mat3> gradients() {
  Mat3 pull = Vec3(1.08, 1.03, 0.91).asDiagonal(), squeeze = Vec3(0.9, 0.93, 1.17).asDiagonal();
  Mat3 shear = Mat3::Identity();
  shear(0, 1) = 0.15;
  shear(2, 0) = -0.08;
  shear(1, 1) = 1.05;
  Mat3 general;
  general << 1.05, 0.1, 0.02, -0.03, 1.04, 0.05, 0.01, 0.02, 0.97;
  return {pull, squeeze, shear, general};
}

inline bool slack(const Fibres& fibres, const Mat3& c) {
  for (int i = 0; i < fibres.count; ++i)
    if (fibres.direction[i].dot(c * fibres.direction[i]) > 1) return false;
  return true;
}

// The strain increment of Voigt component k: 11, 22, 33 and the engineering shears.
inline Mat3 strain_direction(int k) {
  Voigt6 v = Voigt6::Zero();
  v[k] = k < 3 ? 1 : 0.5;
  return tensor(v);
}

inline Eigen::Matrix2d plane_strain_direction(int k) {
  Eigen::Matrix2d d = Eigen::Matrix2d::Zero();
  if (k < 2)
    d(k, k) = 1;
  else
    d(0, 1) = d(1, 0) = 0.5;
  return d;
}

}  // namespace valsalva::materials::samples
