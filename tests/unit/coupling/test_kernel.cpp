#include <gtest/gtest.h>

#include <cmath>

#include "core/errors.hpp"
#include "coupling/kernel.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::coupling;

constexpr Basis all[] = {Basis::linear, Basis::ib3, Basis::ib4, Basis::bspline3, Basis::bspline4};

double moment(const Weights& w, double x, int power) {
  double sum = 0;
  for (int j = 0; j < 4; ++j) sum += std::pow(x - (w.start + j), power) * w.value[j];
  return sum;
}

template <class Test>
void everywhere(Test&& test) {
  for (int i = -300; i <= 300; ++i) test(i * 0.01037);
  for (double x : {-1.0, -0.5, 0.0, 0.5, 1.0, 7.5, 8.0}) test(x);
}

TEST(Kernel, ZerothAndFirstMoments) {
  for (Basis basis : all)
    everywhere([&](double x) {
      const Weights w = weights(basis, x);
      EXPECT_NEAR(moment(w, x, 0), 1, 2e-15);
      EXPECT_NEAR(moment(w, x, 1), 0, 2e-15);
    });
}

TEST(Kernel, WeightsAreNeverNegativeAndKeepTheirSupport) {
  for (Basis basis : all)
    everywhere([&](double x) {
      const Weights w = weights(basis, x);
      for (int j = 0; j < 4; ++j) {
        EXPECT_GE(w.value[j], -1e-16);
        if (j >= support(basis)) {
          EXPECT_EQ(w.value[j], 0);
        }
        if (w.value[j] > 1e-12) {
          EXPECT_LE(std::abs(x - w.start - j), 0.5 * support(basis) + 1e-12);
        }
      }
    });
}

TEST(Kernel, SumOfSquaresOfPeskinsKernels) {
  everywhere([&](double x) {
    double three = 0, four = 0;
    for (double v : weights(Basis::ib3, x).value) three += v * v;
    for (double v : weights(Basis::ib4, x).value) four += v * v;
    EXPECT_NEAR(three, 0.5, 2e-15);
    EXPECT_NEAR(four, 0.375, 2e-15);
  });
}

TEST(Kernel, EvenAndOddSamplesOfIb4ShareEqually) {
  everywhere([&](double x) {
    const Weights w = weights(Basis::ib4, x);
    EXPECT_NEAR(w.value[0] + w.value[2], 0.5, 2e-15);
    EXPECT_NEAR(w.value[1] + w.value[3], 0.5, 2e-15);
  });
}

TEST(Kernel, SecondMomentOfBSplinesIsConstant) {
  everywhere([&](double x) {
    EXPECT_NEAR(moment(weights(Basis::bspline3, x), x, 2), 0.25, 4e-15);
    EXPECT_NEAR(moment(weights(Basis::bspline4, x), x, 2), 1.0 / 3, 4e-15);
  });
}

TEST(Kernel, IsContinuousAcrossTheJumpOfItsStart) {
  auto weight_of = [](const Weights& w, int sample) {
    const int j = sample - w.start;
    return j >= 0 && j < 4 ? w.value[j] : 0.0;
  };
  for (Basis basis : all)
    for (double x : {0.0, 0.5, 1.0, 1.5})
      for (int sample = -3; sample <= 4; ++sample)
        EXPECT_NEAR(weight_of(weights(basis, x - 1e-9), sample), weight_of(weights(basis, x + 1e-9), sample),
                    1e-8);
}

TEST(Kernel, NamesAreKnownAndOthersRefused) {
  for (const std::string& name : kernel_names()) EXPECT_NO_THROW(kernel_from(name));
  EXPECT_EQ(kernel_from("cbs43").along, Basis::bspline4);
  EXPECT_EQ(kernel_from("cbs43").across, Basis::bspline3);
  EXPECT_THROW(kernel_from("ib5"), InputError);
}

}  // namespace
