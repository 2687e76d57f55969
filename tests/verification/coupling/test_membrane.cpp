// A closed elastic membrane, stretched and hence under pressure, in a closed box of fluid at rest: it has to
// keep the volume it encloses, and its pressure has to be that of Laplace's law.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <memory>

#include "coupling/immersed_flow.hpp"
#include "materials/neo_hookean.hpp"

namespace {

using namespace valsalva;

struct Sphere {
  Points points;
  std::vector<Triangle> triangles;
};

Sphere unit_sphere(int refinements) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  Sphere s;
  s.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  s.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int r = 0; r < refinements; ++r) {
    std::map<Edge, int> middle;
    const auto between = [&](int a, int b) {
      const Edge edge{std::min(a, b), std::max(a, b)};
      const auto [entry, fresh] = middle.try_emplace(edge, static_cast<int>(s.points.size()));
      if (fresh) s.points.push_back(0.5 * (s.points[a] + s.points[b]));
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : s.triangles) {
      const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    s.triangles = std::move(finer);
  }
  for (Vec3& x : s.points) x.normalize();
  return s;
}

double volume(const Points& x, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += x[a].dot(x[b].cross(x[c])) / 6;
  return sum;
}

TEST(ClosedMembrane, KeepsItsVolumeAndCarriesLaplacesPressure) {
  const double radius = 6, stretch = 1.1, thickness = 0.3, shear = 50e3;
  const Sphere unit = unit_sphere(4);
  structure::ShellMesh mesh;
  Points start;
  for (const Vec3& x : unit.points) {
    mesh.reference.push_back(radius / stretch * x);
    start.push_back(radius * x + Vec3(0.13, -0.21, 0.08));
  }
  mesh.triangles = unit.triangles;
  mesh.thickness_mm.assign(start.size(), thickness);
  const double h = 1;
  fluid::Boundaries closed;
  for (auto& sides : closed.side) sides = {fluid::Side::slip, fluid::Side::slip};
  fluid::Flow flow(MPI_COMM_SELF, {{20, 20, 20}, Vec3(-10, -10, -10), h}, closed, {});
  structure::Shell shell(mesh, std::make_shared<materials::NeoHookean>(shear), {});
  auto immersed = std::make_unique<coupling::ImmersedShell>(
      MPI_COMM_SELF, std::move(shell), start, start, std::vector<std::uint8_t>(start.size(), 0),
      std::vector<int>(start.size(), -1), coupling::Spacing{});
  coupling::ImmersedFlow system(flow, std::move(immersed), {});
  const double before = volume(start, mesh.triangles);
  for (double t = 0; t < 5e-3;) t += system.step(1e-4).dt_s;
  EXPECT_NEAR(volume(system.shell()->x(), mesh.triangles) / before, 1, 1e-3);
  EXPECT_LT(flow.divergence(), 1e-6);

  // Equibiaxial neo-Hookean membrane: p = 2 t/r sigma / lambda^2, sigma = mu (lambda^2 - lambda^-4).
  const double sigma = shear * (std::pow(stretch, 2) - std::pow(stretch, -4));
  const double laplace = 2 * thickness / (stretch * stretch) / radius * sigma;
  const double inside = flow.pressure_at(Vec3(0, 0, 0)), outside = flow.pressure_at(Vec3(8.5, 8.5, 8.5));
  EXPECT_NEAR((inside - outside) / laplace, 1, 0.03);
}

}  // namespace
