// Image and surface files: what is read back, and what is refused.
#include <fstream>

#include "image.hpp"
#include "support.hpp"
#include "surface_file.hpp"

namespace {

using namespace valsalva;
using segment::Image;
using test::expect_input_error;

Image sample_image() {
  Image image;
  image.size = {5, 4, 3};
  image.spacing = {0.5, 0.7, 1.25};
  image.origin = {10, -20, 30};
  image.direction << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  for (int n = 0; n < 60; ++n) image.values.push_back(float(10 * n - 100));
  return image;
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(ImageFile, EveryFormatKeepsSpacingOriginDirectionAndValues) {
  const test::Folder folder;
  const Image image = sample_image();
  for (const char* name : {"a.nrrd", "a.nii", "a.nii.gz", "a.mha", "a.mhd"}) {
    segment::write_image(folder / name, image);
    const Image back = segment::read_image(folder / name);
    EXPECT_EQ(back.size, image.size) << name;
    EXPECT_EQ(back.values, image.values) << name;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 index(corner & 1 ? 4 : 0, corner & 2 ? 3 : 0, corner & 4 ? 2 : 0);
      EXPECT_LT((back.position(index) - image.position(index)).norm(), 1e-4) << name;
    }
  }
}

TEST(ImageFile, SamplesAreTrilinearInPatientCoordinates) {
  const Image image = sample_image();
  const Vec3 index(1.5, 2.25, 0.5);
  EXPECT_LT((image.index(image.position(index)) - index).norm(), 1e-12);
  EXPECT_NEAR(image.sample(image.position(index)), 10 * (1.5 + 5 * 2.25 + 20 * 0.5) - 100, 1e-9);
  EXPECT_FALSE(image.contains(Vec3(100, 0, 0)));
}

TEST(ImageFile, BadFilesAreRefusedWithTheReason) {
  const test::Folder folder;
  expect_input_error([&] { segment::read_image(folder / "none.nrrd"); }, {"none.nrrd", "no such image"});
  write_text(folder / "a.png", "x");
  expect_input_error([&] { segment::read_image(folder / "a.png"); }, {"a.png", "expected .nrrd"});
  std::filesystem::create_directory(folder / "empty");
  expect_input_error([&] { segment::read_image(folder / "empty"); }, {"no DICOM series"});
  for (const char* name : {"a.nrrd", "a.nii.gz", "a.mha"}) {
    segment::write_image(folder / name, sample_image());
    const std::string whole = read_text(folder / name);
    write_text(folder / name, whole.substr(0, whole.size() - 40));
    expect_input_error([&] { segment::read_image(folder / name); }, {name});
  }
}

std::string nrrd(const std::string& spacing, const std::string& first) {
  return "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nspacings: " + spacing + "\nencoding: ascii\n\n" +
         first + " 1 2 3 4 5 6 7\n";
}

TEST(ImageFile, ZeroSpacingAndNanAreRefused) {
  const test::Folder folder;
  write_text(folder / "good.nrrd", nrrd("1 1 1", "0"));
  EXPECT_EQ(segment::read_image(folder / "good.nrrd").values[7], 7);
  write_text(folder / "spacing.nrrd", nrrd("1 0 1", "0"));
  expect_input_error([&] { segment::read_image(folder / "spacing.nrrd"); }, {"spacing.nrrd"});
  write_text(folder / "nan.nrrd", nrrd("1 1 1", "nan"));
  expect_input_error([&] { segment::read_image(folder / "nan.nrrd"); }, {"voxel (0, 0, 0)", "finite"});
}

const char* const tetrahedron_off =
    "OFF\n4 4 0\n0 0 0\n20 0 0\n0 20 0\n0 0 20\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

TEST(SurfaceFile, ReadsSeveralFormats) {
  const test::Folder folder;
  write_text(folder / "a.off", tetrahedron_off);
  write_text(folder / "a.obj", "v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  write_text(
      folder / "a.vtp",
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\">\n<PolyData>\n"
      "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"4\">\n<Points>\n"
      "<DataArray type=\"Float32\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n"
      "0 0 0 20 0 0 0 20 0 0 0 20\n</DataArray>\n</Points>\n<Polys>\n"
      "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 2 1 0 1 3 0 3 2 1 2 3</DataArray>\n"
      "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray>\n</Polys>\n"
      "</Piece>\n</PolyData>\n</VTKFile>\n");
  for (const char* name : {"a.off", "a.obj", "a.vtp"}) {
    const geometry::TriMesh mesh = segment::read_surface(folder / name);
    EXPECT_EQ(mesh.points.size(), 4u) << name;
    EXPECT_EQ(mesh.triangles.size(), 4u) << name;
    EXPECT_EQ(mesh.points[1], Vec3(20, 0, 0)) << name;
  }
}

TEST(SurfaceFile, BadSurfacesAreRefusedWithTheReason) {
  const test::Folder folder;
  expect_input_error([&] { segment::read_surface(folder / "none.stl"); }, {"no such surface"});
  write_text(folder / "a.xyz", "0 0 0\n");
  expect_input_error([&] { segment::read_surface(folder / "a.xyz"); }, {"expected .stl"});
  write_text(folder / "cut.off", std::string(tetrahedron_off).substr(0, 40));
  expect_input_error([&] { segment::read_surface(folder / "cut.off"); }, {"cut.off"});
  write_text(folder / "cut.vtp", "<VTKFile type=\"PolyData\"><PolyData>");
  expect_input_error([&] { segment::read_surface(folder / "cut.vtp"); }, {"cut short"});
  write_text(folder / "metres.off", "OFF\n3 1 0\n0 0 0\n0.02 0 0\n0 0.02 0\n3 0 1 2\n");
  expect_input_error([&] { segment::read_surface(folder / "metres.off"); }, {"millimetres"});
}

}  // namespace
