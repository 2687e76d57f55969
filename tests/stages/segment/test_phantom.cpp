// The segmentation of the synthetic CT against the numbers that made it. The segmentation reads the image
// only.
#include "anatomy.hpp"
#include "annulus_plane.hpp"
#include "geometry/level_set.hpp"
#include "geometry/surface.hpp"
#include "phantom/from_case.hpp"
#include "root.hpp"
#include "support.hpp"

namespace {

using namespace valsalva;
using test::expect_input_error;

const std::string plane =
    "[anatomy]\nkind = \"phantom\"\nannulus_centre_mm = [6, -12, 20]\nannulus_normal = [-0.35, -0.25, 0.9]\n";

/// One coarse phantom for all tests of this file.
class Phantom : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::Folder;
    phantom_ = new segment::Phantom(segment::phantom_of(test::case_of("[phantom]\nspacing_mm = 1.0\n")));
    segment::write_image(file(), phantom_->image);
  }
  static void TearDownTestSuite() {
    delete phantom_;
    delete folder_;
  }
  static std::filesystem::path file() { return *folder_ / "phantom.nrrd"; }
  static segment::Anatomy anatomy(const std::string& text) {
    const Case scene = test::case_of(text);
    segment::check_anatomy(scene);
    return segment::anatomy_of(scene, file());
  }
  static test::Folder* folder_;
  static segment::Phantom* phantom_;
};
test::Folder* Phantom::folder_ = nullptr;
segment::Phantom* Phantom::phantom_ = nullptr;

TEST_F(Phantom, RootIsMeasuredToHalfAVoxel) {
  const segment::Anatomy found = anatomy(plane + "level_set_mm = 0.7\n");
  const auto& lumen = found.lumen;
  const segment::Root root = segment::measure_root(lumen.distance, lumen.z_lower_mm, lumen.z_upper_mm, 5);
  EXPECT_NEAR(root.annulus.area_diameter_mm(), 22.5, 0.5);
  EXPECT_NEAR(root.annulus.least_mm, 22.5 * (1 - 0.15 / 1.85), 0.6);
  EXPECT_NEAR(root.annulus.greatest_mm, 22.5 * (1 + 0.15 / 1.85), 0.6);
  EXPECT_NEAR(root.lvot.area_diameter_mm(), 23, 0.6);
  EXPECT_NEAR(root.junction.area_diameter_mm(), 26.5, 0.6);
  EXPECT_NEAR(root.z_junction_mm, 20, 2.5);
  const double expected[3] = {20, 140, 260};
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(root.commissure_angles[c] * 180 / 3.14159265358979, expected[c], 6) << c;
  EXPECT_LT((lumen.frame.origin - Vec3(6, -12, 20)).norm(), 0.5);
  EXPECT_LT(std::abs(lumen.smoothing_volume_change_pct), 0.1);
  EXPECT_EQ(segment::recommended_device(root.annulus.perimeter_mm).nominal_mm, 26);
  ASSERT_TRUE(lumen.calcium);
  const double ratio = geometry::volume_inside(*lumen.calcium) / phantom_->calcium_mm3;
  EXPECT_GT(ratio, 0.5);  // small nodules are blurred below the threshold
  EXPECT_LT(ratio, 1.3);

  // The field is open-ended: the lumen goes through both faces of the grid, and its layers beyond a cut are
  // alike.
  const auto& grid = lumen.distance;
  const auto layer_area = [&](double z) {
    const auto section = geometry::Plane::at(Vec3(0, 0, z), Vec3::UnitZ());
    return geometry::area(geometry::loop_at_origin(geometry::section(grid, section, 30, 0.5)));
  };
  const double top = grid.origin.z() + (grid.dimensions[2] - 1) * grid.spacing;
  EXPECT_NEAR(layer_area(grid.origin.z()), layer_area(lumen.z_lower_mm), 4);
  EXPECT_NEAR(layer_area(top), layer_area(lumen.z_upper_mm), 4);
}

TEST_F(Phantom, SeedsAloneFindTheAnnulusPlane) {
  const segment::Frame frame = segment::Frame::at(Vec3(6, -12, 20), Vec3(-0.35, -0.25, 0.9));
  const Vec3 up = frame.to_scanner({0, 0, -6}), down = frame.to_scanner({0, 0, 26});
  const segment::Image image = segment::read_image(file());
  const segment::Frame found = segment::annulus_from_seeds(image, {up, down}, {});
  EXPECT_LT(std::abs(frame.from_scanner(found.origin).z()), 4);
  EXPECT_GT(found.axes.col(2).dot(frame.axes.col(2)), 0.98);
}

TEST_F(Phantom, WrongInputIsRefusedWithWhatToMove) {
  const std::string kind = "[anatomy]\nkind = \"ct\"\nimage = \"x.nrrd\"\nlevel_set_mm = 1\n";
  const std::string normal = "annulus_normal = [-0.35, -0.25, 0.9]\n";
  expect_input_error([&] { anatomy(kind + "annulus_centre_mm = [500, 0, 0]\n" + normal); },
                     {"anatomy.annulus_centre_mm", "outside the image"});
  expect_input_error([&] { anatomy(kind + "annulus_centre_mm = [45, 20, 0]\n" + normal); },
                     {"empty", "anatomy.seeds_mm", "HU"});
  expect_input_error(
      [&] { anatomy(kind + "annulus_centre_mm = [6, -12, 20]\nseeds_mm = [900, 0, 0]\n" + normal); },
      {"anatomy.seeds_mm", "outside the image"});
  expect_input_error([&] { anatomy(plane + "level_set_mm = 1\nlumen_threshold_HU = 900\n"); },
                     {"empty", "900"});
  expect_input_error([&] { anatomy(plane + "level_set_mm = 1\nlumen_threshold_HU = -500\n"); },
                     {"leaks", "lumen_threshold_HU"});
}

TEST(AnatomyTable, IncompleteTablesAreRefused) {
  const auto check = [](const std::string& text) {
    segment::check_anatomy(test::case_of("[anatomy]\n" + text));
  };
  expect_input_error([&] { check("annulus_centre_mm = [1, 2]\n"); }, {"annulus_centre_mm", "expected three"});
  expect_input_error([&] { check("annulus_centre_mm = [1, 2, 3]\n"); },
                     {"anatomy.annulus_normal", "missing"});
  expect_input_error([&] { check("annulus_centre_mm = [1, 2, 3]\nannulus_normal = [0, 0, 0]\n"); }, {"zero"});
  expect_input_error([&] { check("image = \"a.nrrd\"\n"); }, {"anatomy.seeds_mm"});
  expect_input_error([&] { check("seeds_mm = [1, 2]\n"); }, {"anatomy.seeds_mm", "three a seed"});
  expect_input_error([&] { check("kind = \"labels\"\nimage = \"a.nrrd\"\n"); }, {"anatomy.labels"});
  expect_input_error([&] { check("kind = \"surface\"\nimage = \"a.stl\"\n"); }, {"annulus plane"});
  expect_input_error([&] { check("annulus_centre_mm = [1, 2, 3]\nannulus_normal = [0, 0, 1]\n"); },
                     {"anatomy.image", "missing"});
}

TEST(LabelMap, EmptyMaskAndPartedLabelsAreRefused) {
  segment::Image image;
  image.size = {40, 40, 40};
  image.values.assign(64000, 0.0f);
  segment::LumenOptions options;
  options.spacing_mm = 1;
  expect_input_error(
      [&] {
        segment::lumen_of_labels(image, segment::Frame::at(Vec3(20, 20, 20), Vec3::UnitZ()), {3, 6}, options);
      },
      {"empty", "anatomy.labels"});
  expect_input_error([&] { segment::interface_of(image, 3, 6); }, {"touch in 0 voxel faces"});
}

TEST(LabelMap, PlaneLiesWhereTheLabelsTouch) {
  segment::Image image;
  image.size = {40, 40, 40};
  for (int n = 0; n < 64000; ++n) {
    const int i = n % 40, j = n / 40 % 40, k = n / 1600;
    image.values.push_back(std::hypot(i - 20, j - 20) > 10 ? 0.0f : k < 18 ? 3.0f : 6.0f);
  }
  const segment::Frame frame = segment::interface_of(image, 3, 6);
  EXPECT_LT((frame.origin - Vec3(20, 20, 17.5)).norm(), 0.01);
  EXPECT_GT(frame.axes.col(2).z(), 0.999);
}

TEST(DeviceSize, FollowsThePerimeterRanges) {
  EXPECT_EQ(segment::recommended_device(60).nominal_mm, 23);
  EXPECT_EQ(segment::recommended_device(62.8).nominal_mm, 26);
  EXPECT_EQ(segment::recommended_device(80).nominal_mm, 29);
  EXPECT_EQ(segment::recommended_device(90).nominal_mm, 34);
  EXPECT_FALSE(segment::recommended_device(50).in_range);
  EXPECT_EQ(segment::recommended_device(100).nominal_mm, 34);
  EXPECT_FALSE(segment::recommended_device(100).in_range);
}

}  // namespace
