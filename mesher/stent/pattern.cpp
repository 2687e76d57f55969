#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "crown_path.hpp"
#include "tissue.hpp"

namespace valsalva::stent {

namespace {

constexpr double pi = std::numbers::pi;

/// The free edge from the right commissure to the left, ends included, in steps of about `edge`.
std::vector<Vec2> free_edge_points(const Vec2& right, double peak, double edge) {
  const auto at = [&](double u) {
    const double c = std::cos(pi * u / (2 * right.x()));
    return Vec2(u, right.y() + peak * c * c);
  };
  constexpr int fine = 2000;
  std::vector<double> length{0};
  for (int i = 1; i <= fine; ++i)
    length.push_back(
        length.back() +
        (at(right.x() * (1 - 2.0 * i / fine)) - at(right.x() * (1 - 2.0 * (i - 1) / fine))).norm());
  const int pieces = std::max(2, static_cast<int>(std::ceil(length.back() / edge)));
  std::vector<Vec2> points{right};
  int i = 0;
  for (int p = 1; p < pieces; ++p) {
    const double wanted = length.back() * p / pieces;
    while (length[i + 1] < wanted) ++i;
    const double t = i + (wanted - length[i]) / (length[i + 1] - length[i]);
    points.push_back(at(right.x() * (1 - 2 * t / fine)));
  }
  points.emplace_back(-right.x(), right.y());
  return points;
}

double length_of(const std::vector<Vec2>& line) {
  double sum = 0;
  for (std::size_t i = 1; i < line.size(); ++i) sum += (line[i] - line[i - 1]).norm();
  return sum;
}

}  // namespace

Pattern cut_leaflet(const Crown& crown, const Profile& surface, const std::vector<Stitch>& stitches,
                    const TissueDesign& design) {
  const double third = 2 * pi / 3 * surface.radius(crown.commissure_mm());
  const double inset = design.thickness_mm + design.gap_mm;
  const auto free_edge_at = [&](double e) {
    return length_of(
        free_edge_points(CrownPath(crown, surface, inset, e).end(), design.free_edge_peak_mm, 0.1));
  };
  const double wanted = (1 + design.free_edge_excess) * third;
  double low = -0.9, high = 0.5;
  if (free_edge_at(low) > wanted || free_edge_at(high) < wanted)
    throw InputError(
        "device.free_edge_excess: a free edge of {:.4g} mm ({} over a third of the circumference) cannot be "
        "cut for "
        "this attachment; it allows {:.3g} to {:.3g}",
        wanted, design.free_edge_excess, free_edge_at(low) / third - 1, free_edge_at(high) / third - 1);
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (free_edge_at(middle) < wanted ? low : high) = middle;
  }

  Pattern pattern;
  pattern.width_parameter = (low + high) / 2;
  const CrownPath path(crown, surface, inset, pattern.width_parameter);
  std::vector<std::pair<double, int>> stations{{-crown.half_angle, -1}, {crown.half_angle, -1}};
  for (const Stitch& s : stitches) {
    const auto same = std::find_if(stations.begin(), stations.end(), [&](const auto& station) {
      return std::abs(path.arc(station.first) - path.arc(s.phi)) < 0.5 * design.leaflet_edge_mm;
    });
    if (same != stations.end())
      same->second = s.frame_node;
    else
      stations.emplace_back(s.phi, s.frame_node);
  }
  std::sort(stations.begin(), stations.end());
  for (std::size_t i = 0; i < stations.size(); ++i) {
    pattern.phi.push_back(stations[i].first);
    pattern.stitched.push_back(stations[i].second);
    if (i + 1 == stations.size()) break;
    const double from = path.arc(stations[i].first), to = path.arc(stations[i + 1].first);
    const int pieces = std::max(1, static_cast<int>(std::ceil((to - from) / design.leaflet_edge_mm - 1e-9)));
    for (int p = 1; p < pieces; ++p) {
      pattern.phi.push_back(path.phi_at_arc(from + (to - from) * p / pieces));
      pattern.stitched.push_back(-1);
    }
  }
  for (double phi : pattern.phi) pattern.boundary.push_back(path.flat(phi));
  pattern.crown_edge_mm = length_of(pattern.boundary);
  const std::vector<Vec2> free =
      free_edge_points(pattern.boundary.back(), design.free_edge_peak_mm, design.leaflet_edge_mm);
  pattern.free_edge_mm = length_of(free);
  pattern.boundary.insert(pattern.boundary.end(), free.begin() + 1, free.end() - 1);
  return pattern;
}

}  // namespace valsalva::stent
