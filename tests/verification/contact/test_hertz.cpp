// A rigid sphere pressed into an elastic half space, against Hertz: a quarter of it in hexahedra, the
// displacement of a point force (Boussinesq) on the far faces, contact between the meshes of sphere and
// block, implicit equilibrium.
#include <gtest/gtest.h>

#include "../solids/reference.hpp"
#include "scenes.hpp"
#include "solve/statics.hpp"

namespace valsalva::contact {
namespace {

constexpr double R = 10, E = 1000, nu = 0.3;

/// Positions of nodes: `fine` cells up to `near`, then growing to `far`.
std::vector<double> graded(int fine, double near, double far) {
  std::vector<double> at;
  for (int i = 0; i <= fine; ++i) at.push_back(near * i / fine);
  double cell = near / fine;
  while (at.back() < far) {
    cell *= 1.4;
    at.push_back(at.back() + cell);
  }
  at.back() = far;
  if (at.size() > 2 && far - at[at.size() - 2] < 0.5 * (at[at.size() - 2] - at[at.size() - 3]))
    at.erase(at.end() - 2);
  return at;
}

struct Hertz {
  double force, radius, pressure;
  int iterations;
};

/// Indentation delta whose exact contact radius and force are a and F; `cells` of the mesh over a.
Hertz press(structure::Shape shape, double a, double F, double delta, int cells) {
  const double near = 1.25 * a, far = 8 * a, h = 0.2 * delta;
  const std::vector<double> side = graded(int(std::lround(1.25 * cells)), near, far),
                            down = graded(cells, 0.9 * a, far);
  const int n = int(side.size()) - 1, m = int(down.size()) - 1;
  const auto mesh = structure::solid_box(shape, {n, n, m}, [&](const Vec3& u) -> Vec3 {
    return Vec3(side[std::lround(u.x() * n)], side[std::lround(u.y() * n)],
                -down[m - std::lround(u.z() * m)]);
  });
  structure::System system;
  const auto solid =
      std::make_shared<structure::Solid>(mesh, hookean(E, nu), structure::Formulation::displacement);
  const structure::Body block = system.add_body("block", mesh.reference, solid->lumped_mass(1e-3));

  // The sphere's quarter as rings of triangles, edges like those of the block.
  Points ball;
  std::vector<Triangle> faces;
  const int rings = int(std::lround(1.5 * cells)), spokes = 2 * cells;
  ball.emplace_back(0, 0, h);
  for (int i = 1; i <= rings; ++i)
    for (int k = 0; k <= spokes; ++k) {
      const double r = 1.5 * a * i / rings, angle = 0.5 * M_PI * k / spokes;
      ball.emplace_back(r * std::cos(angle), r * std::sin(angle), h + R - std::sqrt(R * R - r * r));
    }
  const auto at = [&](int ring, int spoke) { return ring == 0 ? 0 : 1 + (ring - 1) * (spokes + 1) + spoke; };
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < spokes; ++k) {
      if (i > 0) faces.push_back({at(i, k), at(i, k + 1), at(i + 1, k)});
      faces.push_back({at(i, k + 1), at(i + 1, k + 1), at(i + 1, k)});
      if (i == 0) faces.back() = {0, at(1, k), at(1, k + 1)};
    }
  const structure::Body sphere = system.add_body("sphere", ball, std::vector<double>(ball.size(), 1.0));

  CollisionMesh all(system.state.x);
  const auto top = structure::faces_where(
      mesh, [&](const Vec3& x) { return x.z() > -1e-9 && x.x() < 1.9 * a && x.y() < 1.9 * a; });
  all.add_shell({"block", 0}, block.offset, triangles_of(top), std::vector<double>(block.count, 0.5 * h));
  all.add_shell({"sphere", 1}, sphere.offset, faces, std::vector<double>(sphere.count, 0.5 * h));
  Candidates candidates(std::move(all), {300 * E, 0.9, 20 * h, 5 * h});
  candidates.set_pair("block", "block", {false});
  candidates.set_pair("sphere", "sphere", {false});
  candidates.set_pair("block", "sphere", {true, 0, 0, 0, true});
  const auto contact = std::make_shared<BodyContact>(std::move(candidates), Law::barrier);

  solve::Supports supports;
  for (int i = 0; i < sphere.count; ++i) {
    supports.fix(sphere.offset + i, 0);
    supports.fix(sphere.offset + i, 1);
    supports.move(sphere.offset + i, 2, [delta](double t) { return -delta * t; });
  }
  for (int i = 0; i < block.count; ++i) {
    const Vec3& x = mesh.reference[i];
    const bool outer = x.x() > far - 1e-9 || x.y() > far - 1e-9 || x.z() < -far + 1e-9;
    if (outer) {
      const double r = std::hypot(x.x(), x.y()), z = -x.z(), rho = x.norm();
      const double common = F * (1 + nu) / (2 * M_PI * E);
      const double radial = common * (r * z / (rho * rho * rho) - (1 - 2 * nu) * r / (rho * (rho + z)));
      const double depth = common * (z * z / (rho * rho * rho) + 2 * (1 - nu) / rho);
      const Vec3 u(r > 0 ? radial * x.x() / r : 0, r > 0 ? radial * x.y() / r : 0, -depth);
      for (int c = 0; c < 3; ++c)
        supports.move(block.offset + i, c, [value = u[c]](double t) { return value * std::pow(t, 1.5); });
      continue;
    }
    if (x.x() < 1e-9) supports.fix(block.offset + i, 0);
    if (x.y() < 1e-9) supports.fix(block.offset + i, 1);
  }
  solve::StaticsSettings settings;
  settings.first_step = settings.max_step = 0.5;
  settings.newton.max_iterations = 60;
  solve::Statics statics(system, {std::make_shared<structure::SolidTerm>(solid, block), contact}, supports,
                         settings);
  statics.advance_to(1);

  const Points force = contact->forces(system.state.x);
  Hertz out{0, 0, 0, statics.iterations()};
  double second = 0, area = 0;
  std::vector<double> share(block.count, 0.0);  // of the surface
  for (const Triangle& t : triangles_of(top)) {
    const Vec3 &p = mesh.reference[t[0]], &q = mesh.reference[t[1]], &s = mesh.reference[t[2]];
    for (int k : t) share[k] += (q - p).cross(s - p).norm() / 6;
  }
  for (int i = 0; i < block.count; ++i) {
    const double f = -force[block.offset + i].z();
    const double r2 = mesh.reference[i].head<2>().squaredNorm();
    out.force += 4 * f;
    second += 4 * f * r2;
  }
  out.radius = std::sqrt(2.5 * second / out.force);  // of Hertz's distribution, the mean square is 0.4 a^2
  double weighted = 0;
  for (int i = 0; i < block.count; ++i) {
    const double r2 = mesh.reference[i].head<2>().squaredNorm();
    if (r2 > 0.25 * a * a || share[i] == 0) continue;
    area += share[i] * std::sqrt(1 - r2 / (out.radius * out.radius));
    weighted += -force[block.offset + i].z();
  }
  out.pressure = weighted / area;
  return out;
}

}  // namespace

TEST(Hertz, RigidSphereOnAnElasticHalfSpace) {
  const auto rows = reference_rows("hertz.csv");
  VALSALVA_NEEDS(rows);
  std::printf("| element | cells over a | delta | F | Hertz | a | Hertz | p0 | Hertz | Newton |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|\n");
  const auto run = [&](structure::Shape shape, std::size_t row, int cells) {
    const double F = std::stod(rows[row][0]), a = std::stod(rows[row][1]), delta = std::stod(rows[row][2]),
                 p0 = std::stod(rows[row][3]);
    const Hertz out = press(shape, a, F, delta, cells);
    std::printf("| %s | %d | %.6f | %.4f | %g | %.4f | %.4f | %.3f | %.3f | %d |\n",
                structure::name_of(shape).c_str(), cells, delta, out.force, F, out.radius, a, out.pressure,
                p0, out.iterations);
    return std::array{std::abs(out.force / F - 1), std::abs(out.radius / a - 1),
                      std::abs(out.pressure / p0 - 1)};
  };
  run(structure::Shape::hex8, 0, 4);
  const auto fine = run(structure::Shape::hex8, 0, 6);
  EXPECT_LT(fine[0], 0.03);
  EXPECT_LT(fine[1], 0.03);
  EXPECT_LT(fine[2], 0.05);
}

}  // namespace valsalva::contact
