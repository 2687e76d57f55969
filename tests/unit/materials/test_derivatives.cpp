// Energy -> stress -> tangent by central differences with the order asserted: halving the step must divide
// the error by four. Laws whose energy is quadratic in C have no difference error in space; for them the
// difference must be exact.
#include <gtest/gtest.h>

#include <functional>

#include "materials/invariant_law.hpp"
#include "samples.hpp"

using namespace valsalva;
using namespace valsalva::materials;
using samples::Sample;

namespace {

constexpr double step = 4e-4;
constexpr double factor = 1.3;

// error(h) is the distance of the central difference from the derivative, `size` what it is measured against.
void expect_second_order(const std::function<double(double)>& error, double size, bool exact,
                         const std::string& what) {
  const double coarse = error(step), fine = error(step / 2);
  if (exact) {
    EXPECT_LE(coarse, 1e-8 * size) << what;
    return;
  }
  EXPECT_LT(fine, 1e-2 * size) << what;
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1) << what << ": errors " << coarse << " " << fine;
}

using Respond = std::function<ElasticResponse(const Mat3& c, Derivatives wanted)>;

void check_in_space(const Respond& respond, const Mat3& c, bool exact, const std::string& what) {
  const ElasticResponse at = respond(c, Derivatives::tangent);
  const double size = at.tangent.norm() + at.stress.norm();
  expect_second_order(
      [&](double h) {
        Voigt6 difference;
        for (int k = 0; k < 6; ++k) {
          const Mat3 dc = 2 * h * samples::strain_direction(k);
          difference[k] =
              (respond(c + dc, Derivatives::stress).energy - respond(c - dc, Derivatives::stress).energy) /
              (2 * h);
        }
        return (difference - voigt(at.stress)).norm();
      },
      at.stress.norm() + 1e-3 * size, exact, what + ", stress");
  expect_second_order(
      [&](double h) {
        Tangent6 difference;
        for (int k = 0; k < 6; ++k) {
          const Mat3 dc = 2 * h * samples::strain_direction(k);
          difference.col(k) = (voigt(respond(c + dc, Derivatives::stress).stress) -
                               voigt(respond(c - dc, Derivatives::stress).stress)) /
                              (2 * h);
        }
        return (difference - at.tangent).norm();
      },
      size, exact, what + ", tangent");
  EXPECT_LE((at.tangent - at.tangent.transpose()).norm(), 1e-12 * size) << what << ": symmetry";
}

void check_in_plane(const PlaneLaw& law, const Eigen::Matrix2d& c, const std::string& what) {
  const PlaneFibres fibres = samples::two_plane_fibres();
  const PlaneTangent at = law.plane_tangent(c, fibres, factor);
  expect_second_order(
      [&](double h) {
        Eigen::Vector3d difference;
        for (int k = 0; k < 3; ++k) {
          const Eigen::Matrix2d dc = 2 * h * samples::plane_strain_direction(k);
          difference[k] = (law.plane_stress(c + dc, fibres, factor).energy -
                           law.plane_stress(c - dc, fibres, factor).energy) /
                          (2 * h);
        }
        return (difference - plane_voigt(at.at.stress)).norm();
      },
      at.at.stress.norm() + 1e-3 * at.tangent.norm(), false, what + ", stress");
  expect_second_order(
      [&](double h) {
        Eigen::Matrix3d difference;
        for (int k = 0; k < 3; ++k) {
          const Eigen::Matrix2d dc = 2 * h * samples::plane_strain_direction(k);
          difference.col(k) = (plane_voigt(law.plane_stress(c + dc, fibres, factor).stress) -
                               plane_voigt(law.plane_stress(c - dc, fibres, factor).stress)) /
                              (2 * h);
        }
        return (difference - at.tangent).norm();
      },
      at.tangent.norm(), false, what + ", tangent");
}

std::vector<Eigen::Matrix2d> plane_states() {
  std::vector<Eigen::Matrix2d> states;
  for (const Mat3& f : samples::gradients()) {
    const Eigen::Matrix2d g = f.topLeftCorner<2, 2>();
    states.push_back(g.transpose() * g);
  }
  return states;
}

}  // namespace

TEST(Derivatives, OfEveryElasticLaw) {
  const Fibres fibres = samples::two_fibres();
  for (const Sample& s : samples::all())
    for (const Mat3& f : samples::gradients())
      check_in_space([&](const Mat3& c, Derivatives d) { return s.law->respond(c, fibres, factor, d); },
                     f.transpose() * f,
                     s.quadratic && (!s.fibre_term || samples::slack(fibres, f.transpose() * f)), s.name);
}

TEST(Derivatives, OfEveryLawWithEveryVolumetricTermAndSplit) {
  const Fibres fibres = samples::two_fibres();
  for (const Sample& s : samples::all())
    for (const auto form : {Volumetric::Form::none, Volumetric::Form::j_ln_j, Volumetric::Form::quadratic,
                            Volumetric::Form::logarithmic, Volumetric::Form::simo_taylor})
      for (const Split split : {Split::modified, Split::full}) {
        const SolidLaw solid(s.law, {form, 5e5}, split);
        const bool exact =
            s.name == "st-venant-kirchhoff" && split == Split::full && form == Volumetric::Form::none;
        for (const Mat3& f : samples::gradients())
          check_in_space([&](const Mat3& c, Derivatives d) { return solid.respond(c, fibres, factor, d); },
                         f.transpose() * f, exact,
                         solid.name() + (split == Split::full ? " full" : " modified"));
      }
}

// A law that uses every derivative that an InvariantResponse has, so that the assembly is covered also where
// no published law goes (second derivative in I2, coupling of I1 with I4).
class EveryTerm : public InvariantLaw {
 public:
  std::string name() const override { return "every term"; }
  InvariantResponse derivatives(const Invariants& at, int families, double factor) const override {
    const double x = at.i1 - 3, y = at.i2 - 3, a = 2e4 * factor, b = 7e3;
    InvariantResponse r;
    r.energy = a * (x + x * x * x) + b * (y + y * y * y);
    r.d1 = a * (1 + 3 * x * x);
    r.d11 = 6 * a * x;
    r.d2 = b * (1 + 3 * y * y);
    r.d22 = 6 * b * y;
    for (int i = 0; i < families; ++i) {
      const double z = at.i4[i] - 1, c = 5e3 * (i + 1);
      r.energy += c * (z * z * z + x * z * z);
      r.d1 += c * z * z;
      r.d4[i] = c * (3 * z * z + 2 * x * z);
      r.d44[i] = c * (6 * z + 2 * x);
      r.d14[i] = 2 * c * z;
    }
    return r;
  }
};

TEST(Derivatives, OfALawThatUsesEveryTerm) {
  const Fibres fibres = samples::two_fibres();
  const EveryTerm law;
  for (const Mat3& f : samples::gradients())
    check_in_space([&](const Mat3& c, Derivatives d) { return law.respond(c, fibres, factor, d); },
                   f.transpose() * f, false, law.name());
  for (const Eigen::Matrix2d& c : plane_states()) check_in_plane(law, c, law.name());
}

TEST(Derivatives, OfIncompressiblePlaneStress) {
  for (const Sample& s : samples::all())
    for (const Eigen::Matrix2d& c : plane_states()) check_in_plane(*s.law, c, s.name);
}

TEST(Derivatives, OfCompressiblePlaneStress) {
  for (const Sample& s : samples::all())
    for (const Split split : {Split::modified, Split::full}) {
      const SolidLaw solid(s.law, {Volumetric::Form::simo_taylor, 8e5}, split);
      for (const Eigen::Matrix2d& c : plane_states())
        check_in_plane(solid, c, solid.name() + " in the plane");
    }
}

TEST(Derivatives, OgdenAtEqualAndNearlyEqualStretches) {
  const auto law = make_law("ogden", {{"mu1_Pa", 6e4}, {"alpha1", 7.3}, {"mu2_Pa", -2e4}, {"alpha2", -3.1}});
  for (const double apart : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
    Mat3 c = Vec3(1.2, 1.2 * (1 + apart), 0.8).asDiagonal();
    const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    c = turn * c * turn.transpose();
    check_in_space([&](const Mat3& at, Derivatives d) { return law->respond(at, {}, 1, d); }, c, false,
                   "ogden, stretches apart by " + std::to_string(apart));
  }
  check_in_space([&](const Mat3& at, Derivatives d) { return law->respond(at, {}, 1, d); },
                 Mat3::Identity() * 1.1, false, "ogden, three equal stretches");
}

TEST(Derivatives, OfTheVolumetricTerms) {
  for (const auto form : {Volumetric::Form::j_ln_j, Volumetric::Form::quadratic,
                          Volumetric::Form::logarithmic, Volumetric::Form::simo_taylor}) {
    const Volumetric u{form, 3e6};
    for (const double j : {0.4, 0.97, 1.0, 1.05, 2.5}) {
      const auto slope_error = [&](double h) {
        return std::abs((u.respond(j + h).energy - u.respond(j - h).energy) / (2 * h) - u.respond(j).first);
      };
      const auto curvature_error = [&](double h) {
        return std::abs((u.respond(j + h).first - u.respond(j - h).first) / (2 * h) - u.respond(j).second);
      };
      const bool exact = form == Volumetric::Form::quadratic;
      expect_second_order(slope_error, 3e6, exact, name_of(form));
      expect_second_order(curvature_error, 3e6, exact, name_of(form));
    }
    EXPECT_EQ(u.respond(1).energy, 0) << name_of(form);
    EXPECT_EQ(u.respond(1).first, 0) << name_of(form);
    EXPECT_DOUBLE_EQ(u.respond(1).second, 3e6) << name_of(form);
  }
}
