#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "metrics/orifice.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::metrics;

constexpr double pi = std::numbers::pi;

Points circle(double radius, int n) {
  Points points;
  for (int i = 0; i < n; ++i)
    points.emplace_back(1 + radius * std::cos(2 * pi * i / n), 2 + radius * std::sin(2 * pi * i / n), i % 5);
  return points;
}

// A ring of triangles between two radii, on a slope.
void ring(double inner, double outer, Points& x, std::vector<Triangle>& triangles) {
  const int n = 90, first = static_cast<int>(x.size());
  for (int i = 0; i < n; ++i)
    for (double r : {inner, outer})
      x.emplace_back(1 + r * std::cos(2 * pi * i / n), 2 + r * std::sin(2 * pi * i / n), 3 * r);
  for (int i = 0; i < n; ++i) {
    const int a = first + 2 * i, b = first + 2 * ((i + 1) % n);
    triangles.push_back({a, a + 1, b});
    triangles.push_back({b, a + 1, b + 1});
  }
}

TEST(Orifice, OfARingIsItsHole) {
  Points x;
  std::vector<Triangle> t;
  ring(6, 12, x, t);
  EXPECT_NEAR(orifice_area(x, t, outline_of(circle(12, 200), 0.1)), pi * 36, 0.5 * 0.1 * 2 * pi * 6);
}

TEST(Orifice, GapsBehindTheLeafletsDoNotCount) {
  Points x;
  std::vector<Triangle> t;
  ring(6, 9, x, t);
  EXPECT_NEAR(orifice_area(x, t, outline_of(circle(12, 200), 0.1)), pi * 36, 0.5 * 0.1 * 2 * pi * 6);
}

TEST(Orifice, AClosedValveHasNone) {
  Points x;
  std::vector<Triangle> t;
  ring(0, 12.1, x, t);
  EXPECT_LT(orifice_area(x, t, outline_of(circle(12, 200), 0.1)), 0.5);
}

TEST(Orifice, OutlineFollowsTheNodesAndFillsEmptySectors) {
  Points ellipse;
  for (int i = 0; i < 30; ++i)
    ellipse.emplace_back(12 * std::cos(2 * pi * i / 30), 9 * std::sin(2 * pi * i / 30), 0);
  const OrificeOutline outline = outline_of(ellipse, 0.1);
  EXPECT_NEAR(outline.radius_at(1, 0.01), 12, 0.3);
  EXPECT_NEAR(outline.radius_at(0.01, 1), 9, 0.3);
  EXPECT_NEAR(outline.largest_radius(), 12, 1e-9);
  EXPECT_NEAR(orifice_area({}, {}, outline), pi * 12 * 9, 0.03 * pi * 12 * 9);
}

TEST(Orifice, RefusesAnEmptyOutline) {
  EXPECT_THROW(orifice_area({}, {}, {}), InputError);
}

}  // namespace
