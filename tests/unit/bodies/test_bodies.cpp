// What is written into a state file and read back is the same; what does not fit is refused by name.
#include <gtest/gtest.h>

#include "bodies/frame.hpp"
#include "bodies/level_set.hpp"
#include "bodies/shell.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace valsalva::bodies {
namespace {

using test::expect_error;

structure::ShellMesh sheet() {
  structure::ShellMesh shell;
  shell.reference = {{0, 0, 0}, {1, 0, 0}, {0, 1, 1.0 / 3}, {1, 1, 0.1}};
  shell.triangles = {{0, 1, 2}, {1, 3, 2}};
  shell.thickness_mm = {0.3, 0.31, 0.32, 0.33};
  shell.fibre1 = {Vec3::UnitX(), Vec3::UnitY()};
  shell.fibre2 = {Vec3::UnitY(), Vec3::UnitX()};
  return shell;
}

state::State device() {
  state::State s;
  s.stage = "stent";
  s.source = "device.h5";
  s.final = true;
  const Points frame{{10, 0, 0}, {0, 10, 3}, {-10, 0, 6}};
  s.meshes["frame"] = frame_mesh(frame, {frame, {{0, 1}, {1, 2}}, {0.25, 0.26}, {0.4, 0.41}, {}});
  const structure::ShellMesh skirt = sheet();
  s.meshes["skirt"] = shell_mesh(skirt.reference, skirt, {1, 0, 0, 1}, {3, 3});
  s.restart["ties/skirt"] = tie_array({{0, 2}, {3, 1}});
  return s;
}

state::State written_and_read(const state::State& s) {
  const test::TemporaryFolder folder;
  state::write(folder / "state_000000.h5", s);
  return state::read_final(folder / "state_000000.h5", s.stage);
}

TEST(Bodies, FrameComesBackAsWritten) {
  const structure::BeamMesh frame = read_frame(written_and_read(device()));
  EXPECT_EQ(frame.reference[2], Vec3(-10, 0, 6));
  EXPECT_EQ(frame.elements, (std::vector<Edge>{{0, 1}, {1, 2}}));
  EXPECT_EQ(frame.width_mm, (std::vector<double>{0.25, 0.26}));
  EXPECT_EQ(frame.depth_mm, (std::vector<double>{0.4, 0.41}));
  EXPECT_LT((frame.depth_axis[0] - Vec3(1, 1, 0).normalized()).norm(), 1e-12);
}

TEST(Bodies, RotationsComeBackAsWritten) {
  const std::vector<Eigen::Quaterniond> turned{
      Eigen::Quaterniond::Identity(), Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())),
      Eigen::Quaterniond(Eigen::AngleAxisd(-2, Vec3::UnitX()))};
  state::State s = device();
  s.restart["frame/rotation"] = rotation_array(turned);
  const auto found = read_rotations(written_and_read(s), 3);
  for (int a = 0; a < 3; ++a) EXPECT_LT(found[a].angularDistance(turned[a]), 1e-15);
  expect_error(ExitCode::input, {"device.h5", "frame/rotation", "12", "16"}, [&] { read_rotations(s, 4); });
}

TEST(Bodies, ShellComesBackAsWritten) {
  const state::State s = written_and_read(device());
  const structure::ShellMesh found = read_shell(s, "skirt"), expected = sheet();
  EXPECT_EQ(found.reference, expected.reference);
  EXPECT_EQ(found.triangles, expected.triangles);
  EXPECT_EQ(found.thickness_mm, expected.thickness_mm);
  EXPECT_EQ(found.fibre1, expected.fibre1);
  EXPECT_EQ(found.fibre2, expected.fibre2);
  EXPECT_EQ(found.stiffness_factor, (std::vector<double>{1, 1}));
  EXPECT_EQ(read_attached(s, "skirt"), (std::vector<bool>{true, false, false, true}));
  EXPECT_EQ(read_ties(s, "skirt", 4, 3), (std::vector<Edge>{{0, 2}, {3, 1}}));
}

TEST(Bodies, StiffnessFactorsMultiply) {
  structure::ShellMesh calcified = sheet();
  calcified.stiffness_factor = {1, 20};
  state::State s = device();
  s.meshes["skirt"] = shell_mesh(calcified.reference, calcified, {0, 0, 0, 0}, {0, 0});
  EXPECT_EQ(read_shell(s, "skirt", 3).stiffness_factor, (std::vector<double>{3, 60}));
}

TEST(Bodies, WhatIsMissingIsNamed) {
  state::State s = device();
  s.meshes["skirt"].point_data.erase("thickness_mm");
  expect_error(ExitCode::input, {"device.h5", "skirt", "thickness_mm", "stent"},
               [&] { read_shell(s, "skirt"); });
  s.meshes["frame"].cell_data.erase("depth_mm");
  expect_error(ExitCode::input, {"device.h5", "frame", "depth_mm", "stent"}, [&] { read_frame(s); });
  expect_error(ExitCode::input, {"no mesh 'leaflets'"}, [&] { read_shell(s, "leaflets"); });
}

TEST(Bodies, TiesToNodesThatAreNotThereAreRefused) {
  state::State s = device();
  expect_error(ExitCode::input, {"device.h5", "ties/skirt", "node 3", "frame node 1"},
               [&] { read_ties(s, "skirt", 3, 3); });
  s.restart["ties/skirt"] = state::Array::of(std::vector<std::int64_t>{0, 1, 2});
  expect_error(ExitCode::input, {"ties/skirt", "3 integers", "pairs"}, [&] { read_ties(s, "skirt", 4, 3); });
}

TEST(Bodies, LevelSetComesBackAsWritten) {
  geometry::GridSdf grid =
      geometry::sample({-1, -2, -3}, {1, 1, 1}, 0.5, [](const Vec3& x) { return x.norm() - 1; });
  state::State s = device();
  put_level_set(s, "lumen", grid);
  const geometry::GridSdf found = read_level_set(written_and_read(s), "lumen");
  EXPECT_EQ(found.dimensions, grid.dimensions);
  EXPECT_EQ(found.origin, grid.origin);
  EXPECT_EQ(found.spacing, grid.spacing);
  EXPECT_EQ(found.values, grid.values);

  expect_error(ExitCode::input, {"no entry 'levelset/calcium'"}, [&] { read_level_set(s, "calcium"); });
  s.restart["levelset/spacing_mm"] = state::Array::scalar(0);
  expect_error(ExitCode::input, {"levelset/spacing_mm", "positive", "stent"},
               [&] { read_level_set(s, "lumen"); });
  s.restart["levelset/origin_mm"] = state::Array::of(std::vector<double>{0, 0});
  expect_error(ExitCode::input, {"levelset/origin_mm", "2 values"}, [&] { read_level_set(s, "lumen"); });
  s.restart["levelset/lumen"] = state::Array::of(grid.values, {grid.values.size()});
  expect_error(ExitCode::input, {"levelset/lumen", "1 dimensions"}, [&] { read_level_set(s, "lumen"); });
}

}  // namespace
}  // namespace valsalva::bodies
