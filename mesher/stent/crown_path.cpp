#include "crown_path.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::stent {

namespace {
constexpr int samples = 4000;
}

CrownPath::CrownPath(const Crown& crown, const Profile& surface, double inset_mm, double e)
    : crown_(crown),
      surface_(surface),
      shrink_(1 - inset_mm / 2 / (surface.radius(crown.commissure_mm()) * crown.half_angle)),
      arc_{0},
      u_{0},
      v_{0} {
  for (int i = 1; i <= samples; ++i) {
    const double phi0 = crown.half_angle * (i - 1) / samples, phi1 = crown.half_angle * i / samples;
    const double z0 = crown.height(phi0), z1 = crown.height(phi1);
    const double across = surface.radius((z0 + z1) / 2) * (phi1 - phi0) * shrink_;
    const double climb2 = std::pow(z1 - z0, 2) + std::pow(surface.radius(z1) - surface.radius(z0), 2);
    const double arc2 = across * across + climb2;
    const double u = across * (1 + e * climb2 / arc2);
    arc_.push_back(arc_.back() + std::sqrt(arc2));
    u_.push_back(u_.back() + u);
    v_.push_back(v_.back() + std::sqrt(std::max(0.0, arc2 - u * u)));
  }
}

double CrownPath::sampled(const std::vector<double>& values, double phi) const {
  const double at = std::min(std::abs(phi) / crown_.half_angle, 1.0) * samples;
  const int i = std::min(static_cast<int>(at), samples - 1);
  return std::lerp(values[i], values[i + 1], at - i);
}

double CrownPath::inverse(const std::vector<double>& values, double wanted) {
  const auto above = std::upper_bound(values.begin() + 1, values.end() - 1, wanted);
  const auto i = above - values.begin() - 1;
  return (static_cast<double>(i) + std::clamp((wanted - values[i]) / (values[i + 1] - values[i]), 0.0, 1.0)) /
         samples;
}

double CrownPath::arc(double phi) const {
  return arc_.back() + std::copysign(sampled(arc_, phi), phi);
}

double CrownPath::phi_at_arc(double arc_mm) const {
  const double from_middle = arc_mm - arc_.back();
  return std::copysign(crown_.half_angle * inverse(arc_, std::abs(from_middle)), from_middle);
}

Vec2 CrownPath::flat(double phi) const {
  return {std::copysign(sampled(u_, phi), phi), sampled(v_, phi)};
}

double CrownPath::phi_at_u(double u) const {
  return std::copysign(crown_.half_angle * inverse(u_, std::abs(u)), u);
}

Vec3 CrownPath::mounted(double phi) const {
  const double z = crown_.height(phi), r = surface_.radius(z), angle = mounted_angle(phi);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace valsalva::stent
