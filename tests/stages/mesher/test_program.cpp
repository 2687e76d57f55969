// The executable from segment's state to its own, and what it refuses.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "geometry/surface.hpp"
#include "synthetic_root.hpp"
#include "temporary_folder.hpp"

namespace valsalva {
namespace {

namespace fs = std::filesystem;

class Mesher : public testing::Test {
 protected:
  test::TemporaryFolder folder_;

  fs::path at(const std::string& name) const { return folder_.path() / name; }
  void write_case(const std::string& text) const {
    std::ofstream(at("case.toml")) << "[case]\nname = \"t\"\n" << text;
  }
  int run(const std::string& more) const {
    const std::string command = std::string(MESHER_PROGRAM) + " " + at("case.toml").string() +
                                " --fidelity draft --from " + at("segment.h5").string() + " --out " +
                                at("out").string() + " " + more + " > " + at("log").string() + " 2>&1";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string log() const {
    std::ifstream in(at("log"));
    return {std::istreambuf_iterator<char>(in), {}};
  }
  nlohmann::json summary() const { return nlohmann::json::parse(std::ifstream(at("out") / "summary.json")); }
};

TEST_F(Mesher, MeshesLumenWallAndLeaflets) {
  const test::SyntheticRoot root;
  state::write(at("segment.h5"), root.state());
  write_case("[mesh]\nsurface_edge_mm = 2.0\n[native]\n");
  ASSERT_EQ(run(""), 0) << log();

  const auto result = state::read_final(at("out") / "state_000000.h5", "mesher");
  for (const char* entry : {"levelset/lumen", "levelset/origin_mm", "levelset/spacing_mm", "anatomy/z_mm",
                            "anatomy/commissure_angles_rad", "anatomy/annulus_diameter_mm"})
    EXPECT_TRUE(result.has_array(entry)) << entry;
  const geometry::TriMesh lumen{result.mesh("lumen").points, result.mesh("lumen").triangles("lumen")};
  EXPECT_TRUE(geometry::border_loops(lumen).empty());
  EXPECT_GT(geometry::enclosed_volume(lumen), 0);
  EXPECT_EQ(result.mesh("wall").cell_data.count("region"), 1u);
  const state::Mesh& leaflets = result.mesh("native_leaflets");
  for (const char* name : {"reference", "thickness_mm", "attached"})
    EXPECT_EQ(leaflets.point_data.count(name), 1u) << name;
  for (const char* name : {"leaflet", "fibre1", "fibre2"})
    EXPECT_EQ(leaflets.cell_data.count(name), 1u) << name;

  const auto s = summary();
  for (const char* metric : {"nodes", "elements", "min_dihedral_deg", "max_aspect", "min_scaled_jacobian",
                             "volume_error_pct", "fibre_unit_error_max"})
    EXPECT_TRUE(s["metrics"].contains(metric)) << metric;
  for (const auto& [name, check] : s["checks"].items())
    EXPECT_TRUE(check["pass"].get<bool>()) << name << " " << check;
}

TEST_F(Mesher, WithoutNativeTableThereAreNoLeaflets) {
  state::write(at("segment.h5"), test::SyntheticRoot().state());
  write_case("[mesh]\nsurface_edge_mm = 2.0\n");
  ASSERT_EQ(run(""), 0) << log();
  EXPECT_FALSE(state::read_final(at("out") / "state_000000.h5", "mesher").has_mesh("native_leaflets"));
}

TEST_F(Mesher, RepairsAndSaysSo) {
  auto state = test::SyntheticRoot().state();
  auto& connectivity = state.meshes["lumen"].connectivity;
  std::swap(connectivity[3000], connectivity[3001]);
  state::write(at("segment.h5"), state);
  write_case("[mesh]\nsurface_edge_mm = 2.0\n");
  ASSERT_EQ(run(""), 0) << log();
  EXPECT_NE(log().find("1 flipped triangles turned"), std::string::npos) << log();
  EXPECT_EQ(summary()["metrics"]["surface_repairs"], 1);
}

struct Refusal {
  const char* name;
  void (*spoil)(state::State&);
  const char* word;
};

class MesherRefuses : public Mesher, public testing::WithParamInterface<Refusal> {};

TEST_P(MesherRefuses, WithExitCodeTwoAndTheEntry) {
  auto state = test::SyntheticRoot().state();
  GetParam().spoil(state);
  state::write(at("segment.h5"), state);
  write_case("[mesh]\nsurface_edge_mm = 2.0\n[native]\n");
  EXPECT_EQ(run(""), 2);
  EXPECT_NE(log().find(GetParam().word), std::string::npos) << log();
}

INSTANTIATE_TEST_SUITE_P(
    Table, MesherRefuses,
    testing::Values(
        Refusal{"wrong_stage", [](state::State& s) { s.stage = "stent"; }, "segment"},
        Refusal{"unfinished", [](state::State& s) { s.final = false; }, "finish"},
        Refusal{"no_surface", [](state::State& s) { s.meshes.erase("lumen"); }, "lumen"},
        Refusal{"no_level_set", [](state::State& s) { s.restart.erase("levelset/lumen"); }, "levelset/lumen"},
        Refusal{"zero_spacing",
                [](state::State& s) { s.restart["levelset/spacing_mm"] = state::Array::scalar(0); },
                "spacing_mm"},
        Refusal{"two_commissures",
                [](state::State& s) {
                  s.restart["anatomy/commissure_angles_rad"] = state::Array::of(std::vector<double>{0, 2});
                },
                "commissure_angles_rad"},
        Refusal{"planes_reversed",
                [](state::State& s) {
                  s.restart["anatomy/z_mm"] = state::Array::of(std::vector<double>{32, 20, 0, 10, -5, -10});
                },
                "z_mm"},
        Refusal{"large_hole",
                [](state::State& s) {
                  auto& mesh = s.meshes["lumen"];
                  const auto triangles = mesh.triangles("lumen");
                  std::vector<Triangle> kept;
                  for (const auto& t : triangles)
                    if (!(mesh.points[t[0]].x() > 8 && std::abs(mesh.points[t[0]].z() - 10) < 5))
                      kept.push_back(t);
                  mesh = state::Mesh::of_triangles(mesh.points, kept);
                },
                "hole of"},
        Refusal{"surface_elsewhere",
                [](state::State& s) {
                  for (Vec3& p : s.meshes["lumen"].points) p.z() += 500;
                },
                "overlap"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_F(Mesher, ClosedLeafletsAreNotShorterThanFreeOnes) {
  state::write(at("segment.h5"), test::SyntheticRoot().state());
  write_case("[native]\nclosed_stretch = 0.5\n");
  EXPECT_EQ(run("--check"), 2);
  EXPECT_NE(log().find("native.closed_stretch"), std::string::npos) << log();
}

TEST_F(Mesher, MissingParentNamesTheCommand) {
  write_case("");
  EXPECT_EQ(run(""), 2);
  EXPECT_NE(log().find("segment"), std::string::npos) << log();
}

}  // namespace
}  // namespace valsalva
