#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "tissue.hpp"

namespace valsalva::stent {

namespace {

constexpr double pi = std::numbers::pi;

/// A point of the unrolled skirt and the frame node that it is sewn to, or -1.
struct Station {
  double angle, z;
  int frame_node;
};

double turned(double angle, double seam) {
  const double a = std::fmod(angle - seam, 2 * pi);
  return seam + (a < 0 ? a + 2 * pi : a);
}

struct Layout {
  const Crown& crown;
  const Frame& frame;
  const std::array<double, 3>& commissures;
  double edge;

  double top(double angle) const {
    const double from_commissure = turned(angle, commissures[0]) - commissures[0];
    return crown.height(std::fmod(from_commissure, 2 * pi / 3) - pi / 3);
  }

  double distance(const Station& a, const Station& b) const {
    const double r = frame.profile.radius((a.z + b.z) / 2);
    return std::hypot(r * std::remainder(a.angle - b.angle, 2 * pi), a.z - b.z);
  }

  std::vector<Station> along_crown(double reach) const {
    std::vector<Station> stations;
    for (double angle : commissures) stations.push_back({angle, crown.commissure_mm(), -1});
    for (int k = 0; k < 3; ++k) {
      const double middle = commissures[k] + crown.half_angle;
      for (const Stitch& s : stitches_along(crown, frame, middle, reach, 0.5 * edge)) {
        const Station station{middle + s.phi, crown.height(s.phi), s.frame_node};
        const auto same = std::find_if(stations.begin(), stations.end(), [&](const Station& other) {
          return distance(other, station) < 0.4 * edge;
        });
        if (same == stations.end())
          stations.push_back(station);
        else if (same->frame_node < 0)
          same->frame_node = s.frame_node;
      }
    }
    return stations;
  }

  std::vector<Station> crossings(double above, double below_crown) const {
    std::vector<Station> stations;
    for (int i = 0; i < frame.crossings; ++i) {
      const Vec3& x = frame.nodes[i];
      const double angle = std::atan2(x.y(), x.x());
      if (x.z() > above && x.z() < top(angle) - below_crown) stations.push_back({angle, x.z(), i});
    }
    return stations;
  }

  std::vector<Station> at_inflow() const {
    std::vector<Station> stations;
    for (int i = 0; i < frame.crossings; ++i) {
      const Vec3& x = frame.nodes[i];
      if (x.z() <= 0.3 * edge) stations.push_back({std::atan2(x.y(), x.x()), 0.0, i});
    }
    return stations;
  }
};

/// The angle farthest from all stitches: there the unrolled skirt is cut open.
double quietest_seam(const std::vector<std::vector<Station>>& rows) {
  constexpr int candidates = 720;
  double best = 0, widest = -1;
  for (int c = 0; c < candidates; ++c) {
    const double angle = 2 * pi * c / candidates;
    double nearest = 2 * pi;
    for (const auto& row : rows)
      for (const Station& s : row)
        nearest = std::min(nearest, std::abs(std::remainder(s.angle - angle, 2 * pi)));
    if (nearest > widest + 1e-9) widest = nearest, best = angle;
  }
  return best;
}

/// Stations from seam to seam + 2 pi with further points between them, so that none is more than `edge`
/// apart.
template <class Height>
std::vector<Station> filled(std::vector<Station> stations, double seam, const Layout& layout,
                            Height&& height) {
  for (Station& s : stations) s.angle = turned(s.angle, seam);
  stations.push_back({seam, height(seam), -1});
  stations.push_back({seam + 2 * pi, height(seam + 2 * pi), -1});
  std::sort(stations.begin(), stations.end(),
            [](const Station& a, const Station& b) { return a.angle < b.angle; });
  std::vector<Station> all;
  for (std::size_t i = 0; i + 1 < stations.size(); ++i) {
    const double a = stations[i].angle, b = stations[i + 1].angle;
    constexpr int fine = 200;
    std::vector<double> length{0};
    for (int k = 1; k <= fine; ++k) {
      const double p = std::lerp(a, b, (k - 1.0) / fine), q = std::lerp(a, b, static_cast<double>(k) / fine);
      length.push_back(length.back() +
                       std::hypot(layout.frame.profile.radius(height(p)) * (q - p), height(q) - height(p)));
    }
    const int pieces = std::max(1, static_cast<int>(std::ceil(length.back() / layout.edge - 1e-9)));
    all.push_back(stations[i]);
    int k = 0;
    for (int p = 1; p < pieces; ++p) {
      const double wanted = length.back() * p / pieces;
      while (length[k + 1] < wanted) ++k;
      const double angle = std::lerp(a, b, (k + (wanted - length[k]) / (length[k + 1] - length[k])) / fine);
      all.push_back({angle, height(angle), -1});
    }
  }
  all.push_back(stations.back());
  return all;
}

void add_fibres(Tissue& skirt, const TissueDesign& design) {
  for (const Triangle& t : skirt.triangles) {
    const Vec3 &a = skirt.reference[t[0]], &b = skirt.reference[t[1]], &c = skirt.reference[t[2]];
    const Vec3 normal = (b - a).cross(c - a).normalized(), centre = (a + b + c) / 3;
    Vec3 around(-centre.y(), centre.x(), 0);
    around = (around - around.dot(normal) * normal).normalized();
    const Vec3 along = normal.cross(around);
    const auto fibre = [&](double angle) { return Vec3(std::cos(angle) * around + std::sin(angle) * along); };
    skirt.fibre1.push_back(fibre(design.skirt_mean_fibre + design.fibre_half_angle));
    skirt.fibre2.push_back(fibre(design.skirt_mean_fibre - design.fibre_half_angle));
  }
}

}  // namespace

Tissue make_skirt(const Crown& crown, const Frame& frame, const std::array<double, 3>& commissures,
                  const TissueDesign& design) {
  const Layout layout{crown, frame, commissures, design.skirt_edge_mm};
  const std::vector<Station> on_crown = layout.along_crown(design.stitch_reach_mm);
  const std::vector<Station> inside = layout.crossings(0.6 * layout.edge, 0.6 * layout.edge);
  const std::vector<Station> at_inflow = layout.at_inflow();
  const double seam = quietest_seam({on_crown, inside, at_inflow});

  const std::vector<Station> top = filled(on_crown, seam, layout, [&](double a) { return layout.top(a); });
  const std::vector<Station> bottom = filled(at_inflow, seam, layout, [](double) { return 0.0; });
  const double side_height = layout.top(seam);
  const int rows = std::max(1, static_cast<int>(std::ceil(side_height / layout.edge)));

  // Counter-clockwise: inflow, right side up, crown backwards, left side down.
  const Profile surface = skirt_surface(frame, design);
  const double mean_radius = (surface.radius(0) + surface.radius(crown.commissure_mm())) / 2;
  std::vector<Station> stations(bottom.begin(), bottom.end());
  for (int r = 1; r < rows; ++r) stations.push_back({seam + 2 * pi, side_height * r / rows, -1});
  const std::size_t top_first = stations.size();
  stations.insert(stations.end(), top.rbegin(), top.rend());
  const std::size_t left_first = stations.size();
  for (int r = rows - 1; r > 0; --r) stations.push_back({seam, side_height * r / rows, -1});
  const std::size_t boundary_count = stations.size();
  for (Station s : inside) {
    s.angle = turned(s.angle, seam);
    stations.push_back(s);
  }
  std::vector<Vec2> boundary, inner;
  for (std::size_t i = 0; i < stations.size(); ++i)
    (i < boundary_count ? boundary : inner).emplace_back(mean_radius * stations[i].angle, stations[i].z);
  const PlaneMesh plane = mesh_polygon(boundary, inner, layout.edge);

  // The right side is the left side again.
  std::vector<int> number(plane.points.size(), -1);
  const auto join = [&](std::size_t right, std::size_t left) { number[right] = static_cast<int>(left); };
  join(bottom.size() - 1, 0);
  join(top_first, left_first - 1);
  for (int r = 1; r < rows; ++r) join(bottom.size() + r - 1, left_first + (rows - 1 - r));

  Tissue skirt;
  std::vector<int> renumbered(plane.points.size(), -1);
  for (std::size_t i = 0; i < plane.points.size(); ++i) {
    if (number[i] >= 0) continue;
    renumbered[i] = static_cast<int>(skirt.points.size());
    const double angle = plane.points[i].x() / mean_radius, z = plane.points[i].y(), r = surface.radius(z);
    skirt.points.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    const int frame_node = i < stations.size() ? stations[i].frame_node : -1;
    const bool sewn = frame_node >= 0 || (i >= top_first && i < left_first);
    skirt.attached.push_back(sewn ? 1 : 0);
    if (frame_node >= 0) skirt.ties.push_back({renumbered[i], frame_node});
  }
  for (std::size_t i = 0; i < plane.points.size(); ++i)
    if (number[i] >= 0) renumbered[i] = renumbered[number[i]];
  skirt.reference = skirt.points;
  for (const Triangle& t : plane.triangles) {
    skirt.triangles.push_back({renumbered[t[0]], renumbered[t[1]], renumbered[t[2]]});
    skirt.part.push_back(3);
  }
  add_fibres(skirt, design);
  return skirt;
}

}  // namespace valsalva::stent
