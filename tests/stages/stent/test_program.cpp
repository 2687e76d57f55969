// The executable: exit codes, what it writes, and that it writes nothing when it refuses.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "graph_file.hpp"
#include "library.hpp"
#include "state/state.hpp"

namespace valsalva::stent {
namespace {

namespace fs = std::filesystem;

class Program : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("valsalva_stent_{}", getpid());
    fs::create_directories(folder_);
    std::ofstream(folder_ / "case.toml") << "[case]\nfidelity = \"draft\"\n[device]\nleaflet_edge_mm = 0.9\n"
                                            "skirt_edge_mm = 1.5\n";
  }
  void TearDown() override { fs::remove_all(folder_); }

  int run(const std::string& options) {
    const std::string command = fmt::format("cd {} && {} case.toml --quiet --out run {} > log 2>&1",
                                            folder_.string(), STENT_PROGRAM, options);
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(folder_ / "log").rdbuf();
    log_ = text.str();
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  bool said(const std::string& what) const { return log_.find(what) != std::string::npos; }
  state::State result() const { return state::read_final(folder_ / "run" / "state_000000.h5", "stent"); }

  fs::path folder_;
  std::string log_;
};

TEST_F(Program, WritesWhatTheNextStagesNeed) {
  ASSERT_EQ(run("--set device.size_mm=26"), 0) << log_;
  const state::State s = result();
  EXPECT_EQ(s.mesh("frame").cells(), 840u);
  for (const char* body : {"frame", "leaflets", "skirt"})
    EXPECT_EQ(s.mesh(body).point_data.count("reference"), 1u);
  for (const char* body : {"leaflets", "skirt"}) {
    const state::Mesh& mesh = s.mesh(body);
    for (const char* name : {"thickness_mm", "attached"}) EXPECT_EQ(mesh.point_data.count(name), 1u);
    for (const char* name : {"leaflet", "fibre1", "fibre2"}) EXPECT_EQ(mesh.cell_data.count(name), 1u);
    const state::Array& ties = s.array(std::string("ties/") + body);
    ASSERT_EQ(ties.shape.size(), 2u);
    EXPECT_EQ(ties.shape[1], 2u);
    EXPECT_GT(ties.shape[0], 20u);
  }
  EXPECT_EQ(s.array("device/nominal_size_mm").number("size"), 26);
  EXPECT_EQ(s.array("device/inflow_z_mm").number("inflow"), 0);
  EXPECT_NEAR(s.array("device/commissure_z_mm").number("commissure"), 26, 1e-9);
  EXPECT_EQ(s.array("device/commissure_angles_rad").doubles("angles").size(), 3u);
  EXPECT_TRUE(fs::exists(folder_ / "run" / "summary.json"));
}

TEST_F(Program, TwoRunsGiveTheSameBits) {
  ASSERT_EQ(run("--set device.size_mm=26"), 0) << log_;
  const state::State first = result();
  ASSERT_EQ(run("--set device.size_mm=26"), 0) << log_;
  const state::State second = result();
  for (const char* body : {"frame", "leaflets", "skirt"}) {
    EXPECT_EQ(first.mesh(body).points, second.mesh(body).points);
    EXPECT_EQ(first.mesh(body).connectivity, second.mesh(body).connectivity);
  }
}

TEST_F(Program, FrameWithoutTissue) {
  ASSERT_EQ(run("--set device.frame=cylinder --set device.size_mm=24 --set device.tissue=false"), 0) << log_;
  EXPECT_FALSE(result().has_mesh("leaflets"));
}

TEST_F(Program, CylinderWithTissue) {
  ASSERT_EQ(run("--set device.frame=cylinder --set device.size_mm=24"), 0) << log_;
  EXPECT_TRUE(result().has_mesh("leaflets"));
}

TEST_F(Program, GraphFrameWithTissue) {
  std::ofstream(folder_ / "frame.json") << graph_text(build_frame(supra_annular(26).frame));
  ASSERT_EQ(run("--set device.frame=graph --set device.graph_file=frame.json"), 0) << log_;
  const state::State s = result();
  EXPECT_TRUE(s.has_mesh("skirt"));
  EXPECT_NEAR(s.array("device/nominal_size_mm").number("size"), 26, 1e-9);
}

TEST_F(Program, RefusesBadInputAndWritesNothing) {
  const std::pair<const char*, const char*> bad[] = {
      {"--set device.size_mm=27", "expected 23, 26, 29 or 34"},
      {"--set device.size_mm=26 --set device.thickness_mm=-1", "device.thickness_mm"},
      {"--set device.size_mm=26 --set device.wdith=1", "wdith"},
      {"--set device.frame=graph", "device.graph_file"},
      {"--set device.frame=graph --set device.graph_file=none.json", "none.json"},
      {"--set device.size_mm=26 --set device.cells=16", "multiple of 3"},
      {"--set device.size_mm=26 --set device.cells=30 --set device.strut_width_mm=1.5", "do not fit"},
      {"", "segment"},
  };
  for (const auto& [options, because] : bad) {
    EXPECT_EQ(run(options), 2) << options << "\n" << log_;
    EXPECT_TRUE(said(because)) << options << "\n" << log_;
    EXPECT_FALSE(fs::exists(folder_ / "run" / "state_000000.h5")) << options;
  }
}

}  // namespace
}  // namespace valsalva::stent
