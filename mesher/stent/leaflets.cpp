#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "crown_path.hpp"
#include "drape.hpp"
#include "tissue.hpp"

namespace valsalva::stent {

namespace {

constexpr double pi = std::numbers::pi;

/// One leaflet with its middle towards +x.
struct Leaflet {
  Pattern pattern;
  PlaneMesh flat;
  Points reference, points;
  double mounting_strain = 0;
};

/// The start of draping: every generator of the unrolled crown leans inwards, at the free edge by
/// `lean` r cos^2(3 phi / 2).
Points leaning_start(const CrownPath& path, const Profile& surface, const PlaneMesh& flat, double peak) {
  constexpr double lean = 0.6;
  const Vec2 end = path.end();
  Points start;
  for (const Vec2& p : flat.points) {
    const double phi = path.phi_at_u(p.x());
    const Vec3 root = path.mounted(phi);
    const double c = std::cos(pi * p.x() / (2 * end.x()));
    const double bottom = path.flat(phi).y(), whole = end.y() + peak * c * c - bottom;
    const double r_root = std::hypot(root.x(), root.y());
    const double r_edge = surface.radius(root.z() + whole) * (1 - lean * c * c);
    const double sine = whole > 1e-9 ? std::clamp((r_root - r_edge) / whole, -0.5, 0.8) : 0.0;
    const double s = std::max(0.0, p.y() - bottom), r = r_root - s * sine;
    const double angle = path.mounted_angle(phi);
    start.emplace_back(r * std::cos(angle), r * std::sin(angle), root.z() + s * std::sqrt(1 - sine * sine));
  }
  return start;
}

Leaflet make_leaflet(const Crown& crown, const Profile& surface, const std::vector<Stitch>& stitches,
                     const TissueDesign& design) {
  Leaflet leaflet;
  leaflet.pattern = cut_leaflet(crown, surface, stitches, design);
  leaflet.flat = mesh_polygon(leaflet.pattern.boundary, {}, design.leaflet_edge_mm);
  const double inset = design.thickness_mm + design.gap_mm;
  const CrownPath path(crown, surface, inset, leaflet.pattern.width_parameter);
  const double plane = surface.radius(crown.nadir_mm);
  for (const Vec2& p : leaflet.flat.points)
    leaflet.reference.emplace_back(plane, p.x(), crown.nadir_mm + p.y());

  Points start = leaning_start(path, surface, leaflet.flat, design.free_edge_peak_mm);
  std::vector<bool> held(start.size(), false);
  for (std::size_t i = 0; i < leaflet.pattern.phi.size(); ++i) {
    start[i] = path.mounted(leaflet.pattern.phi[i]);
    held[i] = true;
  }
  DrapeSettings settings;
  settings.half_angle = crown.half_angle;
  settings.clearance_mm = inset / 2;
  const Draped draped =
      drape(leaflet.reference, leaflet.flat.triangles, held, std::move(start), surface, settings);
  leaflet.points = draped.points;
  leaflet.mounting_strain = draped.largest_edge_strain;
  return leaflet;
}

void measure_leaflet(const Leaflet& leaflet, double third, LeafletMeasures& m) {
  m.free_edge_mm = std::max(m.free_edge_mm, leaflet.pattern.free_edge_mm);
  m.free_edge_excess = leaflet.pattern.free_edge_mm / third - 1;
  m.mounting_strain = std::max(m.mounting_strain, leaflet.mounting_strain);
  for (std::size_t i = leaflet.pattern.phi.size() - 1; i < leaflet.pattern.boundary.size(); ++i)
    m.orifice_radius_mm =
        std::min(m.orifice_radius_mm, std::hypot(leaflet.points[i].x(), leaflet.points[i].y()));
  m.smallest_angle_deg =
      std::min(m.smallest_angle_deg, smallest_angle_deg(leaflet.flat.points, leaflet.flat.triangles));
  double sum = 0;
  for (const Triangle& t : leaflet.flat.triangles)
    for (int c = 0; c < 3; ++c) {
      const double edge = (leaflet.reference[t[c]] - leaflet.reference[t[(c + 1) % 3]]).norm();
      sum += edge / 3;
      m.largest_edge_mm = std::max(m.largest_edge_mm, edge);
    }
  m.mean_edge_mm = sum / static_cast<double>(leaflet.flat.triangles.size());
}

}  // namespace

Profile skirt_surface(const Frame& frame, const TissueDesign& design) {
  return frame.profile.offset(frame.max_depth_mm / 2 + design.thickness_mm / 2 + design.gap_mm,
                              "the skirt inside the frame");
}

Profile leaflet_surface(const Frame& frame, const TissueDesign& design) {
  return skirt_surface(frame, design)
      .offset(design.thickness_mm + design.gap_mm, "the leaflets inside the skirt");
}

Tissue make_leaflets(const Crown& crown, const Frame& frame, const std::array<double, 3>& commissures,
                     const TissueDesign& design, LeafletMeasures& measures) {
  const Profile surface = leaflet_surface(frame, design);
  measures = {};
  measures.orifice_radius_mm = 1e30;
  measures.smallest_angle_deg = 180;
  Tissue all;
  Leaflet leaflet;
  std::vector<double> last;
  for (int k = 0; k < 3; ++k) {
    const double middle = commissures[k] + crown.half_angle;
    std::vector<Stitch> stitches =
        stitches_along(crown, frame, middle, design.stitch_reach_mm, 0.6 * design.leaflet_edge_mm);
    std::vector<double> where;
    for (Stitch& s : stitches) where.push_back(s.phi = std::round(s.phi * 1e9) / 1e9);
    if (where == last)  // the same cut: only other frame nodes
      leaflet.pattern = cut_leaflet(crown, surface, stitches, design);
    else
      leaflet = make_leaflet(crown, surface, stitches, design);
    last = where;
    measure_leaflet(leaflet, 2 * pi / 3 * surface.radius(crown.commissure_mm()), measures);

    const int first = static_cast<int>(all.points.size());
    const Eigen::AngleAxisd turn(middle, Vec3::UnitZ());
    const std::size_t sewn = leaflet.pattern.phi.size();
    for (std::size_t i = 0; i < leaflet.points.size(); ++i) {
      all.reference.push_back(turn * leaflet.reference[i]);
      all.points.push_back(turn * leaflet.points[i]);
      all.attached.push_back(i < sewn ? 1 : 0);
      if (i < sewn && leaflet.pattern.stitched[i] >= 0)
        all.ties.push_back({first + static_cast<int>(i), leaflet.pattern.stitched[i]});
    }
    const auto fibre = [&](double angle) { return Vec3(turn * Vec3(0, std::cos(angle), std::sin(angle))); };
    for (const Triangle& t : leaflet.flat.triangles) {
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      all.part.push_back(k);
      all.fibre1.push_back(fibre(design.leaflet_mean_fibre + design.fibre_half_angle));
      all.fibre2.push_back(fibre(design.leaflet_mean_fibre - design.fibre_half_angle));
    }
  }
  return all;
}

}  // namespace valsalva::stent
