#include "geometry/measure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace valsalva::geometry {
namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

double area(const Loop& loop) {
  double twice = 0;
  for (std::size_t n = 0, m = loop.size() - 1; n < loop.size(); m = n++) twice += cross(loop[m], loop[n]);
  return twice / 2;
}

double perimeter(const Loop& loop) {
  double length = 0;
  for (std::size_t n = 0, m = loop.size() - 1; n < loop.size(); m = n++) length += (loop[n] - loop[m]).norm();
  return length;
}

Vec2 centroid(const Loop& loop) {
  Vec2 moment = Vec2::Zero();
  double twice = 0;
  const Vec2 base = loop.front();  // relative to a point nearby: no cancellation
  for (std::size_t n = 0, m = loop.size() - 1; n < loop.size(); m = n++) {
    const Vec2 a = loop[m] - base, b = loop[n] - base;
    moment += cross(a, b) * (a + b) / 3;
    twice += cross(a, b);
  }
  return base + moment / twice;
}

Caliper caliper(const Loop& loop) {
  Caliper result{std::numeric_limits<double>::max(), 0};
  for (int degree = 0; degree < 180; ++degree) {
    const double angle = degree * std::numbers::pi / 180;
    const Vec2 direction(std::cos(angle), std::sin(angle));
    double low = std::numeric_limits<double>::max(), high = -low;
    for (const Vec2& p : loop) {
      low = std::min(low, p.dot(direction));
      high = std::max(high, p.dot(direction));
    }
    result.least_mm = std::min(result.least_mm, high - low);
    result.greatest_mm = std::max(result.greatest_mm, high - low);
  }
  return result;
}

double SectionFigures::area_diameter_mm() const {
  return 2 * std::sqrt(area_mm2 / std::numbers::pi);
}

double SectionFigures::perimeter_diameter_mm() const {
  return perimeter_mm / std::numbers::pi;
}

SectionFigures figures(const Loop& loop, const Plane& plane) {
  const Caliper widths = caliper(loop);
  return {area(loop), perimeter(loop), widths.least_mm, widths.greatest_mm, plane.point(centroid(loop))};
}

std::vector<double> radii(const Loop& loop, const Vec2& from, int count) {
  std::vector<double> result(count, 0.0);
  for (int direction = 0; direction < count; ++direction) {
    const double angle = 2 * std::numbers::pi * direction / count;
    const Vec2 ray(std::cos(angle), std::sin(angle));
    for (std::size_t n = 0, m = loop.size() - 1; n < loop.size(); m = n++) {
      const Vec2 a = loop[m] - from, b = loop[n] - from;
      const double ca = cross(ray, a), cb = cross(ray, b);
      if ((ca > 0) == (cb > 0)) continue;
      result[direction] = std::max(result[direction], ray.dot(a + ca / (ca - cb) * (b - a)));
    }
  }
  return result;
}

}  // namespace valsalva::geometry
