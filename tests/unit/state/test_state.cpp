#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/run_folder.hpp"
#include "expect_error.hpp"
#include "state/state.hpp"
#include "temporary_folder.hpp"

namespace valsalva::state {
namespace {

using test::expect_error;

State sample() {
  State state;
  state.stage = "crimp";
  state.case_name = "demo";
  state.time_s = 0.1 + 0.2;
  state.step = 42;
  state.final = true;
  state.parameters = "crimp.speed_mm_per_s = 500\n";
  state.parents = {"stent/state_000001.h5 abc"};
  Mesh mesh = Mesh::of_triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 1.0 / 3.0}}, {{0, 1, 2}});
  mesh.point_data["reference"] = Array::of(mesh.points);
  mesh.cell_data["leaflet"] = Array::of(std::vector<std::int64_t>{2});
  state.meshes["leaflets"] = mesh;
  Image image;
  image.dimensions = {2, 2, 2};
  image.spacing = Vec3(0.5, 0.5, 0.5);
  image.point_data["pressure_mmHg"] = Array::of(std::vector<float>(8, 1.5f), {2, 2, 2});
  state.images["fluid"] = image;
  state.restart["leaflets/velocity"] = Array::of(std::vector<double>{1, 2, 3}, {1, 3});
  state.restart["history/values"] = Array::of(std::vector<double>(10000, 0.1));
  state.texts["notes/method"] = "explicit";
  return state;
}

TEST(State, RoundTripsBitForBit) {
  const test::TemporaryFolder folder;
  const State written = sample();
  write(folder / "state_000001.h5", written);
  const State found = read_final(folder / "state_000001.h5", "crimp");
  EXPECT_EQ(found.time_s, written.time_s);
  EXPECT_EQ(found.step, 42);
  EXPECT_EQ(found.parameters, written.parameters);
  EXPECT_EQ(found.parents, written.parents);
  EXPECT_EQ(found.mesh("leaflets").points[2], written.mesh("leaflets").points[2]);
  EXPECT_EQ(found.mesh("leaflets").triangles("leaflets")[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(found.mesh("leaflets").cell_data.at("leaflet").integers("leaflet")[0], 2);
  EXPECT_EQ(found.images.at("fluid").point_data.at("pressure_mmHg").floats("p")[7], 1.5f);
  EXPECT_EQ(found.array("leaflets/velocity").points("v")[0], Vec3(1, 2, 3));
  EXPECT_EQ(found.array("history/values").doubles("h"), written.array("history/values").doubles("h"));
  EXPECT_EQ(found.texts.at("notes/method"), "explicit");
  EXPECT_FALSE(std::filesystem::exists(folder / "state_000001.h5.part"));
}

TEST(State, AFileCutAnywhereIsRefused) {
  const test::TemporaryFolder folder;
  write(folder / "state_000001.h5", sample());
  std::ifstream whole(folder / "state_000001.h5", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(whole)), {});
  for (int tenth = 0; tenth < 10; ++tenth) {
    std::ofstream(folder / "cut.h5", std::ios::binary) << bytes.substr(0, bytes.size() * tenth / 10);
    expect_error(ExitCode::input, {"cut.h5"}, [&] { read(folder / "cut.h5", "crimp"); });
  }
}

TEST(State, TheWrongStageIsNamed) {
  const test::TemporaryFolder folder;
  write(folder / "s.h5", sample());
  expect_error(ExitCode::input, {"'crimp'", "'deploy'"}, [&] { read(folder / "s.h5", "deploy"); });
}

TEST(State, AnUnfinishedParentIsRefused) {
  const test::TemporaryFolder folder;
  State state = sample();
  state.final = false;
  write(folder / "s.h5", state);
  expect_error(ExitCode::input, {"has not finished", "--resume"},
               [&] { read_final(folder / "s.h5", "crimp"); });
}

TEST(State, AValueThatIsNotFiniteIsNeverWritten) {
  const test::TemporaryFolder folder;
  write(folder / "s.h5", sample());
  State bad = sample();
  bad.meshes["leaflets"].points[1].x() = std::nan("");
  expect_error(ExitCode::numerical, {"leaflets", "node 1"}, [&] { write(folder / "s.h5", bad); });
  bad = sample();
  bad.restart["heart/volume"] = Array::scalar(INFINITY);
  expect_error(ExitCode::numerical, {"heart/volume"}, [&] { write(folder / "s.h5", bad); });
  EXPECT_EQ(read(folder / "s.h5", "").step, 42);  // the good one stands
}

TEST(State, AFullDiskIsAnEnvironmentError) {
  expect_error(ExitCode::environment, {"failed", "--resume"}, [] { write("/proc/s.h5", sample()); });
}

TEST(State, WhatIsMissingIsNamedWithItsStage) {
  const State state = sample();
  expect_error(ExitCode::input, {"crimp", "frame"}, [&] { state.mesh("frame"); });
  expect_error(ExitCode::input, {"crimp", "levelset/lumen"}, [&] { state.array("levelset/lumen"); });
}

TEST(State, ViewsLinkIntoEveryKeptState) {
  const test::TemporaryFolder folder;
  const RunFolder run(folder / "crimp");
  for (const long index : {1, 2}) write(run.state_path(index), sample());
  write_views(run.path(), run.state_path(2));
  for (const char* name :
       {"view_leaflets.hdf", "view_leaflets.hdf.series", "view_leaflets_000001.hdf", "view_fluid.hdf"})
    EXPECT_TRUE(std::filesystem::exists(run.file(name))) << name;
}

}  // namespace
}  // namespace valsalva::state
