// The obstacle course of linear shells, against published values, on regular, alternating and unstructured
// meshes.
#include <gtest/gtest.h>

#include "../solids/reference.hpp"
#include "linear.hpp"

using namespace valsalva;
using namespace valsalva::structure;
using test::Pattern;

namespace {

// The first, or the second (after a slash), published value of a case.
double published(const std::vector<std::vector<std::string>>& rows, const std::string& name,
                 bool second = false) {
  for (const auto& row : rows)
    if (row[0].rfind(name, 0) == 0) return std::stod(second ? row[2].substr(row[2].find('/') + 1) : row[2]);
  throw std::runtime_error("no row " + name);
}

EdgeCondition symmetry(const Vec3& normal) {
  return {EdgeSupport::symmetry, normal, 0};
}

struct Sides {
  const test::SheetMesh& sheet;
  EdgeConditions conditions;
  double width, height;
  template <class On>
  void set(const EdgeCondition& condition, const On& on) {
    for (const Edge& e : test::border_edges(sheet, on)) conditions[e] = condition;
  }
};

// Fixes components where the sheet's parameters satisfy a condition.
template <class On>
void hold(LinearShell& scene, const test::SheetMesh& sheet, const char* components, const On& on) {
  for (std::size_t a = 0; a < sheet.plane.size(); ++a)
    if (on(sheet.plane[a].x(), sheet.plane[a].y()))
      for (const char* c = components; *c; ++c) scene.fixed[3 * a + (*c - 'x')] = 1;
}

constexpr double degree = M_PI / 180;

// A quarter: u round from the crown (0) to the free edge (40 degrees), v from the middle (0) to the
// diaphragm.
double scordelis_lo(int n, Pattern pattern) {
  const double radius = 25, half = 25, angle = 40 * degree;
  const test::SheetMesh sheet = test::sheet(radius * angle, half, n, n, pattern);
  const Points x = test::mapped(sheet, [&](double u, double v) {
    return Vec3(radius * std::sin(u / radius), v, radius * std::cos(u / radius));
  });
  Sides sides{sheet, {}, radius * angle, half};
  sides.set(symmetry(Vec3::UnitX()), [](double u, double) { return u == 0; });
  sides.set(symmetry(Vec3::UnitY()), [](double, double v) { return v == 0; });
  LinearShell scene(test::shell_mesh(sheet, x, 0.25), koiter_section(4.32e8, 0), sides.conditions);
  hold(scene, sheet, "x", [](double u, double) { return u == 0; });
  hold(scene, sheet, "y", [](double, double v) { return v == 0; });
  hold(scene, sheet, "xz", [&](double, double v) { return v == half; });
  scene.add_area_load([](const Vec3&) { return Vec3(0, 0, -90); });
  return -scene.solve()[test::node_near(sheet.plane, Vec3(radius * angle, 0, 0))].z();
}

// An eighth: u round from the load (0) to the symmetry plane (90 degrees), v from the load (0) to the
// diaphragm.
double pinched_cylinder(int n, Pattern pattern) {
  const double radius = 300, half = 300;
  const double end = radius * 90 * degree;
  const test::SheetMesh sheet = test::sheet(end, half, n, n, pattern);
  const Points x = test::mapped(sheet, [&](double u, double v) {
    return Vec3(radius * std::sin(u / radius), v, radius * std::cos(u / radius));
  });
  Sides sides{sheet, {}, end, half};
  sides.set(symmetry(Vec3::UnitX()), [](double u, double) { return u == 0; });
  sides.set(symmetry(Vec3::UnitZ()), [&](double u, double) { return u == end; });
  sides.set(symmetry(Vec3::UnitY()), [](double, double v) { return v == 0; });
  LinearShell scene(test::shell_mesh(sheet, x, 3), koiter_section(3e6, 0.3), sides.conditions);
  hold(scene, sheet, "x", [](double u, double) { return u == 0; });
  hold(scene, sheet, "z", [&](double u, double) { return u == end; });
  hold(scene, sheet, "y", [](double, double v) { return v == 0; });
  hold(scene, sheet, "xz", [&](double, double v) { return v == half; });
  const int loaded = test::node_near(sheet.plane, Vec3(0, 0, 0));
  scene.load[loaded].z() = -0.25;
  return -scene.solve()[loaded].z();
}

// A quarter with an 18-degree hole: u round from x (outward load) to y (inward load), v up from the equator.
double pinched_hemisphere(int n, Pattern pattern) {
  const double radius = 10, top = 72 * degree, end = 90 * degree;
  const test::SheetMesh sheet = test::sheet(end, top, n, n, pattern);
  const Points x = test::mapped(sheet, [&](double u, double v) {
    return Vec3(radius * std::cos(u) * std::cos(v), radius * std::sin(u) * std::cos(v), radius * std::sin(v));
  });
  Sides sides{sheet, {}, end, top};
  sides.set(symmetry(Vec3::UnitY()), [](double u, double) { return u == 0; });
  sides.set(symmetry(Vec3::UnitX()), [&](double u, double) { return u == end; });
  LinearShell scene(test::shell_mesh(sheet, x, 0.04), koiter_section(6.825e7, 0.3), sides.conditions);
  hold(scene, sheet, "y", [](double u, double) { return u == 0; });
  hold(scene, sheet, "x", [&](double u, double) { return u == end; });
  const int out = test::node_near(sheet.plane, Vec3(0, 0, 0)),
            in = test::node_near(sheet.plane, Vec3(end, 0, 0));
  scene.fixed[3 * out + 2] = 1;  // the rigid motion along z
  scene.load[out].x() = 1;
  scene.load[in].y() = -1;
  const Points u = scene.solve();
  return 0.5 * (u[out].x() - u[in].y());
}

// L = 12, width 1.1, twisted by 90 degrees, clamped at u = 0; load at the end in its plane or across it.
double twisted_beam(int n, Pattern pattern, bool in_plane, double thickness) {
  const double length = 12, width = 1.1;
  const test::SheetMesh sheet = test::sheet(length, width, 6 * n, n, pattern);
  const Points x = test::mapped(sheet, [&](double u, double v) {
    const double angle = 90 * degree * u / length, w = v - 0.5 * width;
    return Vec3(u, w * std::cos(angle), w * std::sin(angle));
  });
  Sides sides{sheet, {}, length, width};
  sides.set({EdgeSupport::clamped, Vec3::Zero(), 0}, [](double u, double) { return u == 0; });
  LinearShell scene(test::shell_mesh(sheet, x, thickness), koiter_section(29e6, 0.22), sides.conditions);
  hold(scene, sheet, "xyz", [](double u, double) { return u == 0; });
  // The end lies along z.
  const Vec3 direction = in_plane ? Vec3::UnitZ() : Vec3::UnitY();
  for (std::size_t a = 0; a < x.size(); ++a)
    if (sheet.plane[a].x() == length) {
      const double v = sheet.plane[a].y();
      scene.load[a] = direction / n * (v == 0 || v == width ? 0.5 : 1);
    }
  const Points u = scene.solve();
  return u[test::node_near(sheet.plane, Vec3(length, 0.5 * width, 0))].dot(direction);
}

template <class Solve>
void table(const char* name, double value, const std::vector<int>& sizes, const Solve& solve) {
  std::printf("| %s | exact %.5g |", name, value);
  for (int n : sizes) std::printf(" %d |", n);
  std::printf("\n");
  for (Pattern pattern : {Pattern::one_way, Pattern::alternating, Pattern::unstructured}) {
    std::printf("| | %s |", test::name_of(pattern));
    double last = 0;
    for (int n : sizes) std::printf(" %.4f |", (last = solve(n, pattern)) / value);
    std::printf("\n");
    std::fflush(stdout);
    EXPECT_NEAR(last, value, 0.01 * value) << name << ", " << test::name_of(pattern);
  }
}

}  // namespace

TEST(LinearShells, ScordelisLo) {
  const auto rows = reference_rows("linear_shells_beams.csv");
  VALSALVA_NEEDS(rows);
  table("Scordelis-Lo", published(rows, "Scordelis-Lo"), {16, 32, 64}, scordelis_lo);
}

TEST(LinearShells, PinchedCylinder) {
  const auto rows = reference_rows("linear_shells_beams.csv");
  VALSALVA_NEEDS(rows);
  table("pinched cylinder", published(rows, "pinched cylinder"), {16, 32, 64}, pinched_cylinder);
}

TEST(LinearShells, PinchedHemisphere) {
  const auto rows = reference_rows("linear_shells_beams.csv");
  VALSALVA_NEEDS(rows);
  table("pinched hemisphere", published(rows, "pinched hemisphere"), {8, 16, 32}, pinched_hemisphere);
}

TEST(LinearShells, TwistedBeam) {
  const auto rows = reference_rows("linear_shells_beams.csv");
  VALSALVA_NEEDS(rows);
  table("twisted beam, load in plane", published(rows, "twisted beam"), {2, 4, 8, 16},
        [](int n, Pattern p) { return twisted_beam(n, p, true, 0.32); });
  table("twisted beam, load across", published(rows, "twisted beam", true), {2, 4, 8, 16},
        [](int n, Pattern p) { return twisted_beam(n, p, false, 0.32); });
}
