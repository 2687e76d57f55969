// The executable on a small scene: a bare cylinder stent of 16 mm, crimped by its own program, in a tube of
// 13 mm.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "anatomy.hpp"
#include "temporary_folder.hpp"

namespace valsalva {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code;
  std::string text;
};

// Parents are made once for all tests.
class Deploy : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    std::ofstream(*folder_ / "case.toml") << R"([case]
fidelity = "draft"
[device]
frame = "cylinder"
size_mm = 16
tissue = false
[native]
[crimp]
diameter_mm = 7
step_us = 8
ramp_ms = 1
[deploy]
open_ramp_ms = 4
open_hold_ms = 2
expand_ms = 20
settle_ms = 20
)";
    ASSERT_EQ(run(STENT_PROGRAM, "stent", "").code, 0);
    const Outcome crimped = run(CRIMP_PROGRAM, "crimp", "");
    ASSERT_EQ(crimped.code, 0) << crimped.text;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static Outcome run(const std::string& program, const std::string& out, const std::string& options) {
    const fs::path log = *folder_ / "log";
    const std::string command = fmt::format("cd {} && {} case.toml --quiet --out runs/{} {} > log 2>&1",
                                            folder_->path().string(), program, out, options);
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(log).rdbuf();
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text.str()};
  }

  // An own case folder inside: runs/<scene>/mesher beside runs/<scene>/crimp.
  static void scene(const std::string& name, const state::State& anatomy) {
    const fs::path to = *folder_ / ("runs/" + name);
    fs::create_directories(to / "mesher");
    fs::copy(*folder_ / "runs/crimp", to / "crimp", fs::copy_options::recursive);
    state::write(to / "mesher/state_000000.h5", anatomy);
  }
  static Outcome deploy(const std::string& scene, const std::string& out, const std::string& options) {
    return run(DEPLOY_PROGRAM, scene + "/" + out, options);
  }
  static nlohmann::json summary(const std::string& scene, const std::string& out) {
    return nlohmann::json::parse(
        std::ifstream(*folder_ / fmt::format("runs/{}/{}/summary.json", scene, out)));
  }
  static fs::path newest(const std::string& scene, const std::string& out) {
    fs::path last;
    for (const auto& entry : fs::directory_iterator(*folder_ / fmt::format("runs/{}/{}", scene, out)))
      if (entry.path().extension() == ".h5" && entry.path() > last) last = entry.path();
    return last;
  }

  static std::unique_ptr<test::TemporaryFolder> folder_;
};

std::unique_ptr<test::TemporaryFolder> Deploy::folder_;

TEST_F(Deploy, StentOpensTheFlapsAndRestsAgainstTheWall) {
  scene("flaps", test::tube(6.5, true));
  const Outcome outcome = deploy("flaps", "deploy", "");
  ASSERT_EQ(outcome.code, 0) << outcome.text;
  const nlohmann::json s = summary("flaps", "deploy");
  const auto& m = s["metrics"];
  EXPECT_NEAR(m["implant_depth_mm"].get<double>(), 5, 1);
  EXPECT_LT(m["max_penetration_mm"].get<double>(), 0.2);
  EXPECT_GT(m["chronic_outward_force_N"].get<double>(), 0.1);
  EXPECT_GT(m["contact_area_mm2"].get<double>(), 1);
  EXPECT_LT(m["expanded_diameter_annulus_mm"].get<double>(), 13.5);
  EXPECT_GT(m["expanded_diameter_annulus_mm"].get<double>(), 11);
  EXPECT_LT(m["eccentricity"].get<double>(), 0.1);
  EXPECT_LT(m["kinetic_to_internal_energy_end"].get<double>(), 0.05);
  for (const auto& [name, check] : s["checks"].items())
    EXPECT_TRUE(check["pass"].get<bool>()) << name << check;
  const state::State last = state::read_final(newest("flaps", "deploy"), "deploy");
  for (const char* mesh : {"frame", "native_leaflets", "lumen"}) EXPECT_TRUE(last.has_mesh(mesh)) << mesh;
  for (const char* entry : {"levelset/lumen", "anatomy/annulus_diameter_mm", "device/nominal_size_mm",
                            "frame/rotation", "deploy/contact_force_uN", "deploy/friction_capacity_uN"})
    EXPECT_TRUE(last.has_array(entry)) << entry;
}

TEST_F(Deploy, SheathDrawnBackEndsInTheSamePlace) {
  scene("plain", test::tube(6.5, false));
  ASSERT_EQ(deploy("plain", "deploy", "").code, 0);
  const Outcome drawn =
      deploy("plain", "sheath", "--set deploy.release=sheath --set deploy.sheath_speed_mm_per_s=800");
  ASSERT_EQ(drawn.code, 0) << drawn.text;
  const double one = summary("plain", "deploy")["metrics"]["expanded_diameter_annulus_mm"];
  const double two = summary("plain", "sheath")["metrics"]["expanded_diameter_annulus_mm"];
  EXPECT_NEAR(one, two, 0.3);
  EXPECT_NEAR(summary("plain", "sheath")["metrics"]["implant_depth_mm"].get<double>(), 5, 1);
}

TEST_F(Deploy, ResumedRunsGiveTheSameBits) {
  scene("resume", test::tube(6.5, true));
  const std::string brief =
      "--set deploy.open_ramp_ms=2 --set deploy.open_hold_ms=1 --set deploy.expand_ms=2 --set "
      "deploy.settle_ms=2 ";
  ASSERT_EQ(deploy("resume", "whole", brief).code, 0);
  // Stopped once in each act.
  ASSERT_EQ(deploy("resume", "parts", brief + "--steps 120").code, 0);
  ASSERT_EQ(deploy("resume", "parts", brief + "--resume --steps 337").code, 0);
  ASSERT_EQ(deploy("resume", "parts", brief + "--resume").code, 0);
  const state::State a = state::read_final(newest("resume", "whole"), "deploy");
  const state::State b = state::read_final(newest("resume", "parts"), "deploy");
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.step, b.step);
  for (const auto& [name, mesh] : a.meshes) EXPECT_EQ(mesh.points, b.mesh(name).points) << name;
  ASSERT_EQ(a.restart.size(), b.restart.size());
  for (const auto& [name, array] : a.restart) EXPECT_EQ(array.data, b.array(name).data) << name;
}

TEST_F(Deploy, StartsFromAGivenStateWithTheOtherParentBesideIt) {
  scene("given", test::tube(6.5, true));
  const std::string brief = "--set deploy.open_ramp_ms=1 --set deploy.open_hold_ms=1 --steps 50 --from ";
  const std::string crimped = newest("given", "crimp").string(), anatomy = newest("given", "mesher").string();
  for (const std::string& parent : {crimped, anatomy}) {
    const Outcome out = deploy("elsewhere", "deploy", brief + parent);
    EXPECT_EQ(out.code, 0) << out.text;
    EXPECT_TRUE(summary("elsewhere", "deploy")["inputs"].contains(crimped));
    EXPECT_TRUE(summary("elsewhere", "deploy")["inputs"].contains(anatomy));
  }
  const Outcome wrong = deploy("elsewhere", "other", brief + newest("", "stent").string());
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.text.find("expected one of stage 'crimp' or 'mesher'"), std::string::npos) << wrong.text;
}

TEST_F(Deploy, ThreadsDoNotChangeABit) {
  scene("threads", test::tube(6.5, true));
  const std::string brief = "--set deploy.open_ramp_ms=1 --set deploy.open_hold_ms=1 --steps 300";
  const auto with = [&](int threads) {
    const std::string out = fmt::format("with_{}", threads);
    EXPECT_EQ(
        run(fmt::format("env OMP_NUM_THREADS={} {}", threads, DEPLOY_PROGRAM), "threads/" + out, brief).code,
        0);
    return state::read(newest("threads", out), "deploy").mesh("frame").points;
  };
  EXPECT_EQ(with(1), with(3));
}

TEST_F(Deploy, RefusesWhatCannotWork) {
  scene("narrow", test::tube(3.0, false));
  const Outcome narrow = deploy("narrow", "deploy", "");
  EXPECT_EQ(narrow.code, 2);
  EXPECT_NE(narrow.text.find("does not fit into the lumen"), std::string::npos) << narrow.text;

  state::State unfinished = test::tube(6.5, false);
  unfinished.final = false;
  scene("unfinished", unfinished);
  EXPECT_EQ(deploy("unfinished", "deploy", "").code, 2);

  state::State bare = test::tube(6.5, false);
  bare.restart.erase("levelset/lumen");
  scene("bare", bare);
  const Outcome missing = deploy("bare", "deploy", "");
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.text.find("levelset/lumen"), std::string::npos) << missing.text;

  EXPECT_EQ(deploy("bare", "other", "--set deploy.depth_mm=500").code, 2);
  EXPECT_EQ(deploy("bare", "other", "--set deploy.dephth_mm=5").code, 2);
}

}  // namespace
}  // namespace valsalva
