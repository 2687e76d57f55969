#include <cmath>

#include "run_case.hpp"

using namespace valsalva;
using test::CaseRun;

TEST(DrySolid, HertzUnderARigidSphere) {
  CaseRun run("hertz.toml");
  run.to_end();
  const double modulus = 1e3 / (1 - 0.09), d = 0.25;  // Pa, mm
  const double expected =
      4.0 / 3.0 * modulus * std::sqrt(10.0) * std::pow(d, 1.5) * 1e-6 / 4;  // N, a quarter
  std::printf("Hertz: %.4f of the half-space\n", -run.probe("push_N") / expected);
  EXPECT_NEAR(-run.probe("push_N"), expected, 0.08 * expected);
}
