// The executable on scenes without fluid.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "state/state.hpp"
#include "temporary_folder.hpp"

namespace valsalva {
namespace {

namespace fs = std::filesystem;

const std::string sheet = R"(
[[body]]
name = "sheet"
file = "sheet.obj"
thickness_mm = 0.2
law = "linear"
young_kPa = 100
[[nodes]]
name = "root"
body = "sheet"
select = "plane"
direction = [1, 0, 0]
[[nodes]]
name = "tip"
body = "sheet"
select = "plane"
point_mm = [2, 0, 0]
direction = [1, 0, 0]
[[support]]
name = "clamp"
nodes = "root"
hold = ["all"]
[[load]]
name = "push"
nodes = "tip"
force_N = [0, 0, 1e-6]
[[probe]]
name = "tip"
of = "tip"
component = "z"
[dynamics]
end_s = 0.005
)";

constexpr const char* obj = R"(v 0 0 0
v 1 0 0
v 2 0 0
v 0 1 0
v 1 1 0
v 2 1 0
f 1 2 5 4
f 2 3 6 5
)";

struct Outcome {
  int code;
  std::string text;
};

class DryCycle : public testing::Test {
 protected:
  void SetUp() override {
    write("sheet.obj", obj);
    write("case.toml", sheet);
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }
  Outcome run(const std::string& out, const std::string& options = "",
              const std::string& file = "case.toml") const {
    const std::string command = fmt::format("cd {} && {} {} --quiet --out runs/{} {} > log 2>&1",
                                            folder_.path().string(), CYCLE_PROGRAM, file, out, options);
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(folder_ / "log").rdbuf();
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text.str()};
  }
  fs::path in(const std::string& out, const std::string& name) const {
    return folder_.path() / "runs" / out / name;
  }
  nlohmann::json summary(const std::string& out) const {
    return nlohmann::json::parse(std::ifstream(in(out, "summary.json")));
  }
  std::string text_of(const fs::path& path) const {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  test::TemporaryFolder folder_;
};

}  // namespace

TEST_F(DryCycle, RunsWithoutAParentAndLeavesViewsHistoryAndMetrics) {
  const Outcome done = run("a");
  ASSERT_EQ(done.code, 0) << done.text;
  const nlohmann::json s = summary("a");
  EXPECT_EQ(s["status"], "ok");
  EXPECT_NEAR(s["simulated_s"].get<double>(), 0.005, 1e-12);
  EXPECT_GT(s["metrics"]["tip_mm"].get<double>(), 0);
  EXPECT_TRUE(fs::exists(in("a", "view_sheet.hdf")));
  EXPECT_TRUE(text_of(in("a", "history.csv")).starts_with("time_s,kinetic_nJ,stored_nJ,tip_mm\n"));
  EXPECT_EQ(s["inputs"].size(), 1u);
  const auto last =
      state::read_final(in("a", fmt::format("state_{:06d}.h5", s["steps"].get<long>())), "cycle");
  EXPECT_EQ(last.mesh("sheet").points.size(), 6u);
  EXPECT_EQ(last.mesh("sheet").cell_data.count("von_mises_kPa"), 1u);
}

TEST_F(DryCycle, ContinuesBitForBit) {
  ASSERT_EQ(run("whole", "--steps 90").code, 0);
  ASSERT_EQ(run("parts", "--steps 40").code, 0);
  ASSERT_EQ(run("parts", "--resume --steps 50").code, 0);
  const auto a = state::read(in("whole", "state_000090.h5"), "cycle");
  const auto b = state::read(in("parts", "state_000090.h5"), "cycle");
  ASSERT_EQ(a.restart.size(), b.restart.size());
  for (const auto& [name, array] : a.restart) EXPECT_EQ(array.data, b.array(name).data) << name;
  EXPECT_EQ(a.mesh("sheet").points, b.mesh("sheet").points);
  EXPECT_EQ(text_of(in("whole", "history.csv")), text_of(in("parts", "history.csv")));
}

TEST_F(DryCycle, StaticAndExplicitMeshesOfSolidsReadBack) {
  write("solid.toml", R"(
[[body]]
name = "block"
kind = "solid"
shape = "box"
size_mm = [1, 1, 1]
divisions = [1, 1, 1]
element = "hex27"
law = "linear"
young_kPa = 10
[[nodes]]
name = "floor"
body = "block"
select = "group"
group = "start3"
[[support]]
name = "floor"
nodes = "floor"
hold = ["all"]
[[load]]
name = "weight"
kind = "gravity"
acceleration_mm_per_s2 = [0, 0, -9810]
[dynamics]
solver = "static"
load_steps = 2
)");
  const Outcome done = run("solid", "", "solid.toml");
  ASSERT_EQ(done.code, 0) << done.text;
  const auto last = state::read_final(in("solid", "state_000002.h5"), "cycle");
  EXPECT_EQ(last.mesh("block").types, (std::vector<std::uint8_t>{29}));
}

TEST_F(DryCycle, ANumericalFailureLeavesTheLastGoodState) {
  const Outcome failed = run("fast", "--set dynamics.speed_limit_mm_per_s=0.5");
  EXPECT_EQ(failed.code, 3) << failed.text;
  EXPECT_NE(failed.text.find("sheet node"), std::string::npos) << failed.text;
  EXPECT_NE(failed.text.find("last good state"), std::string::npos);
  EXPECT_EQ(summary("fast")["status"], "failed");
  EXPECT_FALSE(fs::is_empty(in("fast", "")));
  bool found = false;
  for (const auto& entry : fs::directory_iterator(in("fast", "")))
    if (entry.path().filename().string().starts_with("state_")) {
      EXPECT_FALSE(state::read(entry.path(), "cycle").final);
      found = true;
    }
  EXPECT_TRUE(found);
}

TEST_F(DryCycle, ChecksEstimatesAndRefuses) {
  const Outcome checked = run("none", "--check");
  EXPECT_EQ(checked.code, 0);
  EXPECT_NE(checked.text.find("body[0].file = \"sheet.obj\""), std::string::npos) << checked.text;
  const Outcome estimated = run("none", "--estimate");
  EXPECT_EQ(estimated.code, 0);
  EXPECT_NE(estimated.text.find("predicted wall time"), std::string::npos);
  write("both.toml", sheet + "[fluid]\n");
  EXPECT_EQ(run("both", "", "both.toml").code, 2);
  write("misspelt.toml", sheet + "[[suport]]\nname = \"s\"\n");
  const Outcome misspelt = run("misspelt", "", "misspelt.toml");
  EXPECT_EQ(misspelt.code, 2);
  EXPECT_NE(misspelt.text.find("support"), std::string::npos) << misspelt.text;
  write("absent.toml", "[[body]]\nname = \"b\"\nfile = \"absent.msh\"\n");
  EXPECT_EQ(run("absent", "", "absent.toml").code, 2);
  EXPECT_FALSE(fs::exists(in("absent", "")));
}

}  // namespace valsalva
