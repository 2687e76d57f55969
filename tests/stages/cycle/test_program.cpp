// The executable on a small scene: a synthetic valve in a straight tube, as mesher would hand it over.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "geometry/grid_sdf.hpp"
#include "state/state.hpp"
#include "synthetic_valve.hpp"
#include "temporary_folder.hpp"

namespace valsalva {
namespace {

namespace fs = std::filesystem;
using state::Array;

constexpr double tube_radius = 10;

state::State mesher_state() {
  state::State s;
  s.stage = "mesher";
  s.case_name = "tube";
  s.version = "test";
  s.final = true;
  const geometry::GridSdf tube =
      geometry::sample(Vec3(-13, -13, -16), Vec3(13, 13, 31), 1.0, [](const Vec3& x) {
        return std::max({std::hypot(x.x(), x.y()) - tube_radius, -15 - x.z(), x.z() - 30});
      });
  const auto size = [&](int d) { return static_cast<std::size_t>(tube.dimensions[d]); };
  s.restart["levelset/lumen"] = Array::of(tube.values, {size(2), size(1), size(0)});
  s.restart["levelset/origin_mm"] = Array::of(std::vector<double>{-13, -13, -16});
  s.restart["levelset/spacing_mm"] = Array::scalar(1.0);
  s.restart["anatomy/z_mm"] = Array::of(std::vector<double>{-15, -5, 0, 8, 15, 30});

  test::SyntheticValve valve;
  valve.radius_mm = tube_radius;
  valve.height_mm = 9;
  valve.gap_mm = 2;
  valve.spacing_mm = 0.9;
  valve.turn_rad = 0.3;  // no column of the history is zero by symmetry
  const test::ValveMesh mesh = test::synthetic_valve(valve);
  state::Mesh leaflets = state::Mesh::of_triangles(mesh.shell.reference, mesh.shell.triangles);
  leaflets.point_data["reference"] = Array::of(mesh.shell.reference);
  leaflets.point_data["thickness_mm"] = Array::of(mesh.shell.thickness_mm);
  leaflets.point_data["attached"] =
      Array::of(std::vector<std::int64_t>(mesh.attached.begin(), mesh.attached.end()));
  std::vector<std::int64_t> leaflet;
  for (const Triangle& t : mesh.shell.triangles) leaflet.push_back(mesh.leaflet[t[0]]);
  leaflets.cell_data["leaflet"] = Array::of(leaflet);
  leaflets.cell_data["fibre1"] = Array::of(mesh.shell.fibre1);
  leaflets.cell_data["fibre2"] = Array::of(mesh.shell.fibre2);
  s.meshes["native_leaflets"] = leaflets;
  return s;
}

constexpr const char* scene = R"([case]
fidelity = "draft"
[fluid]
spacing_mm = 1.8
[native]
[circulation]
[cycle]
initialisation_s = 0.004
history_interval = 5
frames_per_beat = 200
[output]
checkpoint_s = 1e4
)";

struct Outcome {
  int code;
  std::string text;
};

class Cycle : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    state::write(*folder_ / "parent.h5", mesher_state());
    std::ofstream(*folder_ / "case.toml") << scene;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Outcome run(const std::string& out, const std::string& options, int ranks = 1,
                     const std::string& file = "case.toml", const std::string& from = "parent.h5") {
    const std::string command =
        fmt::format("cd {} && {} {} --quiet --out runs/{} --from {} {} > log 2>&1", folder_->path().string(),
                    (ranks > 1 ? fmt::format("{} {} ", MPIRUN, ranks) : std::string()) + CYCLE_PROGRAM, file,
                    out, from, options);
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(*folder_ / "log").rdbuf();
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text.str()};
  }
  static fs::path in(const std::string& out, const std::string& name) {
    return folder_->path() / "runs" / out / name;
  }
  static std::vector<std::vector<double>> history(const std::string& out) {
    std::ifstream file(in(out, "history.csv"));
    std::string line;
    std::getline(file, line);
    std::vector<std::vector<double>> rows;
    while (std::getline(file, line)) {
      std::vector<double> row;
      std::stringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
      rows.push_back(row);
    }
    return rows;
  }
  static nlohmann::json summary(const std::string& out) {
    return nlohmann::json::parse(std::ifstream(in(out, "summary.json")));
  }
  static std::unique_ptr<test::TemporaryFolder> folder_;
};
std::unique_ptr<test::TemporaryFolder> Cycle::folder_;

TEST_F(Cycle, StopsAfterStepsAndContinuesBitwise) {
  ASSERT_EQ(run("whole", "--steps 90").code, 0);
  ASSERT_EQ(run("parts", "--steps 37").code, 0);
  ASSERT_EQ(run("parts", "--resume --steps 30").code, 0);
  ASSERT_EQ(run("parts", "--resume --steps 23").code, 0);
  const state::State a = state::read(in("whole", "state_000090.h5"), "cycle");
  const state::State b = state::read(in("parts", "state_000090.h5"), "cycle");
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.restart.size(), b.restart.size());
  for (const auto& [name, array] : a.restart) {
    if (name.rfind("rescue/", 0) == 0) continue;
    ASSERT_TRUE(b.has_array(name)) << name;
    EXPECT_EQ(array.data, b.array(name).data) << name;
  }
  EXPECT_EQ(a.mesh("native_leaflets").points, b.mesh("native_leaflets").points);
  EXPECT_EQ(history("whole"), history("parts"));
  EXPECT_FALSE(a.final);
}

TEST_F(Cycle, ContinuesToALaterEndButNotWithOtherParameters) {
  ASSERT_EQ(run("longer", "--steps 20 --set cycle.duration_s=0.01").code, 0);
  const Outcome other = run("longer", "--resume --steps 1 --set cycle.step_safety=0.5");
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.text.find("cycle.step_safety was 0.85, is 0.5"), std::string::npos) << other.text;
  EXPECT_EQ(run("longer", "--resume --steps 1 --set cycle.duration_s=0.02").code, 0);
}

TEST_F(Cycle, TwoRanksGiveTheSameHistory) {
  ASSERT_EQ(run("one", "--steps 100").code, 0);
  const Outcome two = run("two", "--steps 100", 2);
  ASSERT_EQ(two.code, 0) << two.text;
  const auto a = history("one"), b = history("two");
  ASSERT_EQ(a.size(), 20u);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t c = 0; c < a[0].size(); ++c) {
    double scale = 0, difference = 0;
    for (std::size_t r = 0; r < a.size(); ++r) {
      scale = std::max(scale, std::abs(a[r][c]));
      difference = std::max(difference, std::abs(a[r][c] - b[r][c]));
    }
    EXPECT_LE(difference, 1e-8 * scale) << "column " << c;
  }
}

TEST_F(Cycle, AFinishedRunLeavesFramesAndAFinalState) {
  const Outcome done = run("short", "--set cycle.duration_s=0.02");
  ASSERT_EQ(done.code, 0) << done.text;
  const nlohmann::json s = summary("short");
  EXPECT_EQ(s["status"], "ok");
  EXPECT_NEAR(s["simulated_s"].get<double>(), 0.02, 1e-12);
  EXPECT_LE(s["metrics"]["max_cfl"].get<double>(), 0.5);
  EXPECT_EQ(s["metrics"]["returns_after_alarm"], 0);
  const state::State last =
      state::read_final(in("short", fmt::format("state_{:06d}.h5", s["steps"].get<long>())), "cycle");
  const Array& points = last.array("frames/leaflet_points");
  const Array& slice = last.array("frames/slice_velocity_mm_per_s");
  ASSERT_EQ(points.shape.size(), 3u);
  EXPECT_EQ(points.shape[0], last.array("frames/time_s").size());
  EXPECT_EQ(points.shape[1], last.mesh("native_leaflets").points.size());
  EXPECT_EQ(slice.shape.size(), 4u);
  EXPECT_TRUE(last.images.count("fluid"));
}

TEST_F(Cycle, PrescribedFlowReachesTheAorta) {
  const Outcome done = run("flow",
                           "--set circulation.upstream=flow --set circulation.downstream=pressure "
                           "--set circulation.aortic_pressure_mmHg=8 --set cycle.duration_s=0.03");
  ASSERT_EQ(done.code, 0) << done.text;
  const auto rows = history("flow");
  // Columns: 0 time, 6 flow into the aorta.
  EXPECT_GT(rows.back()[6], 20);
}

TEST_F(Cycle, APumpDrivesTheValve) {
  const Outcome pump = run("pump",
                           "--set circulation.upstream=pump --set circulation.flow_time_s=[0,0.4] "
                           "--set circulation.flow_mL_per_s=[300,300] --set circulation.downstream=pressure "
                           "--set circulation.aortic_pressure_mmHg=8 --set cycle.duration_s=0.03");
  ASSERT_EQ(pump.code, 0) << pump.text;
  // What the pump has given since the beat began is in its two compliances and past the valve; the drop over
  // the adapter is that of 300 mL/s shared by the compliances. Columns: 0 time, 3 chamber, 7 flow into the
  // domain.
  const auto rows = history("pump");
  double passed = 0;
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (rows[i][0] > 0.004) passed += rows[i][7] * (rows[i][0] - rows[i - 1][0]);
  const double c1 = 0.0275, c2 = 0.0347, chamber = rows.back()[3];
  const double drop = 0.15 * (c2 * 300 + c1 * rows.back()[7]) / (c1 + c2);
  const double given = 300 * (rows.back()[0] - 0.004), start = (c1 + c2) * 8;
  EXPECT_NEAR(c1 * (chamber + drop) + c2 * chamber + passed, given + start, 0.05 * given);
  const Outcome adapter = run("adapter",
                              "--set circulation.upstream=adapter --set circulation.downstream=pressure "
                              "--set circulation.aortic_pressure_mmHg=8 --set cycle.duration_s=0.03");
  ASSERT_EQ(adapter.code, 0) << adapter.text;
  EXPECT_EQ(
      run("atrium", "--set circulation.upstream=pump --set circulation.atrial_pressure_mmHg=[1,2]").code, 2);
}

TEST_F(Cycle, RefusesBadInput) {
  std::ofstream(*folder_ / "dry.toml") << "[native]\n[circulation]\n";
  EXPECT_EQ(run("dry", "", 1, "dry.toml").code, 2);
  EXPECT_FALSE(fs::exists(in("dry", "history.csv")));
  EXPECT_EQ(run("absent", "", 1, "case.toml", "nowhere.h5").code, 2);
  EXPECT_EQ(run("kernel", "--set cycle.kernel=ib7").code, 2);
  EXPECT_EQ(run("negative", "--set fluid.spacing_mm=-1").code, 2);
  EXPECT_EQ(run("waveform",
                "--set circulation.upstream=flow --set circulation.flow_time_s=[0.2,0.1] "
                "--set circulation.flow_mL_per_s=[1,2]")
                .code,
            2);
  EXPECT_EQ(run("period", "--set circulation.upstream=flow --set circulation.ejection_s=2").code, 2);

  state::State wrong = mesher_state();
  wrong.stage = "crimp";
  state::write(*folder_ / "wrong.h5", wrong);
  const Outcome stage = run("wrong", "", 1, "case.toml", "wrong.h5");
  EXPECT_EQ(stage.code, 2);
  EXPECT_NE(stage.text.find("mesher"), std::string::npos) << stage.text;

  state::State loose = mesher_state();
  loose.meshes["native_leaflets"].point_data["attached"] =
      Array::of(std::vector<std::int64_t>(loose.meshes["native_leaflets"].points.size(), 0));
  state::write(*folder_ / "loose.h5", loose);
  EXPECT_EQ(run("loose", "", 1, "case.toml", "loose.h5").code, 2);

  state::State bare = mesher_state();
  bare.restart.erase("levelset/lumen");
  state::write(*folder_ / "bare.h5", bare);
  const Outcome missing = run("bare", "", 1, "case.toml", "bare.h5");
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.text.find("levelset/lumen"), std::string::npos) << missing.text;
}

}  // namespace
}  // namespace valsalva
