// A DICOM folder as scanners and archives leave it: slices in any order of names, other series and files
// beside them.
#include <Eigen/Geometry>
#include <fstream>

#include "anatomy.hpp"
#include "dicom_series.hpp"
#include "phantom/phantom.hpp"
#include "root.hpp"
#include "support.hpp"

namespace {

using namespace valsalva;
using segment::Image;
using test::expect_input_error;
using test::slice_file;
using test::write_dicom;

/// The phantom on an oblique grid of three different spacings.
Image oblique_phantom() {
  segment::PhantomScan scan;
  scan.spacing_mm = 2;
  const Image upright = segment::make_phantom({}, scan).image;
  Image image;
  image.size = {40, 36, 30};
  image.spacing = {1.1, 1.3, 2.5};
  image.direction = (Eigen::AngleAxisd(0.3, Vec3(1, 2, -1).normalized())).toRotationMatrix();
  image.origin = scan.annulus_centre - image.direction * image.spacing.cwiseProduct(Vec3(20, 18, 15));
  for (int k = 0; k < image.size[2]; ++k)
    for (int j = 0; j < image.size[1]; ++j)
      for (int i = 0; i < image.size[0]; ++i)
        image.values.push_back(float(2 * std::lround(upright.sample(image.position(Vec3(i, j, k))) / 2)));
  return image;
}

void expect_same(const Image& found, const Image& expected) {
  ASSERT_EQ(found.size, expected.size);
  EXPECT_LT((found.spacing - expected.spacing).norm(), 1e-4);
  EXPECT_LT((found.direction - expected.direction).norm(), 1e-4);
  EXPECT_LT((found.origin - expected.origin).norm(), 1e-3);
  EXPECT_EQ(found.values, expected.values);
}

TEST(Dicom, TheLargestSeriesIsReadWithItsGeometryAndValues) {
  const test::Folder folder;
  const Image image = oblique_phantom();
  EXPECT_GT(*std::max_element(image.values.begin(), image.values.end()), 300);
  EXPECT_LT(*std::min_element(image.values.begin(), image.values.end()), -50);
  write_dicom(folder / "ct", image, {.slope = 2, .intercept = -1024});
  std::ifstream stored(slice_file(folder / "ct", test::Series{}, 0), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stored), {}};
  EXPECT_NE(bytes.find("-1024"), std::string::npos) << "the files hold values before the rescaling";
  Image scout = image;
  scout.size[2] = 5;
  scout.values.assign(std::size_t(40) * 36 * 5, 7);
  write_dicom(folder / "ct", scout, {.uid = "1.2.826.0.1.3680043.2.1125.2"});
  std::ofstream(folder / "ct" / "README.txt") << "exported by an archive\n";
  expect_same(segment::read_image(folder / "ct"), image);
}

TEST(Dicom, AMissingSliceIsNamed) {
  const test::Folder folder;
  const test::Series series;
  write_dicom(folder / "ct", oblique_phantom(), series);
  std::filesystem::remove(slice_file(folder / "ct", series, 11));
  expect_input_error([&] { segment::read_image(folder / "ct"); },
                     {"5.000 mm", "2.500 mm", "a slice is missing", slice_file("", series, 10).string(),
                      slice_file("", series, 12).string()});
}

TEST(Dicom, SlicesOfSeveralSizesAreRefused) {
  const test::Folder folder;
  const test::Series series;
  Image image = oblique_phantom();
  write_dicom(folder / "ct", image, series);
  write_dicom(folder / "other", cropped(image, image.position(Vec3(15, 15, 15)), 12), series);
  std::filesystem::copy_file(slice_file(folder / "other", series, 2), folder / "ct" / "odd.dcm");
  expect_input_error([&] { segment::read_image(folder / "ct"); }, {"40 x 36", "pixels", "one size"});
}

TEST(Dicom, SeveralPhasesInOneSeriesAreRefused) {
  const test::Folder folder;
  const test::Series series;
  write_dicom(folder / "ct", oblique_phantom(), series);
  std::filesystem::copy_file(slice_file(folder / "ct", series, 4), folder / "ct" / "again.dcm");
  expect_input_error([&] { segment::read_image(folder / "ct"); }, {"in one place", "phases"});
}

TEST(Dicom, AFolderWithoutASeriesIsRefused) {
  const test::Folder folder;
  std::filesystem::create_directory(folder / "empty");
  expect_input_error([&] { segment::read_image(folder / "empty"); }, {"empty", "no DICOM series"});
  Image image = oblique_phantom();
  image.size[2] = 1;
  image.values.resize(40 * 36);
  write_dicom(folder / "single", image, {});
  expect_input_error([&] { segment::read_image(folder / "single"); }, {"two or more slices", "(1 slices)"});
}

TEST(Dicom, TheRealCtMeasuresTheSameAsFromItsNiftiFile) {
  const std::filesystem::path file =
      std::filesystem::path(VALSALVA_SOURCE_DIR) / ".." / "shared/reference/ct_thorax/ct_cropped.nii.gz";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the reference data is absent: " << file;
  const Vec3 centre(14.0, -184.1, 660.8);
  const test::Folder folder;
  const Image image = cropped(segment::read_image(file), centre, 75);
  segment::write_image(folder / "ct.nii", image);
  write_dicom(folder / "ct", image, {});
  const Case scene = test::case_of(
      "[anatomy]\nkind = \"ct\"\nimage = \"x\"\ncoordinates = \"RAS\"\nupper_cut_mm = 30\n"
      "level_set_mm = 1.2\n"
      "annulus_centre_mm = [-14.0, 184.1, 660.8]\nannulus_normal = [0.53, 0.26, 0.81]\n");
  const auto measured = [&](const char* name) {
    const segment::Lumen lumen = segment::anatomy_of(scene, folder / name).lumen;
    return segment::measure_root(lumen.distance, lumen.z_lower_mm, lumen.z_upper_mm, 5);
  };
  const segment::Root nifti = measured("ct.nii"), dicom = measured("ct");
  EXPECT_GT(nifti.annulus.greatest_mm, 20);
  EXPECT_NEAR(dicom.annulus.greatest_mm, nifti.annulus.greatest_mm, 0.01);
  EXPECT_NEAR(dicom.annulus.least_mm, nifti.annulus.least_mm, 0.01);
  EXPECT_NEAR(dicom.annulus.perimeter_mm, nifti.annulus.perimeter_mm, 0.01);
  EXPECT_NEAR(dicom.sinus.greatest_mm, nifti.sinus.greatest_mm, 0.01);
  EXPECT_NEAR(dicom.junction.perimeter_mm, nifti.junction.perimeter_mm, 0.01);
}

}  // namespace
