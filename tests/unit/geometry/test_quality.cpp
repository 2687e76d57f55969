#include "geometry/quality.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace valsalva::geometry {
namespace {

const Vec3 a(1, 1, 1), b(-1, 1, -1), c(1, -1, -1), d(-1, -1, 1);  // regular, edge 2 sqrt 2

TEST(Quality, RegularTetrahedronIsOne) {
  EXPECT_NEAR(std::abs(tetrahedron_volume(a, b, c, d)), 8.0 / 3, 1e-14);
  EXPECT_NEAR(tetrahedron_aspect(a, b, c, d), 1, 1e-14);
  EXPECT_NEAR(tetrahedron_min_dihedral_deg(a, b, c, d), 70.528779365509308, 1e-12);
  EXPECT_NEAR(std::abs(tetrahedron_scaled_jacobian(a, b, c, d)), 1, 1e-14);
}

TEST(Quality, TurnedTetrahedronIsNegative) {
  EXPECT_NEAR(tetrahedron_scaled_jacobian(a, b, c, d), -tetrahedron_scaled_jacobian(a, c, b, d), 1e-14);
}

TEST(Quality, CornerOfACube) {
  const Vec3 o(0, 0, 0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  EXPECT_NEAR(tetrahedron_volume(o, x, y, z), 1.0 / 6, 1e-15);
  EXPECT_NEAR(tetrahedron_min_dihedral_deg(o, x, y, z), 54.735610317245346, 1e-12);  // atan sqrt 2
  EXPECT_NEAR(tetrahedron_scaled_jacobian(o, x, y, z), std::sqrt(0.5), 1e-14);
  // L = sqrt 2, inradius = 1 / (3 + sqrt 3)
  EXPECT_NEAR(tetrahedron_aspect(o, x, y, z), std::sqrt(2.0) * (3 + std::sqrt(3.0)) / (2 * std::sqrt(6.0)),
              1e-14);
}

TEST(Quality, Triangles) {
  const Vec3 o(0, 0, 0), x(1, 0, 0), top(0.5, std::sqrt(0.75), 0), y(0, 1, 0);
  EXPECT_NEAR(triangle_aspect(o, x, top), 1, 1e-14);
  EXPECT_NEAR(triangle_min_angle_deg(o, x, top), 60, 1e-12);
  EXPECT_NEAR(triangle_min_angle_deg(o, x, y), 45, 1e-12);
  EXPECT_TRUE(std::isinf(triangle_aspect(o, x, Vec3(2, 0, 0))));
}

TEST(Quality, WorstOfAMesh) {
  const TetMesh mesh{{a, b, c, d, Vec3(-3, -3, 3)}, {{0, 1, 2, 3}, {0, 2, 1, 4}}};
  const TetQuality quality = quality_of(mesh);
  EXPECT_EQ(quality.worst, 1);
  EXPECT_LT(quality.min_scaled_jacobian, 0);
}

}  // namespace
}  // namespace valsalva::geometry
