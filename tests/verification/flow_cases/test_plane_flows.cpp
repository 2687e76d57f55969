// Flows with exact solutions or published profiles, from case text.
#include <cmath>

#include "run_case.hpp"

using namespace valsalva;
using test::FlowRun;

namespace {

// Taylor-Green vortices carried along at (1, 1); all sides periodic.
constexpr const char* vortices = R"toml(
[fluid]
box_mm = [0, 0, 0, 1, 1, 0]
cells = [16, 16, 4]
density_g_per_mm3 = 2
viscosity_Pa_s = 0.02
convection = "centred2"
end_s = 0.25
step_s = 0.01
history_rows = 1
velocity = ["1-2*cos(2*pi*x)*sin(2*pi*y)", "1+2*sin(2*pi*x)*cos(2*pi*y)", "0"]
pressure = "-2*(cos(4*pi*x)+cos(4*pi*y))"
[[boundary]]
name = "all"
sides = ["all"]
kind = "periodic"
[[flow_probe]]
name = "error"
quantity = "velocity_error"
exact = ["1-2*cos(2*pi*(x-t))*sin(2*pi*(y-t))*exp(-8*pi^2*0.01*t)", "1+2*sin(2*pi*(x-t))*cos(2*pi*(y-t))*exp(-8*pi^2*0.01*t)", "0"]
)toml";

double order(double coarse, double fine) {
  return std::log2(coarse / fine);
}

}  // namespace

TEST(FlowCases, TaylorGreenConvergesWithOrderTwo) {
  FlowRun coarse(vortices), fine(vortices, {"fluid.cells=[32,32,4]", "fluid.step_s=0.005"});
  const double from = coarse.to_end().metric("error_mm_per_s"), to = fine.to_end().metric("error_mm_per_s");
  std::printf("error %.3e -> %.3e, order %.2f\n", from, to, order(from, to));
  EXPECT_NEAR(order(from, to), 2, 0.2);
  EXPECT_LT(fine.scene.flow().divergence(), 1e-10);
}

TEST(FlowCases, TaylorGreenConvergesWithOrderFour) {
  const std::vector<std::string> scheme{"fluid.order=4", "fluid.time_scheme=rk3",
                                        "fluid.convection=centred4"};
  const auto error = [&](int n) {
    auto overrides = scheme;
    overrides.push_back(fmt::format("fluid.cells=[{},{},8]", n, n));
    overrides.push_back(fmt::format("fluid.box_mm=[0,0,0,1,1,{}]", 8.0 / n));
    overrides.push_back(fmt::format("fluid.step_s={}", 0.1 / n));
    return FlowRun(vortices, overrides).to_end().metric("error_mm_per_s");
  };
  const double from = error(16), to = error(32);
  std::printf("error %.3e -> %.3e, order %.2f\n", from, to, order(from, to));
  EXPECT_NEAR(order(from, to), 4, 0.4);
}

// A plane flow needs one cell across.
TEST(FlowCases, OneCellAcrossIsAsGoodAsFour) {
  const std::vector<std::vector<std::string>> schemes{
      {"fluid.convection=upwind3"},        {"fluid.convection=weno5"},
      {"fluid.time_scheme=rk3"},           {"fluid.order=4", "fluid.convection=centred4"},
      {"fluid.viscosity_scheme=implicit"}, {"fluid.subgrid=vreman"},
  };
  for (const auto& scheme : schemes) {
    const auto error = [&](int across, const std::string& box) {
      auto overrides = scheme;
      overrides.push_back(fmt::format("fluid.cells=[16,16,{}]", across));
      overrides.push_back("fluid.box_mm=" + box);
      return FlowRun(vortices, overrides).to_end().metric("error_mm_per_s");
    };
    const double four = error(4, "[0,0,0,1,1,0.25]"), one = error(1, "[0,0,0,1,1,0.0625]");
    EXPECT_NEAR(one / four, 1, 1e-9) << scheme[0];
  }
}

// Across any direction: the same vortices in the planes of y, z and of z, x.
TEST(FlowCases, OneCellAcrossAnyDirection) {
  const auto error = [](int thin) {
    const std::array<const char*, 3> name{"x", "y", "z"};
    const std::string a = name[(thin + 1) % 3], b = name[(thin + 2) % 3];
    std::array<std::string, 3> start{"0", "0", "0"}, exact = start;
    start[(thin + 1) % 3] = fmt::format("1-2*cos(2*pi*{})*sin(2*pi*{})", a, b);
    start[(thin + 2) % 3] = fmt::format("1+2*sin(2*pi*{})*cos(2*pi*{})", a, b);
    const std::string decay = "*exp(-8*pi^2*0.01*t)";
    exact[(thin + 1) % 3] = fmt::format("1-2*cos(2*pi*({}-t))*sin(2*pi*({}-t))", a, b) + decay;
    exact[(thin + 2) % 3] = fmt::format("1+2*sin(2*pi*({}-t))*cos(2*pi*({}-t))", a, b) + decay;
    std::array<double, 3> box{1, 1, 1};
    std::array<int, 3> cells{16, 16, 16};
    box[thin] = 1.0 / 16;
    cells[thin] = 1;
    const auto list = [](const auto& v) { return fmt::format("[\"{}\",\"{}\",\"{}\"]", v[0], v[1], v[2]); };
    return FlowRun(vortices, {"fluid.velocity=" + list(start), "flow_probe.error.exact=" + list(exact),
                              fmt::format("fluid.pressure=-2*(cos(4*pi*{})+cos(4*pi*{}))", a, b),
                              fmt::format("fluid.box_mm=[0,0,0,{},{},{}]", box[0], box[1], box[2]),
                              fmt::format("fluid.cells=[{},{},{}]", cells[0], cells[1], cells[2])})
        .to_end()
        .metric("error_mm_per_s");
  };
  const double along_z = error(2);
  EXPECT_NEAR(error(0) / along_z, 1, 1e-9);
  EXPECT_NEAR(error(1) / along_z, 1, 1e-9);
}

// The same flow in a box whose sides in x and y are given the exact velocity.
TEST(FlowCases, KnownVelocitiesOnFourSidesKeepOrderTwo) {
  std::string text = vortices;
  const auto all = text.find("[[boundary]]"), probe = text.find("[[flow_probe]]");
  const auto exact = text.find("exact = ");
  text = text.substr(0, all) + R"toml([[boundary]]
name = "known"
sides = ["x", "y"]
kind = "inflow"
velocity = )toml" +
         text.substr(exact + 8, text.find('\n', exact) - exact - 8) +
         R"toml(
[[boundary]]
name = "plane"
sides = ["z"]
kind = "periodic"
)toml" + text.substr(probe);
  FlowRun coarse(text, {"fluid.convection=centred4", "fluid.step_s=0.005"}),
      fine(text, {"fluid.convection=centred4", "fluid.cells=[32,32,4]", "fluid.step_s=0.0025"});
  const double from = coarse.to_end().metric("error_mm_per_s"), to = fine.to_end().metric("error_mm_per_s");
  std::printf("error %.3e -> %.3e, order %.2f\n", from, to, order(from, to));
  EXPECT_GT(order(from, to), 1.8);
}

TEST(FlowCases, CavityOfTheLibraryFollowsGhia) {
  const auto u = test::reference("ghia_u_y0.5_Re100.dat"), v = test::reference("ghia_v_x0.5_Re100.dat");
  if (u.empty()) GTEST_SKIP() << "no reference data";
  FlowRun run(FlowRun::library("fluid-cavity-re100.toml"), {"fluid.cells=[32,32,1]"});
  run.to_end();
  const auto rms = [&](const auto& rows, const std::string& name, const std::string& column) {
    auto line = run.profile(name);
    double sum = 0;
    for (const auto& row : rows)
      sum += std::pow(test::interpolated(line["s_mm"], line[column], row[0]) - row[1], 2);
    return std::sqrt(sum / static_cast<double>(rows.size()));
  };
  const double of_u = rms(u, "u", "u_mm_per_s"), of_v = rms(v, "v", "v_mm_per_s");
  std::printf("rms of u %.4f, of v %.4f of the lid's speed\n", of_u, of_v);
  EXPECT_LT(of_u, 0.01);
  EXPECT_LT(of_v, 0.01);
}

// Fourth- and second-order polynomials: a channel driven by a body force, between walls of the box.
TEST(FlowCases, ChannelUnderABodyForce) {
  FlowRun run(R"toml(
[fluid]
box_mm = [0, 0, 0, 0, 1, 0]
cells = [4, 16, 4]
density_g_per_mm3 = 1
viscosity_Pa_s = 1
end_s = 1.5
history_rows = 1
body_force_Pa_per_mm = ["8", "0", "0"]
[[boundary]]
name = "walls"
sides = ["y"]
[[boundary]]
name = "endless"
sides = ["x", "z"]
kind = "periodic"
[[flow_probe]]
name = "error"
quantity = "velocity_error"
norm = "largest"
exact = ["4*y*(1-y)", "0", "0"]
[[flow_probe]]
name = "dissipation"
quantity = "dissipation"
)toml");
  run.to_end();
  // The second difference is exact for a parabola but for the half cells at the walls: h^2 everywhere.
  EXPECT_NEAR(run.metric("error_mm_per_s"), 1.0 / 256, 1e-6);
  // Work of the force: 8 x mean of u (2/3 + h^2 ...) x volume.
  const double volume = 4.0 / 16 * 4.0 / 16;
  EXPECT_NEAR(run.metric("dissipation_nJ_per_s") / (8 * (2.0 / 3) * volume), 1, 0.01);
}
