// The rasteriser: known triangles cover known pixels, in the right order.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "render/rasteriser.hpp"

namespace valsalva::report {
namespace {

/// Looks along +y; one millimetre a pixel; x to the right, z up, the origin in the middle.
Camera plain_camera() {
  Camera camera;
  camera.mm_per_pixel = 1;
  camera.width = camera.height = 40;
  return camera;
}

Surface square(double half, double y, Colour colour) {
  Surface s;
  s.points = {{-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}};
  s.triangles = {{0, 1, 2}, {0, 2, 3}};
  s.colour = colour;
  s.lit = false;
  return s;
}

int covered(const Image& image) {
  int count = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) count += image.rgba[i] == 255;
  return count;
}

TEST(Rasteriser, SquareCoversExactlyItsPixels) {
  const Image image = render({square(10, 0, {1, 0, 0})}, plain_camera());
  EXPECT_EQ(covered(image), 400);
  EXPECT_EQ(image.pixel(20, 20)[0], 255);
  EXPECT_EQ(image.pixel(20, 20)[1], 0);
  EXPECT_EQ(image.pixel(9, 20)[3], 0);
  EXPECT_EQ(image.pixel(10, 10)[3], 255);
}

TEST(Rasteriser, TriangleCoversItsAreaAndPointsUp) {
  Surface s;
  s.points = {{-15, 0, -15}, {15, 0, -15}, {0, 0, 15}};
  s.triangles = {{0, 1, 2}};
  s.lit = false;
  const Image image = render({s}, plain_camera(), 4);
  double alpha = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) alpha += image.rgba[i] / 255.0;
  EXPECT_NEAR(alpha, 450, 3);
  EXPECT_EQ(image.pixel(20, 30)[3], 255);  // wide below
  EXPECT_EQ(image.pixel(8, 8)[3], 0);      // narrow above
}

TEST(Rasteriser, NearerSurfaceHidesFartherWhateverTheOrder) {
  const Surface front = square(5, -3, {0, 1, 0}), back = square(10, 4, {1, 0, 0});
  for (const auto& order : {std::vector<Surface>{front, back}, std::vector<Surface>{back, front}}) {
    const Image image = render(order, plain_camera());
    EXPECT_EQ(image.pixel(20, 20)[0], 0);
    EXPECT_EQ(image.pixel(20, 20)[1], 255);
    EXPECT_GT(image.pixel(12, 20)[0], 100);  // darkened by what lies in front of it, but red
    EXPECT_EQ(image.pixel(12, 20)[1], 0);
  }
}

TEST(Rasteriser, HalfTransparentSquareMixesWithWhatLiesBehind) {
  Surface veil = square(5, -3, {0, 0, 1});
  veil.opacity = 0.5;
  const Image image = render({square(10, 4, {1, 0, 0}), veil}, plain_camera());
  EXPECT_NEAR(image.pixel(20, 20)[0], 128, 4);
  EXPECT_NEAR(image.pixel(20, 20)[2], 128, 4);
  EXPECT_EQ(image.pixel(20, 20)[3], 255);
}

TEST(Rasteriser, TransparentTrianglesBlendFromFarToNear) {
  Surface near = square(5, -3, {0, 0, 1}), far = square(5, 3, {1, 0, 0});
  near.opacity = far.opacity = 0.5;
  const Image image = render({near, far}, plain_camera());
  EXPECT_NEAR(image.pixel(20, 20)[3], 0.75 * 255, 4);
  EXPECT_GT(image.pixel(20, 20)[2], image.pixel(20, 20)[0]);
}

TEST(Rasteriser, LightFromTheViewerShadesByTheNormal) {
  Surface facing = square(8, 0, {0.8f, 0.8f, 0.8f});
  facing.lit = true;
  Surface tilted = facing;
  for (Vec3& x : tilted.points) x = Vec3(x.x(), 3 * x.z(), x.z());  // faces down and towards the viewer
  const int a = render({facing}, plain_camera()).pixel(20, 20)[0];
  const int b = render({tilted}, plain_camera()).pixel(20, 20)[0];
  EXPECT_NE(a, b);
  EXPECT_GT(std::min(a, b), 40);  // never black
}

TEST(Camera, FramingFillsThePictureButForTheMargin) {
  Box box;
  box.add({{-3, -2, 0}, {5, 2, 4}});
  Camera camera;
  camera.width = 200;
  camera.height = 200;
  const Camera fitted = camera.framing(box, 0.1);
  EXPECT_NEAR(fitted.mm_per_pixel, 8.0 / 200 / 0.8, 1e-12);
  EXPECT_NEAR((fitted.target - Vec3(1, 0, 2)).norm(), 0, 1e-12);
}

TEST(Shapes, TubeHasTheRadiusAndFacesOutwards) {
  const Surface tube = tubes({{0, 0, 0}, {0, 0, 10}}, {{0, 1}}, {2.0}, 12);
  for (const Vec3& x : tube.points) EXPECT_NEAR(std::hypot(x.x(), x.y()), 2, 1e-12);
  for (const Triangle& t : tube.triangles) {
    const Vec3 n = (tube.points[t[1]] - tube.points[t[0]]).cross(tube.points[t[2]] - tube.points[t[0]]);
    const Vec3 middle = (tube.points[t[0]] + tube.points[t[1]] + tube.points[t[2]]) / 3;
    EXPECT_GT(n.dot(Vec3(middle.x(), middle.y(), 0)), 0);
  }
}

TEST(Shapes, BoundaryOfOneTetrahedronIsItsFourFacesOutwards) {
  const Points points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Surface all = boundary(points, {{0, 1, 2, 3}}, [](const Vec3&) { return true; });
  ASSERT_EQ(all.triangles.size(), 4u);
  for (const Triangle& t : all.triangles) {
    const Vec3 n = (all.points[t[1]] - all.points[t[0]]).cross(all.points[t[2]] - all.points[t[0]]);
    EXPECT_GT(n.dot(all.points[t[0]] - Vec3(0.25, 0.25, 0.25)), 0);
  }
  EXPECT_TRUE(boundary(points, {{0, 1, 2, 3}}, [](const Vec3& x) { return x.x() > 1; }).triangles.empty());
}

TEST(Shapes, CrossSectionOfATriangleIsASegmentOnThePlane) {
  const auto cut = cross_section({{0, -1, 0}, {0, 1, 0}, {2, 1, 0}}, {{0, 1, 2}}, {0, 0, 0}, {0, 1, 0});
  ASSERT_EQ(cut.size(), 1u);
  EXPECT_NEAR((cut[0][0] - cut[0][1]).norm(), 1, 1e-12);
  EXPECT_NEAR(cut[0][0].y(), 0, 1e-12);
}

TEST(Shapes, SimplifiedKeepsTheShapeWithinTheLimit) {
  Surface s;
  for (int j = 0; j <= 100; ++j)
    for (int i = 0; i <= 100; ++i) s.points.push_back(Vec3(i, 0, j));
  for (int j = 0; j < 100; ++j)
    for (int i = 0; i < 100; ++i) {
      const int a = j * 101 + i;
      s.triangles.push_back({a, a + 1, a + 102});
      s.triangles.push_back({a, a + 102, a + 101});
    }
  const Surface less = simplified(s, 4000);
  EXPECT_LE(less.triangles.size(), 4000u);
  EXPECT_GT(less.triangles.size(), 400u);
  Box box;
  box.add(less.points);
  EXPECT_LT(box.low.norm(), 5);
  EXPECT_LT((box.high - Vec3(100, 0, 100)).norm(), 5);
}

TEST(Png, BytesBeginWithTheSignatureAndHoldTheSize) {
  const std::string bytes = png(render({square(10, 0, {1, 0, 0})}, plain_camera()));
  EXPECT_EQ(bytes.substr(1, 3), "PNG");
  EXPECT_EQ(bytes[19], 40);
  EXPECT_EQ(bytes[23], 40);
}

TEST(ColourMap, BecomesLighterAllTheWay) {
  const auto lightness = [](double t) {
    const Colour c = heat(t);
    return 0.21 * c[0] + 0.72 * c[1] + 0.07 * c[2];
  };
  for (int i = 1; i <= 50; ++i) EXPECT_GT(lightness(i / 50.0), lightness((i - 1) / 50.0)) << i;
  EXPECT_EQ(heat(-1), heat(0));
  EXPECT_EQ(heat(2), heat(1));
}

}  // namespace
}  // namespace valsalva::report
