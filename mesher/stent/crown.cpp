#include "crown.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::stent {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double roundest = 4;  // the largest exponent of the bottom

/// In (-pi, pi].
double wrapped(double angle) {
  return std::remainder(angle, 2 * pi);
}

double exponent_below(const Crown& crown) {
  const auto [phi, z] = crown.struts[0];
  const auto [next_phi, next_z] = crown.struts[1];
  return (next_z - z) / (next_phi - phi) * phi / (z - crown.nadir_mm);
}

}  // namespace

double Crown::height(double phi) const {
  const double p = std::min(std::abs(phi), half_angle);
  if (p <= struts.front().first)
    return nadir_mm + (struts.front().second - nadir_mm) * std::pow(p / struts.front().first, exponent);
  std::size_t i = 1;
  while (i + 1 < struts.size() && p > struts[i].first) ++i;
  const auto [p0, z0] = struts[i - 1];
  const auto [p1, z1] = struts[i];
  return z0 + (z1 - z0) * (p - p0) / (p1 - p0);
}

Crown crown_of_rows(const FrameDesign& design, double nadir_mm, double commissure_mm) {
  if (design.cells % 3 != 0)
    throw InputError(
        "device.cells: {} cells around do not suit three leaflets; expected a multiple of 3, or "
        "device.tissue = false",
        design.cells);
  int row = 0;
  const auto& level = design.level_mm;
  for (int i = 0; i < static_cast<int>(level.size()); ++i)
    if (std::abs(level[i] - commissure_mm) < std::abs(level[row] - commissure_mm)) row = i;
  if (std::abs(level[row] - commissure_mm) > 0.5)
    throw InputError("device.commissure_height_mm: {} mm is no row of strut crossings; the nearest is {} mm",
                     commissure_mm, level[row]);
  if (!(nadir_mm > 0 && nadir_mm < level[row] - 1))
    throw InputError(
        "device.nadir_height_mm: {} mm; expected between 0 and the commissures at {} mm, less 1 mm", nadir_mm,
        level[row]);
  const double half_pitch = pi / design.cells;
  const int half_pitches = design.cells / 3;

  Crown crown;
  crown.nadir_mm = nadir_mm;
  crown.half_angle = pi / 3;
  crown.struts = {{pi / 3, level[row]}};
  for (int j = 1; j < half_pitches && j <= row && level[row - j] > nadir_mm; ++j) {
    Crown longer = crown;
    longer.struts.insert(longer.struts.begin(), {(half_pitches - j) * half_pitch, level[row - j]});
    longer.exponent = exponent_below(longer);
    if (longer.exponent > roundest) break;
    crown = longer;
  }
  return crown;
}

Crown crown_without_rows(double nadir_mm, double commissure_mm) {
  if (!(nadir_mm >= 0 && nadir_mm < commissure_mm - 1))
    throw InputError(
        "device.nadir_height_mm: {} mm; expected between 0 and the commissures at {} mm, less 1 mm", nadir_mm,
        commissure_mm);
  Crown crown;
  crown.nadir_mm = nadir_mm;
  crown.half_angle = pi / 3;
  crown.struts = {{pi / 3, commissure_mm}};
  return crown;
}

std::array<double, 3> commissure_angles(const Frame& frame, double commissure_mm) {
  int best = 0;
  for (int i = 1; i < frame.crossings; ++i)
    if (std::abs(frame.nodes[i].z() - commissure_mm) < std::abs(frame.nodes[best].z() - commissure_mm) - 1e-9)
      best = i;
  const Vec3& node = frame.nodes[best];
  if (std::abs(node.z() - commissure_mm) > 2)
    throw InputError(
        "device.commissure_height_mm: no strut crossing within 2 mm of {} mm (the nearest is at {:.4g} mm)",
        commissure_mm, node.z());
  const double first = std::fmod(std::atan2(node.y(), node.x()) + 2 * pi, 2 * pi / 3);
  return {first, first + 2 * pi / 3, first + 4 * pi / 3};
}

std::vector<Stitch> stitches_along(const Crown& crown, const Frame& frame, double middle, double reach_mm,
                                   double spacing_mm) {
  const auto phi_of = [&](int node) {
    return wrapped(std::atan2(frame.nodes[node].y(), frame.nodes[node].x()) - middle);
  };
  const auto radius_of = [&](int node) { return std::hypot(frame.nodes[node].x(), frame.nodes[node].y()); };
  std::vector<Stitch> found;

  constexpr int samples = 1200;
  for (int node = 0; node < static_cast<int>(frame.nodes.size()); ++node) {
    const double phi = phi_of(node), z = frame.nodes[node].z(), r = radius_of(node);
    Stitch nearest{node, 0, 1e30};
    for (int i = -samples; i <= samples; ++i) {
      const double p = crown.half_angle * i / samples;
      const double distance = std::hypot(r * (p - phi), crown.height(p) - z);
      if (distance < nearest.distance_mm) nearest = {node, p, distance};
    }
    if (nearest.distance_mm <= reach_mm) found.push_back(nearest);
  }
  for (const auto& [a, b] : frame.beams) {
    const double pa = phi_of(a), pb = phi_of(b);
    if (std::max(std::abs(pa), std::abs(pb)) > crown.half_angle + 1e-9) continue;
    const double ga = frame.nodes[a].z() - crown.height(pa), gb = frame.nodes[b].z() - crown.height(pb);
    if (ga * gb >= 0) continue;
    const double t = ga / (ga - gb);
    const int node = t < 0.5 ? a : b;
    const double length = (frame.nodes[b] - frame.nodes[a]).norm();
    found.push_back({node, pa + t * (pb - pa), length * std::min(t, 1 - t)});
  }

  // The nearer stitch wins; equal ones in the order of the frame's nodes.
  std::stable_sort(found.begin(), found.end(),
                   [](const Stitch& a, const Stitch& b) { return a.distance_mm < b.distance_mm - 1e-9; });
  std::vector<Stitch> kept;
  const double r = frame.profile.radius(crown.nadir_mm);
  for (const Stitch& s : found) {
    const bool free = std::all_of(kept.begin(), kept.end(), [&](const Stitch& k) {
      return k.frame_node != s.frame_node &&
             std::hypot(r * (k.phi - s.phi), crown.height(k.phi) - crown.height(s.phi)) > spacing_mm;
    });
    if (free) kept.push_back(s);
  }
  std::sort(kept.begin(), kept.end(), [](const Stitch& a, const Stitch& b) { return a.phi < b.phi; });
  return kept;
}

}  // namespace valsalva::stent
