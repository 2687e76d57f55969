#include "native_leaflets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/errors.hpp"
#include "geometry/remesh.hpp"
#include "geometry/surface.hpp"

namespace valsalva::mesher {
namespace {

constexpr int line_samples = 600;
constexpr double commissure_reach =
    0.06;  ///< of the annulus diameter: where the fibre potential is prescribed

double distance_to_line(const Vec3& x, const Points& line) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vec3 along = line[i] - line[i - 1];
    const double f =
        std::clamp((x - line[i - 1]).dot(along) / std::max(along.squaredNorm(), 1e-30), 0.0, 1.0);
    least = std::min(least, (x - line[i - 1] - f * along).norm());
  }
  return least;
}

/// Samples crowd towards both ends, where crown and free edge turn most.
template <class Curve>
Points sampled_line(Curve&& curve) {
  Points line;
  for (int i = 0; i <= line_samples; ++i)
    line.push_back(curve(-std::cos(std::numbers::pi * i / line_samples)));
  return line;
}

void move_to_level(Vec3& x, const geometry::GridSdf& phi, double level) {
  for (int newton = 0; newton < 6; ++newton) {
    const Vec3 slope = phi.gradient(x);
    if (slope.squaredNorm() < 1e-6) return;
    x += (level - phi.value(x)) / slope.squaredNorm() * slope;
  }
}

struct Leaflet {
  geometry::TriMesh mesh;
  std::vector<int> attached;
  std::vector<double> from_attachment, thickness_mm, potential;
  double free_edge_mm = 0;
};

Leaflet mesh_leaflet(const LeafletShape& shape, const LeafletProportions& p, const ThicknessMap& map,
                     double edge_mm, const geometry::GridSdf& phi) {
  const Points attachment = sampled_line([&](double u) { return shape.attachment(u); });
  const Points edge = sampled_line([&](double u) { return shape.free_edge(u); });
  const int across = std::max(40, int(std::ceil(4 * shape.sizes().free_edge_mm / edge_mm)));
  const int along = std::max(12, int(std::ceil(1.5 * shape.sizes().length_mm / edge_mm)));

  Leaflet leaflet;
  leaflet.mesh = geometry::remesh(shape.sampled(across, along), {edge_mm, 180, 60, 12});
  auto& points = leaflet.mesh.points;
  leaflet.attached.assign(points.size(), 0);
  for (const auto& loop : geometry::border_loops(leaflet.mesh)) {
    for (int node : loop)
      leaflet.attached[node] =
          distance_to_line(points[node], attachment) < distance_to_line(points[node], edge) + 1e-6;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const int a = loop[k], b = loop[(k + 1) % loop.size()];
      if (!(leaflet.attached[a] && leaflet.attached[b]))
        leaflet.free_edge_mm += (points[a] - points[b]).norm();
    }
  }
  const Vec3 nodule = shape.free_edge(0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (leaflet.attached[i]) move_to_level(points[i], phi, p.attachment_inset_mm);
    const double s = leaflet.attached[i] ? 0 : distance_to_line(points[i], attachment);
    const double r = (points[i] - nodule).norm();
    const auto fade = [](double distance, double width) {
      return std::exp(-(distance / width) * (distance / width));
    };
    leaflet.from_attachment.push_back(s);
    leaflet.thickness_mm.push_back(map.belly_mm +
                                   (map.nodule_mm - map.belly_mm) * fade(r, map.nodule_radius_mm) +
                                   (map.rim_mm - map.belly_mm) * fade(s, map.rim_width_mm));
  }

  std::vector<double> known(points.size(), -1);
  const double reach = std::max(1.5 * edge_mm, commissure_reach * p.annulus_diameter_mm);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!leaflet.attached[i]) continue;
    if ((points[i] - attachment.front()).norm() < reach) known[i] = 0;
    if ((points[i] - attachment.back()).norm() < reach) known[i] = 1;
  }
  leaflet.potential = harmonic(leaflet.mesh, known);
  return leaflet;
}

std::array<double, 3> sorted_angles(std::array<double, 3> angles) {
  const double turn = 2 * std::numbers::pi;
  for (double& a : angles) a -= turn * std::floor(a / turn);
  std::sort(angles.begin(), angles.end());
  for (int k = 0; k < 3; ++k) {
    const double width = (k < 2 ? angles[k + 1] : angles[0] + turn) - angles[k];
    if (width < std::numbers::pi / 3 || width > std::numbers::pi)
      throw InputError(
          "anatomy/commissure_angles_rad: neighbouring commissures {:.0f} degrees apart; expected 60 to 180: "
          "correct the "
          "commissures in [anatomy]",
          width * 180 / std::numbers::pi);
  }
  return angles;
}

}  // namespace

NativeValve fit_native_valve(const Root& root, const LeafletProportions& proportions,
                             const ThicknessMap& thickness, std::array<double, 3> commissure_angles,
                             double edge_mm, double fibre_angle_deg, const geometry::GridSdf& lumen) {
  const auto angles = sorted_angles(commissure_angles);
  NativeValve valve;
  valve.least_clearance_mm = std::numeric_limits<double>::infinity();
  std::vector<double> potential;
  for (int k = 0; k < 3; ++k) {
    const double to = k < 2 ? angles[k + 1] : angles[0] + 2 * std::numbers::pi;
    const LeafletShape shape(root, proportions, angles[k], to);
    const Leaflet leaflet = mesh_leaflet(shape, proportions, thickness, edge_mm, lumen);
    valve.sizes[k] = shape.sizes();
    valve.length_mm[k] = shape.straight_length_mm();
    valve.mid_radius_mm[k] = root.radius_of(shape.free_edge(0));
    valve.free_edge_mm[k] = leaflet.free_edge_mm;
    valve.gauss_curvature_sr[k] = geometry::total_gauss_curvature(leaflet.mesh);

    const int offset = static_cast<int>(valve.mesh.points.size());
    for (std::size_t i = 0; i < leaflet.mesh.points.size(); ++i) {
      const double phi = lumen.value(leaflet.mesh.points[i]);
      if (leaflet.attached[i])
        valve.attachment_error_mm =
            std::max(valve.attachment_error_mm, std::abs(phi - proportions.attachment_inset_mm));
      else if (leaflet.from_attachment[i] > 2)
        valve.least_clearance_mm = std::min(valve.least_clearance_mm, -phi);
    }
    for (const Triangle& t : leaflet.mesh.triangles) {
      valve.mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
      valve.leaflet.push_back(k);
    }
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append(valve.mesh.points, leaflet.mesh.points);
    append(valve.attached, leaflet.attached);
    append(valve.thickness_mm, leaflet.thickness_mm);
    append(potential, leaflet.potential);
  }
  valve.fibres = fibre_families(valve.mesh, potential, fibre_angle_deg);
  return valve;
}

}  // namespace valsalva::mesher
