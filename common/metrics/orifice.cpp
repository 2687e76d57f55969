#include "metrics/orifice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::metrics {

namespace {

enum Pixel : std::uint8_t { open, covered, reached };

void cover(std::vector<std::uint8_t>& pixels, int n, const std::array<Eigen::Vector2d, 3>& corner) {
  const Eigen::Vector2d low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]);
  const Eigen::Vector2d high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
  const Eigen::Vector2d a = corner[1] - corner[0], b = corner[2] - corner[0];
  const double area = a.x() * b.y() - a.y() * b.x();
  if (area == 0) return;
  for (int j = std::max(0, static_cast<int>(std::ceil(low.y()))); j <= std::min<double>(n - 1, high.y()); ++j)
    for (int i = std::max(0, static_cast<int>(std::ceil(low.x()))); i <= std::min<double>(n - 1, high.x());
         ++i) {
      const Eigen::Vector2d p = Eigen::Vector2d(i, j) - corner[0];
      const double s = (p.x() * b.y() - p.y() * b.x()) / area, t = (a.x() * p.y() - a.y() * p.x()) / area;
      if (s >= 0 && t >= 0 && s + t <= 1) pixels[static_cast<std::size_t>(j) * n + i] = covered;
    }
}

}  // namespace

double OrificeOutline::largest_radius() const {
  return radius_mm.empty() ? 0 : *std::max_element(radius_mm.begin(), radius_mm.end());
}

double OrificeOutline::radius_at(double x, double y) const {
  const double turn = std::atan2(y, x) / (2 * std::numbers::pi) + 0.5;
  const std::size_t sector = static_cast<std::size_t>(turn * static_cast<double>(radius_mm.size()));
  return radius_mm[std::min(radius_mm.size() - 1, sector)];
}

OrificeOutline outline_of(const Points& attached, double pixel_mm) {
  VALSALVA_ASSERT(!attached.empty());
  constexpr int sectors = 72;
  OrificeOutline outline;
  outline.pixel_mm = pixel_mm;
  for (const Vec3& p : attached) outline.centre += p.head<2>() / static_cast<double>(attached.size());
  std::vector<double> radius(sectors, 0.0);
  for (const Vec3& p : attached) {
    const Eigen::Vector2d away = p.head<2>() - outline.centre;
    const double turn = std::atan2(away.y(), away.x()) / (2 * std::numbers::pi) + 0.5;
    double& r = radius[std::min(sectors - 1, static_cast<int>(turn * sectors))];
    r = std::max(r, away.norm());
  }
  outline.radius_mm = radius;
  for (int s = 0; s < sectors; ++s) {
    if (radius[s] > 0) continue;
    int before = 1, after = 1;
    while (radius[(s + sectors - before) % sectors] == 0) ++before;
    while (radius[(s + after) % sectors] == 0) ++after;
    outline.radius_mm[s] =
        (after * radius[(s + sectors - before) % sectors] + before * radius[(s + after) % sectors]) /
        (before + after);
  }
  return outline;
}

double orifice_area(const Points& x, const std::vector<Triangle>& triangles, const OrificeOutline& outline) {
  const double largest = outline.largest_radius(), pixel = outline.pixel_mm;
  if (!(largest > 0) || !(pixel > 0))
    throw InputError("orifice: an outline of radius {} mm with pixels of {} mm; expected positive ones",
                     largest, pixel);
  const int half = static_cast<int>(std::ceil(largest / pixel)), n = 2 * half + 1;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(n) * n, open);
  auto to_pixel = [&](const Vec3& p) {
    return Eigen::Vector2d((p.head<2>() - outline.centre) / pixel + Eigen::Vector2d::Constant(half));
  };
  for (const Triangle& t : triangles)
    cover(pixels, n, {to_pixel(x[t[0]]), to_pixel(x[t[1]]), to_pixel(x[t[2]])});

  std::vector<std::array<int, 2>> front;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      std::uint8_t& at = pixels[static_cast<std::size_t>(j) * n + i];
      const double distance = pixel * std::hypot(i - half, j - half);
      const double radius = outline.radius_at(i - half, j - half);
      if (distance > radius) at = covered;
      if (at == open && distance <= radius / 3) {
        at = reached;
        front.push_back({i, j});
      }
    }
  std::size_t count = front.size();
  while (!front.empty()) {
    const auto [i, j] = front.back();
    front.pop_back();
    for (const auto& [di, dj] : {std::array{1, 0}, std::array{-1, 0}, std::array{0, 1}, std::array{0, -1}}) {
      const int a = i + di, b = j + dj;
      if (a < 0 || b < 0 || a >= n || b >= n || pixels[static_cast<std::size_t>(b) * n + a] != open) continue;
      pixels[static_cast<std::size_t>(b) * n + a] = reached;
      front.push_back({a, b});
      ++count;
    }
  }
  return static_cast<double>(count) * pixel * pixel;
}

}  // namespace valsalva::metrics
