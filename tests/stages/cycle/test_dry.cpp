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
  Outcome run(const std::string& out, const std::string& options = "", const std::string& file = "case.toml",
              const std::string& before = "") const {
    const std::string command =
        fmt::format("cd {} && {}{} {} --quiet --out runs/{} {} > log 2>&1", folder_.path().string(), before,
                    CYCLE_PROGRAM, file, out, options);
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
  const std::vector<std::pair<std::string, std::array<int, 3>>> cases{{"explicit", {90, 40, 50}},
                                                                      {"quasi_static", {300, 130, 170}},
                                                                      {"static", {6, 2, 4}},
                                                                      {"implicit", {8, 3, 5}}};
  for (const auto& [solver, steps] : cases) {
    const auto options = [&](const char* extra, int count) {
      return fmt::format("--set dynamics.solver={} {} --steps {}", solver, extra, count);
    };
    const std::string whole = solver + "_whole", parts = solver + "_parts";
    ASSERT_EQ(run(whole, options("", steps[0])).code, 0);
    ASSERT_EQ(run(parts, options("", steps[1])).code, 0);
    ASSERT_EQ(run(parts, options("--resume", steps[2])).code, 0);
    const std::string state = fmt::format("state_{:06d}.h5", steps[0]);
    const auto one = state::read(in(whole, state), "cycle"), other = state::read(in(parts, state), "cycle");
    ASSERT_EQ(one.restart.size(), other.restart.size());
    for (const auto& [name, array] : one.restart) EXPECT_EQ(array.data, other.array(name).data) << name;
    EXPECT_EQ(one.mesh("sheet").points, other.mesh("sheet").points) << solver;
    EXPECT_EQ(text_of(in(whole, "history.csv")), text_of(in(parts, "history.csv"))) << solver;
  }
}

TEST_F(DryCycle, KeepsTheViewsOfTheTimesItIsToldToAndARunAfreshDropsThem) {
  const std::string wanted = "--set output.view_times_s=[0.003,0,0.00101]";
  const auto times = [&](const char* out) {
    std::vector<double> found;
    const auto series = nlohmann::json::parse(std::ifstream(in(out, "view_sheet.hdf.series")));
    for (const auto& entry : series["files"]) {
      EXPECT_TRUE(fs::exists(in(out, entry["name"].get<std::string>())));
      found.push_back(entry["time"]);
    }
    return found;
  };
  ASSERT_EQ(run("whole", wanted).code, 0);
  const std::vector<double> found = times("whole");
  ASSERT_GE(found.size(), 4u) << "three that were asked for, and the last";
  EXPECT_EQ(found[0], 0);
  EXPECT_GE(found[1], 0.00101);
  EXPECT_LT(found[1], 0.00101 + 2 * 0.005 / 100) << "a hundred rows";
  EXPECT_GE(found[2], 0.003);
  EXPECT_NEAR(found.back(), 0.005, 1e-12);
  int kept = 0;
  for (const auto& entry : fs::directory_iterator(in("whole", "")))
    kept += entry.path().filename().string().starts_with("kept_");
  EXPECT_EQ(kept, 3);

  const int steps = static_cast<int>(summary("whole")["steps"].get<long>());
  ASSERT_EQ(run("parts", wanted + fmt::format(" --steps {}", steps / 2)).code, 0);
  ASSERT_EQ(run("parts", wanted + " --resume").code, 0);
  for (const auto& entry : fs::directory_iterator(in("whole", "")))
    if (const std::string name = entry.path().filename(); name.starts_with("kept_")) {
      const auto one = state::read(entry.path(), "cycle"), other = state::read(in("parts", name), "cycle");
      EXPECT_EQ(one.mesh("sheet").points, other.mesh("sheet").points) << name;
    }
  ASSERT_EQ(run("whole").code, 0);
  for (double t : times("whole")) EXPECT_GT(t, 0.003);
}

// Killed by SIGKILL at any moment and resumed until it is done: the same final state.
TEST_F(DryCycle, KilledAndResumedEndsInTheSameState) {
  const std::string options = "--set dynamics.end_s=0.2 --set output.checkpoint_s=0.05";
  ASSERT_EQ(run("whole", options).code, 0);
  int kills = 0;
  Outcome last{-1, ""};
  for (int attempt = 0; attempt < 40 && last.code != 0; ++attempt) {
    const bool begun = fs::exists(in("killed", "")) && !fs::is_empty(in("killed", ""));
    last = run("killed", options + (begun ? " --resume" : ""), "case.toml", "timeout -s KILL 0.7 ");
    if (last.code != 0) ++kills;
    if (last.code == 2) FAIL() << last.text;
    if (attempt == 20) last = run("killed", options + (begun ? " --resume" : ""));
  }
  ASSERT_EQ(last.code, 0) << last.text;
  std::printf("killed %d times\n", kills);
  const std::string state = fmt::format("state_{:06d}.h5", summary("whole")["steps"].get<long>());
  const auto one = state::read_final(in("whole", state), "cycle"),
             other = state::read_final(in("killed", state), "cycle");
  for (const auto& [name, array] : one.restart) EXPECT_EQ(array.data, other.array(name).data) << name;
  EXPECT_EQ(text_of(in("whole", "history.csv")), text_of(in("killed", "history.csv")));
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

// Each is refused with exit code 2 and nothing written; the message holds the words.
TEST_F(DryCycle, BadInputsAreRefusedByName) {
  const std::string box = R"(
[[body]]
name = "box"
kind = "solid"
shape = "box"
size_mm = [1, 1, 1]
divisions = [1, 1, 1]
law = "linear"
young_kPa = 10
[[nodes]]
name = "all"
body = "box"
)";
  const auto body = [](const std::string& rest) { return "[[body]]\nname = \"b\"\n" + rest; };
  const std::string wedge = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
15
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 1 0 1
6 0 1 1
7 0.5 0 0
8 0 0.5 0
9 0 0 0.5
10 0.5 0.5 0
11 1 0 0.5
12 0 1 0.5
13 0.5 0 1
14 0 0.5 1
15 0.5 0.5 1
$EndNodes
$Elements
1
1 18 2 1 1 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15
$EndElements
)";
  write("wedge15.msh", wedge);
  write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write("cut.msh", "$MeshFormat\n4.1 0 8\n$EndMesh");
  struct Bad {
    std::string text;
    std::vector<std::string> words;
  };
  const std::vector<Bad> all{
      {"[[body]]\nshape = \"plate\"\n", {"name is missing"}},
      {body("shape = \"plate\"\nsize_mm = [1]\n"), {"[[body]] 'b'", "size_mm", "1 entries", "2"}},
      {body("kind = \"beams\"\nshape = \"sphere\"\n"), {"sphere", "beams"}},
      {body("file = \"gone.msh\"\n"), {"gone.msh", "no such mesh file"}},
      {body("file = \"cut.msh\"\n"), {"cut.msh"}},
      {body("kind = \"solid\"\nfile = \"wedge15.msh\"\n"), {"Prism", "expected"}},
      {body("kind = \"solid\"\nfile = \"open.obj\"\n"), {"open.obj", "solid elements"}},
      {body("kind = \"rigid\"\nmotion = \"free\"\nfile = \"open.obj\"\n"), {"not closed", "mass_g"}},
      {box + "[[body]]\nname = \"box\"\nshape = \"plate\"\nsize_mm = [1, 1]\ndivisions = [1, "
             "1]\nthickness_mm = "
             "0.1\nlaw = \"linear\"\nyoung_kPa = 1\n",
       {"two bodies"}},
      {box + "[[body]]\nname = \"s\"\nshape = \"plate\"\nsize_mm = [1, 1]\ndivisions = [1, 1]\nlaw = "
             "\"linear\"\nyoung_kPa = 1\n",
       {"thickness_mm is 0"}},
      {box + "[[nodes]]\nname = \"n\"\nbody = \"boks\"\n", {"boks", "box"}},
      {box + "[[nodes]]\nname = \"n\"\nbody = \"box\"\nselect = \"plane\"\npoint_mm = [0, 0, 7]\n",
       {"no node"}},
      {box + "[[nodes]]\nname = \"n\"\nbody = \"box\"\nselect = \"difference\"\nsets = [\"all\", \"all\"]\n",
       {"no node"}},
      {box + "[[support]]\nname = \"s\"\nnodes = \"all\"\n", {"hold is empty"}},
      {box + "[[support]]\nname = \"s\"\nnodes = \"all\"\nhold = [\"X\"]\n", {"'X'", "symmetry"}},
      {box + "[[support]]\nname = \"s\"\nnodes = \"all\"\nhold = [\"x\"]\ngradient = [1, 2]\n",
       {"gradient", "2 entries", "9"}},
      {box + "[[load]]\nname = \"l\"\nnodes = \"all\"\n", {"force_N is zero"}},
      {box + "[[load]]\nname = \"l\"\nkind = \"pressure\"\nbody = \"box\"\nnodes = \"none\"\npressure_kPa = "
             "1\n",
       {"'none'", "all"}},
      {box + "[[load]]\nname = \"l\"\nnodes = \"all\"\nforce_N = [1, 0, 0]\nshare = \"length\"\n",
       {"share", "border edge"}},
      {box + "[[contact_pair]]\nname = \"c\"\nbody = \"box\"\nother = \"box\"\n",
       {"no thickness", "distance_mm"}},
      {box + "[[contact_pair]]\nname = \"c\"\nbody = \"box\"\nsurface = \"level_set\"\nfile = \"open.obj\"\n",
       {"not a closed surface"}},
      {box + "[[probe]]\nname = \"p\"\nquantity = \"stress\"\nof = \"box\"\n", {"component", "xx"}},
      {box + "[[probe]]\nname = \"p\"\nquantity = \"contact_force\"\nof = \"c\"\n", {"[[contact_pair]]"}},
      {"[[body]]\nname = \"ball\"\nkind = \"rigid\"\nmotion = \"free\"\nshape = \"sphere\"\nradius_mm = 1\n"
       "divisions = [8, 4]\n[dynamics]\nprestress = \"backward_displacement\"\n",
       {"prestress", "'ball'", "quasi_static"}},
      {"[[body]]\nname = \"soft\"\nkind = \"solid\"\nshape = \"box\"\nsize_mm = [1, 1, 1]\n"
       "divisions = [1, 1, 1]\nlaw = \"neo-hookean\"\nlaw_parameters = [\"mu_Pa = 1\"]\n",
       {"'soft'", "'neo-hookean'", "volumetric", "bulk_modulus_kPa"}},
      {box + "[dynamics]\nsolver = \"newton\"\n", {"newton", "static"}},
      {box + "[dynamics]\nend_s = -1\n", {"end_s", "-1"}},
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    write("bad.toml", all[i].text);
    const Outcome refused = run("bad", "", "bad.toml");
    EXPECT_EQ(refused.code, 2) << all[i].text << refused.text;
    for (const std::string& word : all[i].words)
      EXPECT_NE(refused.text.find(word), std::string::npos) << word << " is not in: " << refused.text;
    EXPECT_FALSE(fs::exists(in("bad", "summary.json"))) << all[i].text;
  }
}

}  // namespace valsalva
