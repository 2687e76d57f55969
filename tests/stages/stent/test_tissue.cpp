#include "tissue.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/errors.hpp"
#include "device.hpp"
#include "drape.hpp"

namespace valsalva::stent {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rad = pi / 180;

Parameters coarse(double size) {
  Parameters p;
  p.device = supra_annular(size);
  p.design.leaflet_edge_mm = 0.8;
  p.design.skirt_edge_mm = 1.2;
  p.design.fibre_half_angle = 7.81 * rad;
  p.design.leaflet_mean_fibre = 45 * rad;
  p.design.skirt_mean_fibre = 90 * rad;
  return p;
}

const Assembly& of_size(double size) {
  static std::map<double, Assembly> made;
  const auto found = made.find(size);
  return found != made.end() ? found->second : made.emplace(size, assemble(coarse(size))).first->second;
}

double radius(const Vec3& x) {
  return std::hypot(x.x(), x.y());
}

/// How many triangles meet at every edge.
std::map<Edge, int> edge_uses(const Tissue& t) {
  std::map<Edge, int> uses;
  for (const Triangle& tri : t.triangles)
    for (int c = 0; c < 3; ++c)
      ++uses[{std::min(tri[c], tri[(c + 1) % 3]), std::max(tri[c], tri[(c + 1) % 3])}];
  return uses;
}

void expect_sound(const Tissue& t, std::size_t frame_nodes) {
  ASSERT_EQ(t.reference.size(), t.points.size());
  ASSERT_EQ(t.attached.size(), t.points.size());
  std::vector<int> used(t.points.size(), 0);
  for (const Triangle& tri : t.triangles)
    for (int node : tri) {
      ASSERT_TRUE(node >= 0 && node < static_cast<int>(t.points.size()));
      ++used[node];
    }
  for (int count : used) EXPECT_GT(count, 0);
  for (const auto& [edge, uses] : edge_uses(t)) EXPECT_LE(uses, 2);
  for (const Vec3& x : t.points) EXPECT_TRUE(x.allFinite());
  std::vector<char> seen(t.points.size(), 0);
  for (const auto& [tissue, frame] : t.ties) {
    ASSERT_TRUE(tissue >= 0 && tissue < static_cast<int>(t.points.size()));
    ASSERT_TRUE(frame >= 0 && frame < static_cast<int>(frame_nodes));
    EXPECT_FALSE(seen[tissue]++) << "tissue node " << tissue << " is tied twice";
    EXPECT_EQ(t.attached[tissue], 1);
  }
}

void expect_fibres(const Tissue& t, double half_angle) {
  for (std::size_t i = 0; i < t.triangles.size(); ++i) {
    const auto& [a, b, c] = t.triangles[i];
    const Vec3 normal = (t.reference[b] - t.reference[a]).cross(t.reference[c] - t.reference[a]).normalized();
    for (const Vec3& fibre : {t.fibre1[i], t.fibre2[i]}) {
      EXPECT_NEAR(fibre.norm(), 1, 1e-12);
      EXPECT_NEAR(fibre.dot(normal), 0, 1e-9);
    }
    EXPECT_NEAR(t.fibre1[i].dot(t.fibre2[i]), std::cos(2 * half_angle), 1e-9);
  }
}

class Sizes : public testing::TestWithParam<double> {};

TEST_P(Sizes, MeshesAndTiesAreSound) {
  const Assembly& a = of_size(GetParam());
  expect_sound(a.leaflets, a.frame.nodes.size());
  expect_sound(a.skirt, a.frame.nodes.size());
  for (int k = 0; k < 3; ++k)
    EXPECT_GE(std::count_if(a.leaflets.ties.begin(), a.leaflets.ties.end(),
                            [&](const Edge& tie) {
                              const std::size_t third = a.leaflets.points.size() / 3;
                              return static_cast<std::size_t>(tie[0]) / third == static_cast<std::size_t>(k);
                            }),
              8);
}

TEST_P(Sizes, StitchesAreShortAndLieAtTheirStrut) {
  // Ties keep their offset in the node's rotating frame: one that reached across a cell would swing out of
  // it.
  const Assembly& a = of_size(GetParam());
  for (const Tissue* tissue : {&a.leaflets, &a.skirt})
    for (const auto& [node, frame] : tissue->ties) {
      const Vec3 &x = tissue->points[node], &f = a.frame.nodes[frame];
      EXPECT_LT(radius(x), radius(f));
      const double around =
          radius(f) * std::abs(std::remainder(std::atan2(x.y(), x.x()) - std::atan2(f.y(), f.x()), 2 * pi));
      EXPECT_LT(around, 0.7);
      EXPECT_LT((x - f).norm(), 1.5);
    }
}

TEST_P(Sizes, FreeEdgeHasTheLengthAskedFor) {
  const Assembly& a = of_size(GetParam());
  const Profile surface = leaflet_surface(a.frame, coarse(GetParam()).design);
  const double third = 2 * pi / 3 * surface.radius(a.crown->commissure_mm());
  double length = 0;
  for (const auto& [edge, uses] : edge_uses(a.leaflets))
    if (uses == 1 && !(a.leaflets.attached[edge[0]] && a.leaflets.attached[edge[1]]))
      length += (a.leaflets.reference[edge[0]] - a.leaflets.reference[edge[1]]).norm();
  EXPECT_NEAR(length / 3, 1.03 * third, 2e-3 * third);
}

TEST_P(Sizes, SewingDoesNotStretchTheLeaflets) {
  const Assembly& a = of_size(GetParam());
  EXPECT_LT(a.leaflet_measures.mounting_strain, 0.03);
}

TEST_P(Sizes, LayersKeepClearOfEachOther) {
  const Assembly& a = of_size(GetParam());
  const TissueDesign design = coarse(GetParam()).design;
  // Strut to skirt, and skirt to leaflet.
  const Profile skirt = skirt_surface(a.frame, design), inside = leaflet_surface(a.frame, design);
  for (double z = 0; z <= a.crown->commissure_mm(); z += 0.5) {
    EXPECT_GE(a.frame.profile.radius(z) - skirt.radius(z), 0.45 / 2 + design.thickness_mm / 2);
    EXPECT_GE(skirt.radius(z) - inside.radius(z), design.thickness_mm);
  }
  // Leaflet to leaflet: every node stays in its own third, half a gap from its border.
  const std::size_t third = a.leaflets.points.size() / 3;
  for (std::size_t i = 0; i < a.leaflets.points.size(); ++i) {
    const Vec3& x = a.leaflets.points[i];
    const double middle = a.commissures[i / third] + pi / 3;
    const double off = std::remainder(std::atan2(x.y(), x.x()) - middle, 2 * pi);
    const double to_border = radius(x) * std::sin(pi / 3 - std::abs(off));
    EXPECT_GT(to_border, 0.5 * design.thickness_mm) << i;
    EXPECT_LT(radius(x), inside.radius(x.z()) + 0.02);
  }
}

TEST_P(Sizes, LeafletsStandHalfOpen) {
  const Assembly& a = of_size(GetParam());
  const double r = leaflet_surface(a.frame, coarse(GetParam()).design).radius(a.crown->commissure_mm());
  EXPECT_GT(a.leaflet_measures.orifice_radius_mm, 0.1 * r);
  EXPECT_LT(a.leaflet_measures.orifice_radius_mm, 0.9 * r);
}

TEST_P(Sizes, FibresAreUnitAndTangent) {
  const Assembly& a = of_size(GetParam());
  expect_fibres(a.leaflets, 7.81 * rad);
  expect_fibres(a.skirt, 7.81 * rad);
}

TEST_P(Sizes, TrianglesFaceOutwards) {
  const Assembly& a = of_size(GetParam());
  for (const Triangle& t : a.skirt.triangles) {
    const Vec3 &p = a.skirt.points[t[0]], &q = a.skirt.points[t[1]], &r = a.skirt.points[t[2]];
    const Vec3 centre = (p + q + r) / 3;
    EXPECT_GT((q - p).cross(r - p).dot(Vec3(centre.x(), centre.y(), 0)), 0);
  }
  const std::size_t third = a.leaflets.triangles.size() / 3;
  for (std::size_t i = 0; i < a.leaflets.triangles.size(); ++i) {
    const Triangle& t = a.leaflets.triangles[i];
    const Vec3 &p = a.leaflets.reference[t[0]], &q = a.leaflets.reference[t[1]],
               &r = a.leaflets.reference[t[2]];
    const double middle = a.commissures[i / third] + pi / 3;
    EXPECT_GT((q - p).cross(r - p).dot(Vec3(std::cos(middle), std::sin(middle), 0)), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Library, Sizes, testing::Values(23.0, 26.0, 34.0));

TEST(Skirt, IsARingWithoutSlit) {
  // Its edges with one triangle are the inflow circle and the crown: two closed lines and no third.
  const Tissue& skirt = of_size(26).skirt;
  std::map<int, std::vector<int>> next;
  for (const auto& [edge, uses] : edge_uses(skirt))
    if (uses == 1) next[edge[0]].push_back(edge[1]), next[edge[1]].push_back(edge[0]);
  int loops = 0;
  while (!next.empty()) {
    ++loops;
    int at = next.begin()->first;
    while (next.count(at)) {
      ASSERT_EQ(next[at].size(), 2u);
      const int a = next[at][0], b = next[at][1];
      next.erase(at);
      at = next.count(a) ? a : b;
    }
  }
  EXPECT_EQ(loops, 2);
}

TEST(Skirt, HasTheAreaOfItsSurface) {
  const Assembly& a = of_size(26);
  const Profile surface = skirt_surface(a.frame, coarse(26).design);
  double exact = 0;
  constexpr int n = 4000;
  for (int i = 0; i < n; ++i) {
    const double phi = pi / 3 * (i + 0.5) / n, top = a.crown->height(phi);
    for (int k = 0; k < 40; ++k) {
      const double z = top * (k + 0.5) / 40;
      exact += 6 * surface.radius(z) * std::hypot(1.0, surface.slope(z)) * (pi / 3 / n) * (top / 40);
    }
  }
  double area = 0;
  for (const auto& [p, q, r] : a.skirt.triangles)
    area += (a.skirt.points[q] - a.skirt.points[p]).cross(a.skirt.points[r] - a.skirt.points[p]).norm() / 2;
  EXPECT_NEAR(area, exact, 5e-3 * exact);
}

TEST(Pattern, CrownHasTheLengthOfItsSeam) {
  const Assembly& a = of_size(26);
  const std::size_t third = a.leaflets.points.size() / 3;
  double flat = 0, sewn = 0;
  for (const auto& [edge, uses] : edge_uses(a.leaflets)) {
    if (uses != 1 || edge[1] >= static_cast<int>(third)) continue;
    if (!a.leaflets.attached[edge[0]] || !a.leaflets.attached[edge[1]]) continue;
    flat += (a.leaflets.reference[edge[0]] - a.leaflets.reference[edge[1]]).norm();
    sewn += (a.leaflets.points[edge[0]] - a.leaflets.points[edge[1]]).norm();
  }
  EXPECT_NEAR(flat, sewn, 2e-3 * sewn);
}

TEST(Crown, RunsAlongStrutsAndIsSmoothBelowThem) {
  const Device device = supra_annular(26);
  const Crown crown = crown_of_rows(device.frame, device.nadir_mm, device.commissure_mm);
  EXPECT_NEAR(crown.height(pi / 3), 26.0, 1e-12);
  EXPECT_NEAR(crown.height(0), 10.0, 1e-12);
  EXPECT_NEAR(crown.height(48 * rad), 19.2, 1e-12);
  const double join = crown.struts.front().first, h = 1e-6;
  EXPECT_NEAR((crown.height(join) - crown.height(join - h)) / h,
              (crown.height(join + h) - crown.height(join)) / h, 1e-3);
}

TEST(Drape, SheetHeldAtItsFlatEdgeStaysFlat) {
  const PlaneMesh mesh = mesh_polygon({{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}, {{0.1, 0.2}}, 4.0);
  Points flat, start;
  std::vector<bool> held;
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    flat.emplace_back(20, mesh.points[i].x(), mesh.points[i].y());
    held.push_back(i < 4);
    start.push_back(flat.back() + (i < 4 ? Vec3(0, 0, 0) : Vec3(0, 0.05, -0.03)));
  }
  DrapeSettings settings;
  settings.half_angle = pi / 3;
  settings.tolerance = 1e-9;
  const Draped draped = drape(flat, mesh.triangles, held, start, Profile({0}, {50}, "test"), settings);
  for (std::size_t i = 0; i < flat.size(); ++i) EXPECT_NEAR((draped.points[i] - flat[i]).norm(), 0, 1e-6);
  EXPECT_LT(draped.largest_edge_strain, 1e-7);
}

TEST(PlaneMesh, KeepsTheBoundaryAndFillsTheArea) {
  std::vector<Vec2> circle;
  for (int i = 0; i < 40; ++i)
    circle.emplace_back(3 * std::cos(2 * pi * i / 40), 3 * std::sin(2 * pi * i / 40));
  const PlaneMesh mesh = mesh_polygon(circle, {{0.3, 0.4}}, 0.5);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(mesh.points[i], circle[i]);
  EXPECT_EQ(mesh.points[40], Vec2(0.3, 0.4));
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec2 p = mesh.points[b] - mesh.points[a], q = mesh.points[c] - mesh.points[a];
    area += (p.x() * q.y() - p.y() * q.x()) / 2;
  }
  EXPECT_NEAR(area, 20 * 9 * std::sin(2 * pi / 40), 1e-9);
  EXPECT_GT(smallest_angle_deg(mesh.points, mesh.triangles), 20);
}

TEST(BadTissue, NamesTheKey) {
  Parameters p = coarse(26);
  p.device.frame.cells = 16;
  EXPECT_THROW(assemble(p), InputError);
  p = coarse(26), p.device.nadir_mm = 30;
  EXPECT_THROW(assemble(p), InputError);
  p = coarse(26), p.device.commissure_mm = 23;
  EXPECT_THROW(assemble(p), InputError);
  p = coarse(26), p.design.free_edge_excess = 3;
  EXPECT_THROW(assemble(p), InputError);
}

}  // namespace
}  // namespace valsalva::stent
