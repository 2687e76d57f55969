#include "root.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "core/errors.hpp"

namespace valsalva::mesher {
namespace {

constexpr int rays = 72;
constexpr double furthest_mm = 60;

double distance_to_wall(const geometry::GridSdf& lumen, const Vec3& start, const Vec3& direction) {
  const double step = 0.5 * lumen.spacing;
  if (lumen.value(start) >= 0)
    throw InputError(
        "level set of the lumen: the axis point ({:.2f}, {:.2f}, {:.2f}) mm lies outside the lumen; expected "
        "an open "
        "root between the annulus and the sinotubular junction: check the segmentation there",
        start.x(), start.y(), start.z());
  double low = 0, high = step;
  while (lumen.value(start + high * direction) < 0) {
    low = high;
    high += step;
    if (high > furthest_mm)
      throw InputError("level set of the lumen: no wall within {:.0f} mm of the axis at z = {:.2f} mm",
                       furthest_mm, start.z());
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (lumen.value(start + middle * direction) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Vec3 ray(double angle) {
  return {std::cos(angle), std::sin(angle), 0};
}

/// Centroid of the star-shaped section around a starting point.
Vec3 section_centre(const geometry::GridSdf& lumen, Vec3 centre) {
  for (int pass = 0; pass < 3; ++pass) {
    Vec3 moment = Vec3::Zero();
    double area = 0;
    double previous = distance_to_wall(lumen, centre, ray(0));
    for (int i = 1; i <= rays; ++i) {
      const double from = 2 * std::numbers::pi * (i - 1) / rays, to = 2 * std::numbers::pi * i / rays;
      const double radius = distance_to_wall(lumen, centre, ray(to));
      const Vec3 a = previous * ray(from), b = radius * ray(to);
      const double triangle = 0.5 * (a.x() * b.y() - a.y() * b.x());
      area += triangle;
      moment += triangle * (a + b) / 3;
      previous = radius;
    }
    centre += moment / area;
  }
  return centre;
}

}  // namespace

Root::Root(const geometry::GridSdf& lumen, double low_z, double high_z) : lumen_(lumen) {
  VALSALVA_ASSERT(low_z < high_z);
  constexpr int sections = 12;
  Vec3 centre(0, 0, low_z);
  std::vector<Vec3> centres;
  for (int i = 0; i < sections; ++i) {
    centre.z() = low_z + (high_z - low_z) * i / (sections - 1);
    centre = section_centre(lumen, centre);
    centres.push_back(centre);
  }
  Vec3 mean = Vec3::Zero();
  for (const Vec3& c : centres) mean += c / sections;
  Vec3 covariance = Vec3::Zero();
  double variance = 0;
  for (const Vec3& c : centres) {
    covariance += (c - mean) * (c.z() - mean.z());
    variance += (c.z() - mean.z()) * (c.z() - mean.z());
  }
  slope_ = covariance / variance;
  base_ = mean - mean.z() * slope_;
}

Vec3 Root::position(double angle, double radius, double z) const {
  return base_ + z * slope_ + radius * ray(angle);
}

double Root::angle_of(const Vec3& x) const {
  const Vec3 from_axis = x - base_ - x.z() * slope_;
  return std::atan2(from_axis.y(), from_axis.x());
}

double Root::wall_radius(double angle, double z) const {
  return distance_to_wall(lumen_, base_ + z * slope_, ray(angle));
}

}  // namespace valsalva::mesher
