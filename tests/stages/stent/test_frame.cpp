#include "frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "core/errors.hpp"
#include "library.hpp"

namespace valsalva::stent {
namespace {

constexpr double pi = std::numbers::pi;

std::string refusal(const FrameDesign& design) {
  try {
    build_frame(design);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string refusal(const Points& nodes, const std::vector<Strut>& struts) {
  try {
    frame_from_struts(nodes, struts, 3, "graph.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

bool names(const std::string& message, const std::string& what) {
  return message.find(what) != std::string::npos;
}

TEST(Profile, AttainsItsPointsAndDoesNotOvershoot) {
  const Profile p({0, 6, 20, 26, 45}, {13, 12, 11, 11.3, 16}, "test");
  for (std::size_t i = 0; i < p.heights().size(); ++i)
    EXPECT_NEAR(p.radius(p.heights()[i]), p.radii()[i], 1e-12);
  for (double z = -5; z <= 50; z += 0.01) {
    EXPECT_GE(p.radius(z), 11.0 - 1e-12);
    EXPECT_LE(p.radius(z), 16.0 + 1e-12);
  }
}

TEST(Profile, SlopeIsTheDerivativeOfSecondOrder) {
  const Profile p({0, 6, 20, 26, 45}, {13, 12, 11, 11.3, 16}, "test");
  for (double z : {1.0, 5.0, 9.0, 23.0, 31.0}) {
    double error[2];
    for (int k = 0; k < 2; ++k) {
      const double h = 0.1 / (1 << k);
      error[k] = std::abs((p.radius(z + h) - p.radius(z - h)) / (2 * h) - p.slope(z));
    }
    EXPECT_NEAR(error[0] / error[1], 4, 0.01) << z;
  }
}

TEST(Cylinder, HasTheNodesAndStrutLengthsOfClosedForm) {
  Device device = cylinder(24);
  device.frame.beams_per_strut = 64;
  const Frame frame = build_frame(device.frame);
  const int rows = 5, cells = 12, struts = 2 * cells * (rows - 1);
  EXPECT_EQ(frame.crossings, rows * cells);
  EXPECT_EQ(frame.struts.size(), struts);
  EXPECT_EQ(frame.beams.size(), struts * 64u);
  EXPECT_EQ(frame.nodes.size(), rows * cells + struts * 63u);
  const double r = 12 - 0.35 / 2;
  for (const Vec3& x : frame.nodes) EXPECT_NEAR(std::hypot(x.x(), x.y()), r, 1e-12);
  // A helix over half a pitch; its polygon of 64 pieces is shorter by the square of their angle over 24.
  const double helix = std::hypot(r * pi / cells, 5.0);
  for (const auto& chain : frame.strut_nodes) {
    double length = 0;
    for (std::size_t i = 1; i < chain.size(); ++i)
      length += (frame.nodes[chain[i]] - frame.nodes[chain[i - 1]]).norm();
    EXPECT_NEAR(length, helix, 1e-5 * helix);
    EXPECT_LT(length, helix);
  }
  const FrameMeasures m = measure(frame);
  EXPECT_NEAR(m.inflow_diameter_mm, 24, 1e-12);
  EXPECT_NEAR(m.waist_diameter_mm, 24, 1e-12);
  EXPECT_NEAR(m.outflow_diameter_mm, 24, 1e-12);
  EXPECT_NEAR(m.height_mm, 20, 1e-12);
}

class Library : public testing::TestWithParam<double> {};

TEST_P(Library, MeasuresWhatTheDesignSays) {
  const Device device = supra_annular(GetParam());
  const FrameMeasures m = measure(build_frame(device.frame));
  EXPECT_NEAR(m.inflow_diameter_mm, GetParam(), 1e-9);
  EXPECT_NEAR(m.outflow_diameter_mm, device.frame.profile_mm.back()[1], 1e-9);
  EXPECT_NEAR(m.height_mm, device.frame.level_mm.back(), 1e-9);
  double waist = 1e30;  // attained between nodes; nodes stand at most 1 mm away from it
  for (const auto& [z, d] : device.frame.profile_mm) waist = std::min(waist, d);
  EXPECT_GE(m.waist_diameter_mm, waist - 1e-9);
  EXPECT_LE(m.waist_diameter_mm, waist + 0.05);
}

TEST_P(Library, IsOnePieceWithFourStrutsAtEveryInnerCrossing) {
  const Frame frame = build_frame(supra_annular(GetParam()).frame);
  const auto degree = degrees(frame);
  const int cells = 15, rows = frame.crossings / cells;
  for (int i = 0; i < static_cast<int>(degree.size()); ++i) {
    const bool edge_row = i < cells || (i >= (rows - 1) * cells && i < frame.crossings);
    EXPECT_EQ(degree[i], i >= frame.crossings || edge_row ? 2 : 4) << i;
  }
  std::vector<char> reached(frame.nodes.size(), 0);
  reached[0] = 1;
  for (bool grew = true; grew;) {
    grew = false;
    for (const auto& [a, b] : frame.beams)
      if (reached[a] != reached[b]) reached[a] = reached[b] = 1, grew = true;
  }
  for (char r : reached) EXPECT_TRUE(r);
  std::set<std::array<long, 3>> places;
  for (const Vec3& x : frame.nodes)
    EXPECT_TRUE(
        places.insert({std::lround(x.x() * 1e4), std::lround(x.y() * 1e4), std::lround(x.z() * 1e4)}).second);
}

TEST_P(Library, FitsTheCrimpedDiameter) {
  const Device device = supra_annular(GetParam());
  EXPECT_LT(closed_diameter_mm(device.frame.cells, device.frame.width_mm, device.frame.depth_mm), 5.75);
  EXPECT_LT(closed_diameter_mm(device.frame.cells, device.frame.depth_mm, device.frame.depth_mm), 5.75);
}

TEST_P(Library, LengthensWhenItClosesAsTissueCanFollow) {
  // A closed strut stands along the axis: the row's height becomes the strut's length.
  const Frame frame = build_frame(supra_annular(GetParam()).frame);
  double open = 0, closed = 0;
  for (std::size_t s = 0; s < frame.struts.size(); s += 30) {
    open += std::abs(frame.nodes[frame.struts[s].to].z() - frame.nodes[frame.struts[s].from].z());
    closed += (frame.nodes[frame.struts[s].to] - frame.nodes[frame.struts[s].from]).norm();
  }
  EXPECT_GT(closed / open, 1.05);
  EXPECT_LT(closed / open, 1.15);
}

INSTANTIATE_TEST_SUITE_P(Sizes, Library, testing::ValuesIn(library_sizes_mm));

TEST(BadFrame, NamesTheKeyAndWhatIsExpected) {
  const FrameDesign good = cylinder(24).frame;
  FrameDesign d = good;
  d.cells = 2;
  EXPECT_TRUE(names(refusal(d), "device.cells: 2"));
  d = good, d.level_mm = {0, 5, 5};
  EXPECT_TRUE(names(refusal(d), "height 5 mm follows 5 mm"));
  d = good, d.level_mm = {1, 5};
  EXPECT_TRUE(names(refusal(d), "expected 0, the inflow edge"));
  d = good, d.level_mm = {0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_TRUE(names(refusal(d), "device.level_heights_mm"));
  d = good, d.profile_mm = {{0, 24}, {10, std::numeric_limits<double>::quiet_NaN()}};
  EXPECT_TRUE(names(refusal(d), "height 10 mm"));
  d = good, d.width_mm = 3.2;
  EXPECT_TRUE(names(refusal(d), "do not fit a cell"));
  d = good, d.width_mm = 0;
  EXPECT_TRUE(names(refusal(d), "expected positive sections"));
  EXPECT_THROW(supra_annular(27), InputError);
}

TEST(BadGraph, NamesTheStrutOrNode) {
  const Points square{{5, 0, 0}, {0, 5, 5}, {-5, 0, 0}, {0, -5, 5}};
  const auto strut = [](int a, int b) { return Strut{a, b, 0.25, 0.45}; };
  EXPECT_EQ(refusal(square, {strut(0, 1), strut(1, 2), strut(2, 3), strut(3, 0)}), "accepted");

  EXPECT_TRUE(
      names(refusal(square, {strut(0, 1), strut(1, 2), strut(2, 2)}), "strut 2 from node 2 to node 2"));
  Points twice = square;
  twice[3] = twice[0];
  EXPECT_TRUE(
      names(refusal(twice, {strut(0, 1), strut(1, 2), strut(0, 3)}), "strut 2 from node 0 to node 3 has no"));
  Points nan = square;
  nan[2].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(names(refusal(nan, {strut(0, 1)}), "node 2 has a coordinate that is not finite"));
  EXPECT_TRUE(names(refusal(square, {strut(0, 1), strut(2, 3)}), "node 2 is not connected"));
  EXPECT_TRUE(names(refusal(square, {strut(0, 1), strut(1, 2)}), "no strut reaches node 3"));
  EXPECT_TRUE(names(refusal(square, {strut(0, 1), strut(1, 9)}), "strut 1 ends at node 9"));
  EXPECT_TRUE(
      names(refusal(square, {strut(0, 1), strut(1, 0)}), "strut 1 from node 1 to node 0 occurs twice"));
  EXPECT_TRUE(names(refusal(square, {{0, 1, 0.25, 9.0}}), "must be longer than thick"));
  EXPECT_TRUE(names(refusal(square, {{0, 1, -0.25, 0.45}}), "expected positive width and depth"));
}

}  // namespace
}  // namespace valsalva::stent
