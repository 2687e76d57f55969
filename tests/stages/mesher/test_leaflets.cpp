#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "geometry/quality.hpp"
#include "geometry/surface.hpp"
#include "geometry/surface_intersections.hpp"
#include "native_leaflets.hpp"
#include "synthetic_root.hpp"

namespace valsalva::mesher {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double edge_mm = 0.8;

struct Fitted {
  test::SyntheticRoot anatomy;
  geometry::GridSdf lumen = anatomy.level_set();
  LeafletProportions proportions;
  NativeValve valve;

  Fitted() {
    proportions.annulus_diameter_mm = 2 * anatomy.annulus_radius_mm;
    proportions.junction_z_mm = anatomy.junction_z_mm;
    const Root root(lumen, 0, commissure_height(proportions));
    valve = fit_native_valve(root, proportions, {}, anatomy.commissures, edge_mm, 26.21, lumen);
  }
};

const Fitted& fitted() {
  static const Fitted instance;
  return instance;
}

TEST(NativeLeaflets, PublishedFiguresBelongToOneClosedShape) {
  // Straight tube of the annulus's diameter: the sizes that follow from 1.24 d must be the published ones.
  const double d = 24;
  const auto lumen = geometry::sample(Vec3(-15, -15, -5), Vec3(15, 15, 30), 0.5,
                                      [&](const Vec3& x) { return x.head<2>().norm() - d / 2; });
  LeafletProportions p;
  p.annulus_diameter_mm = d;
  p.junction_z_mm = 30;
  p.free_edge_peak_factor = 0;
  const LeafletShape shape(Root(lumen, 0, commissure_height(p)), p, 0, 2 * pi / 3);
  EXPECT_NEAR(shape.sizes().free_edge_mm / d, 1.24, 1e-9);
  EXPECT_NEAR(shape.sizes().commissure_z_mm / d, 0.71, 1e-9);
  EXPECT_NEAR(shape.sizes().length_mm / d, 0.70, 0.04);  // Swanson and Clark 1974
}

TEST(NativeLeaflets, StressFreeEdgesAreShorterThanClosedOnesUnderPressure) {
  auto p = fitted().proportions;
  const Root root(fitted().lumen, 0, commissure_height(p));
  const LeafletShape as_published(root, p, 0, 2 * pi / 3);
  p.closed_stretch = 1.05;
  const LeafletShape stretched(root, p, 0, 2 * pi / 3);
  EXPECT_NEAR(as_published.sizes().free_edge_mm / stretched.sizes().free_edge_mm, 1.05, 1e-12);
  // The closed shape, and with it the length of the leaflet, is the same.
  EXPECT_EQ(as_published.sizes().length_mm, stretched.sizes().length_mm);
  double length = 0;
  for (int i = 1; i <= 2000; ++i)
    length += (stretched.free_edge(-1 + i / 1000.0) - stretched.free_edge(-1 + (i - 1) / 1000.0)).norm();
  EXPECT_NEAR(length / stretched.sizes().free_edge_mm, 1, 0.01);
}

TEST(NativeLeaflets, CrownFollowsTheMeasuredLine) {
  // Points of the line of Khelil et al. 2015: fraction of the way from commissure to commissure, height.
  const double line[][2] = {
      {0.0100636, 0.684871}, {0.0349575, 0.522829}, {0.0741525, 0.391226}, {0.113877, 0.298120},
      {0.154661, 0.217547},  {0.224047, 0.126231},  {0.310381, 0.0564013}, {0.5, 0}};
  for (const auto& [s, h] : line) EXPECT_NEAR(crown_height(1 - 2 * s), h, 0.02) << "at " << s;
  EXPECT_EQ(crown_height(1), 1);
}

TEST(NativeLeaflets, FreeEdgesAndLengthsAreAsSized) {
  const auto& v = fitted().valve;
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(v.free_edge_mm[k] / v.sizes[k].free_edge_mm, 1, 0.03);
    EXPECT_GE(v.free_edge_mm[k], 2 * pi / 3 * fitted().anatomy.annulus_radius_mm);
    EXPECT_NEAR(v.length_mm[k] / v.sizes[k].length_mm, 1, 0.03);
  }
}

TEST(NativeLeaflets, HalfOpen) {
  for (double r : fitted().valve.mid_radius_mm) {
    EXPECT_GT(r, 0.15 * fitted().anatomy.annulus_radius_mm);
    EXPECT_LT(r, 0.75 * fitted().anatomy.annulus_radius_mm);
  }
}

TEST(NativeLeaflets, AttachedOnTheWallAndClearOfItElsewhere) {
  const auto& f = fitted();
  EXPECT_LT(f.valve.attachment_error_mm, 1e-3);
  EXPECT_GT(f.valve.least_clearance_mm, 0);
  double lowest = 1e9, highest = -1e9;
  for (std::size_t i = 0; i < f.valve.mesh.points.size(); ++i) {
    if (!f.valve.attached[i]) continue;
    lowest = std::min(lowest, f.valve.mesh.points[i].z());
    highest = std::max(highest, f.valve.mesh.points[i].z());
  }
  EXPECT_NEAR(lowest, 0, 0.2);
  EXPECT_NEAR(highest, 0.71 * 24, 0.3);
}

TEST(NativeLeaflets, DoNotCrossAndKeepToTheirSectors) {
  const auto& f = fitted();
  EXPECT_TRUE(geometry::self_intersections(f.valve.mesh).empty());
  for (std::size_t i = 0; i < f.valve.mesh.triangles.size(); ++i)
    for (int node : f.valve.mesh.triangles[i]) {
      const Vec3& p = f.valve.mesh.points[node];
      double turn = std::atan2(p.y(), p.x()) - f.anatomy.commissures[f.valve.leaflet[i]];
      turn -= 2 * pi * std::floor(turn / (2 * pi));
      EXPECT_LT(turn, 2 * pi / 3);
    }
}

TEST(NativeLeaflets, EvenTrianglesFacingTheAorta) {
  const auto& f = fitted();
  const auto lengths = geometry::edge_lengths(f.valve.mesh);
  EXPECT_LE(lengths.mean, 1.02 * edge_mm);
  EXPECT_LT(lengths.longest, 1.7 * edge_mm);
  EXPECT_GT(geometry::quality_of(f.valve.mesh).min_angle_deg, 15);
  Vec3 up = Vec3::Zero();
  for (const Vec3& n : geometry::vertex_normals(f.valve.mesh)) up += n;
  EXPECT_GT(up.z(), 0);
}

TEST(NativeLeaflets, NearlyDevelopable) {
  // A cup that is closed from the start has about 2 pi.
  for (double curvature : fitted().valve.gauss_curvature_sr) EXPECT_LT(curvature, 0.3 * 2 * pi);
}

TEST(NativeLeaflets, ThicknessIsBellyNoduleAndRim) {
  const auto& f = fitted();
  double thickest_free = 0, thinnest = 1e9;
  for (std::size_t i = 0; i < f.valve.mesh.points.size(); ++i) {
    thinnest = std::min(thinnest, f.valve.thickness_mm[i]);
    if (f.valve.attached[i])
      EXPECT_NEAR(f.valve.thickness_mm[i], 0.6, 1e-3);
    else
      thickest_free = std::max(thickest_free, f.valve.thickness_mm[i]);
  }
  EXPECT_NEAR(thinnest, 0.4, 1e-3);
  EXPECT_NEAR(thickest_free, 0.92, 0.05);
}

TEST(NativeLeaflets, FibresAreUnitTangentAndCrossAtTwiceTheAngle) {
  const auto& f = fitted();
  EXPECT_LT(fibre_unit_error(f.valve.mesh, f.valve.fibres), 1e-12);
  for (std::size_t i = 0; i < f.valve.mesh.triangles.size(); ++i)
    EXPECT_NEAR(f.valve.fibres.first[i].dot(f.valve.fibres.second[i]), std::cos(2 * 26.21 * pi / 180), 1e-12);
}

TEST(NativeLeaflets, MeanFibreRunsFromCommissureToCommissure) {
  // On a flat strip the potential is linear and the mean direction exactly along it.
  geometry::TriMesh strip;
  std::vector<double> known;
  for (int j = 0; j <= 4; ++j)
    for (int i = 0; i <= 10; ++i) {
      strip.points.push_back({double(i), 0.7 * j, 0.3});
      known.push_back(i == 0 ? 0 : i == 10 ? 1 : -1);
    }
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 10; ++i) {
      const int a = 11 * j + i;
      strip.triangles.push_back({a, a + 1, a + 12});
      strip.triangles.push_back({a, a + 12, a + 11});
    }
  const auto fibres = fibre_families(strip, harmonic(strip, known), 30);
  for (std::size_t i = 0; i < strip.triangles.size(); ++i) {
    EXPECT_NEAR(fibres.first[i].x(), std::cos(pi / 6), 1e-12);
    EXPECT_NEAR(fibres.first[i].y(), 0.5, 1e-12);
    EXPECT_NEAR(fibres.second[i].y(), -0.5, 1e-12);
  }
}

TEST(NativeLeaflets, UnevenCommissuresAreRefused) {
  const auto& f = fitted();
  const Root root(f.lumen, 0, 15);
  test::expect_error(ExitCode::input, {"commissure_angles_rad", "degrees apart"}, [&] {
    fit_native_valve(root, f.proportions, {}, {0.0, 0.2, 3.0}, edge_mm, 26.21, f.lumen);
  });
}

TEST(NativeLeaflets, AxisOutsideTheLumenIsRefused) {
  const auto solid = geometry::sample(Vec3(-5, -5, -5), Vec3(5, 5, 25), 0.5, [](const Vec3&) { return 1.0; });
  test::expect_error(ExitCode::input, {"outside the lumen"}, [&] { Root(solid, 0, 15); });
}

}  // namespace
}  // namespace valsalva::mesher
