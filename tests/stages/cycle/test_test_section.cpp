// The executable on a valve in a test section: the library's cases of reproduced systems, and what is
// refused.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <fstream>
#include <sstream>

#include "state/state.hpp"
#include "temporary_folder.hpp"

namespace valsalva {
namespace {

namespace fs = std::filesystem;

struct Outcome {
  int code;
  std::string text;
};

class TestSection : public testing::Test {
 protected:
  Outcome run(const std::string& options) const {
    const std::string command = fmt::format("cd {} && {} {} --quiet --out runs > log 2>&1",
                                            folder_.path().string(), CYCLE_PROGRAM, options);
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << std::ifstream(folder_ / "log").rdbuf();
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text.str()};
  }
  static std::string library(const std::string& name) {
    return (fs::path(CASES) / (name + ".toml")).string();
  }
  test::TemporaryFolder folder_;
};

// Coarse: what is tested is that the case files are complete, not what they give.
constexpr const char* coarse = " --set fluid.spacing_mm=2 --set body.leaflets.divisions=[16,8]";

TEST_F(TestSection, TheLibrarysCasesTakeSteps) {
  for (const std::string name : {"pulse-duplicator-2020", "leaflet-flutter-2022"}) {
    const Outcome checked = run(library(name) + " --check");
    EXPECT_EQ(checked.code, 0) << checked.text;
    const Outcome done = run(library(name) + coarse + " --steps 12");
    ASSERT_EQ(done.code, 0) << done.text;
    const state::State last = state::read(folder_ / "runs" / "state_000012.h5", "cycle");
    for (const char* mesh : {"leaflets", "mount", "lumen"}) EXPECT_TRUE(last.has_mesh(mesh)) << mesh;
    EXPECT_GT(last.time_s, 0);
    // Sewn nodes stay, others have moved.
    const Points start = last.point_data("leaflets", "start").points("start");
    const auto& attached = last.point_data("leaflets", "attached").integers("attached");
    double moved = 0;
    for (std::size_t a = 0; a < start.size(); ++a) {
      const double way = (last.mesh("leaflets").points[a] - start[a]).norm();
      if (attached[a])
        EXPECT_EQ(way, 0);
      else
        moved = std::max(moved, way);
    }
    EXPECT_GT(moved, 0);
  }
}

TEST_F(TestSection, RefusesWhatIsNoValveInAVessel) {
  const std::string flutter = library("leaflet-flutter-2022") + " --check";
  const auto refused = [&](const std::string& options, const std::string& words) {
    const Outcome outcome = run(flutter + options);
    EXPECT_EQ(outcome.code, 2) << options;
    EXPECT_NE(outcome.text.find(words), std::string::npos) << outcome.text;
  };
  refused(" --set body.stent.kind=shell --set body.stent.material=contact-fsi-2021/stent", "expected one");
  refused(" --set body.leaflets.material=thickness-anisotropy-2016/leaflet-ogden",
          "expected hgo, neo-hookean");
  refused(" --set body.leaflets.fibres=none", "its law has fibres");
  refused(" --set body.leaflets.copies=2", "three leaflets");
  refused(" --set body.leaflets.shell_element=kirchhoff", "shell_element");
  refused(" --set test_section.z_mm=[0,-15,20.4,60]", "ascending");
  refused(" --set test_section.radius_mm=[11,12]", "as many");
}

}  // namespace
}  // namespace valsalva
