#include "metrics/orifice.hpp"

#include <algorithm>
#include <cmath>

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

double orifice_area(const Points& x, const std::vector<Triangle>& triangles, const OrificeDisc& disc) {
  if (!(disc.radius_mm > 0) || !(disc.pixel_mm > 0))
    throw InputError("orifice: disc of radius {} mm with pixels of {} mm; expected positive ones",
                     disc.radius_mm, disc.pixel_mm);
  const int half = static_cast<int>(std::ceil(disc.radius_mm / disc.pixel_mm)), n = 2 * half + 1;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(n) * n, open);
  auto to_pixel = [&](const Vec3& p) {
    return Eigen::Vector2d((p.head<2>() - disc.centre) / disc.pixel_mm + Eigen::Vector2d::Constant(half));
  };
  for (const Triangle& t : triangles)
    cover(pixels, n, {to_pixel(x[t[0]]), to_pixel(x[t[1]]), to_pixel(x[t[2]])});

  const double radius = disc.radius_mm / disc.pixel_mm;
  auto distance = [&](int i, int j) { return std::hypot(i - half, j - half); };
  std::vector<std::array<int, 2>> front;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      std::uint8_t& pixel = pixels[static_cast<std::size_t>(j) * n + i];
      if (distance(i, j) > radius) pixel = covered;
      if (pixel == open && distance(i, j) <= radius / 3) {
        pixel = reached;
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
  return count * disc.pixel_mm * disc.pixel_mm;
}

OrificeDisc disc_of(const Points& attached, double pixel_mm) {
  VALSALVA_ASSERT(!attached.empty());
  OrificeDisc disc;
  disc.pixel_mm = pixel_mm;
  for (const Vec3& p : attached) disc.centre += p.head<2>() / static_cast<double>(attached.size());
  for (const Vec3& p : attached)
    disc.radius_mm = std::max(disc.radius_mm, (p.head<2>() - disc.centre).norm());
  return disc;
}

}  // namespace valsalva::metrics
