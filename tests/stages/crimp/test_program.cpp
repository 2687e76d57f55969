// The executable on a small device: result, balance, restart bit for bit, refusals.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "small_device.hpp"

namespace valsalva::crimp {
namespace {

namespace fs = std::filesystem;

class Program : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("valsalva_crimp_{}", getpid());
    fs::create_directories(folder_);
    std::ofstream(folder_ / "case.toml")
        << "[device]\n[crimp]\ndiameter_mm = 5\nsettle_ms = 4\nstep_us = 3\n";
    state::write(folder_ / "stent.h5", test::small_device(true));
    state::write(folder_ / "frame.h5", test::small_device(false));
  }
  void TearDown() override { fs::remove_all(folder_); }

  int run(const std::string& out, const std::string& options) {
    const std::string command =
        fmt::format("cd {} && OMP_NUM_THREADS=1 {} case.toml --quiet --fidelity draft --out {} {} > log 2>&1",
                    folder_.string(), CRIMP_PROGRAM, out, options);
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(folder_ / "log").rdbuf();
    log_ = text.str();
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  nlohmann::json summary(const std::string& out) const {
    return nlohmann::json::parse(std::ifstream(folder_ / out / "summary.json"));
  }
  state::State last(const std::string& out) const {
    fs::path newest;
    for (const auto& entry : fs::directory_iterator(folder_ / out))
      if (entry.path().extension() == ".h5" && entry.path() > newest) newest = entry.path();
    return state::read(newest, "crimp");
  }

  fs::path folder_;
  std::string log_;
};

TEST_F(Program, CrimpsASkirtInsideAFrameWithoutCrossings) {
  ASSERT_EQ(run("run", "--from stent.h5"), 0) << log_;
  const auto s = summary("run");
  EXPECT_NEAR(s["metrics"]["crimped_diameter_mm"].get<double>(), 5, 0.1);
  EXPECT_GT(s["metrics"]["radial_force_N"].get<double>(), 0);
  EXPECT_TRUE(s["checks"]["edges_through_tissue"]["pass"].get<bool>());
  EXPECT_TRUE(s["checks"]["inverted_elements"]["pass"].get<bool>());
  const state::State out = last("run");
  EXPECT_TRUE(out.final);
  EXPECT_EQ(out.mesh("skirt").point_data.count("mounted"), 1u);
  for (const char* name : {"frame/rotation", "frame/velocity", "skirt/velocity", "frame/angular_velocity",
                           "ties/skirt", "crimp/diameter_mm", "device/inflow_z_mm"})
    EXPECT_TRUE(out.has_array(name)) << name;
}

TEST_F(Program, StoppedAndResumedGivesTheSameBits) {
  ASSERT_EQ(run("whole", "--from stent.h5 --steps 900"), 0) << log_;
  ASSERT_EQ(run("parts", "--from stent.h5 --steps 433"), 0) << log_;
  ASSERT_EQ(run("parts", "--from stent.h5 --resume --steps 300"), 0) << log_;
  ASSERT_EQ(run("parts", "--from stent.h5 --resume --steps 167"), 0) << log_;
  const state::State a = last("whole"), b = last("parts");
  EXPECT_EQ(a.time_s, b.time_s);
  for (const char* body : {"frame", "skirt"}) EXPECT_EQ(a.mesh(body).points, b.mesh(body).points) << body;
  ASSERT_EQ(a.restart.size(), b.restart.size());
  for (const auto& [name, array] : a.restart) EXPECT_EQ(array.data, b.array(name).data) << name;
}

TEST_F(Program, ABareFrameObeysTheEnergyBalance) {
  ASSERT_EQ(run("run", "--from frame.h5"), 0) << log_;
  std::ifstream history(folder_ / "run" / "history.csv");
  std::string line, last_line;
  while (std::getline(history, line)) last_line = line;
  std::vector<double> v;
  std::istringstream row(last_line);
  for (std::string cell; std::getline(row, cell, ',');) v.push_back(std::stod(cell));
  const double kinetic = v[3], internal = v[4], work = v[6], damping = v[7];
  EXPECT_GT(internal, 0);
  EXPECT_NEAR(kinetic + internal + damping, work, 0.05 * work);
  EXPECT_EQ(summary("run")["metrics"].count("max_leaflet_stretch"), 0u);
}

TEST_F(Program, RefusesWhatItCannotUse) {
  EXPECT_EQ(run("run", "--from stent.h5 --set crimp.diameter_mm=12"), 2);
  EXPECT_NE(log_.find("nothing to crimp"), std::string::npos) << log_;
  EXPECT_EQ(run("run", "--from stent.h5 --set crimp.speed_mm_per_s=-1"), 2);
  EXPECT_EQ(run("run", "--from stent.h5 --set contact.wide_skin_mm=0.03"), 2);
  EXPECT_EQ(run("run", "--from nowhere.h5"), 2);
  auto broken = test::small_device(true);
  broken.restart.erase("ties/skirt");
  state::write(folder_ / "broken.h5", broken);
  EXPECT_EQ(run("run", "--from broken.h5"), 2);
  EXPECT_NE(log_.find("ties/skirt"), std::string::npos) << log_;
}

}  // namespace
}  // namespace valsalva::crimp
