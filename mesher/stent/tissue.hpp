// Leaflets and skirt of a device, fitted to its frame.
//
// Skirt: a shell on the surface of revolution just inside the frame, mid-surface at
//   r_skirt = r_frame - depth/2 - thickness/2 - gap,
// from the inflow up to the crown (crown.hpp), so that it closes everything upstream of the leaflets, the
// triangles between them included, and lies nowhere double. Its stress-free shape is this surface.
//
// Leaflets: three flat cut sheets (the stress-free shape, as pericardium is cut), sewn along the crown at
//   r_leaflet = r_skirt - thickness - gap.
// The pattern (u, v) has the crown's own arc length, so that sewing does not stretch its edge:
//   u' = r (1 + e w),   u'^2 + v'^2 = r^2 + (dz/dphi)^2 (1 + (dr/dz)^2),   w = share of the climb in the arc
//   length
// with the width parameter e such that the free edge is (1 + free_edge_excess) thirds of the circumference
// 2 pi r_leaflet at the commissures. Free edge: v = v_commissure + peak cos^2(pi u / width). The mounted
// shape
// (`points`) is found by draping (drape.hpp), half open. Neighbouring leaflets keep thickness + gap apart.
//
// Fibres: two families at +-fibre_half_angle about a mean direction, constant in the leaflet's pattern,
// from the circumference (u) towards the outflow (v); in the skirt the mean is the meridian. Unit, tangent.
// Triangles have their normals outwards from the axis: the aortic side of the leaflets. Lengths mm, angles
// rad.
#pragma once

#include <vector>

#include "crown.hpp"
#include "plane_mesh.hpp"

namespace valsalva::stent {

struct TissueDesign {
  double thickness_mm = 0.34;
  double gap_mm = 0.05;
  double leaflet_edge_mm = 0.5;
  double skirt_edge_mm = 1.0;
  double free_edge_peak_mm = 1.0;
  double free_edge_excess = 0.03;
  double fibre_half_angle = 0;
  double leaflet_mean_fibre = 0;
  double skirt_mean_fibre = 0;
  double stitch_reach_mm = 0.6;  ///< the crown is sewn to frame nodes nearer than this
};

/// One or several shells in one mesh.
struct Tissue {
  Points reference;  ///< stress-free
  Points points;     ///< mounted
  std::vector<Triangle> triangles;
  std::vector<std::int64_t> attached;  ///< per node: 1 on the edge along the crown
  std::vector<std::int64_t> part;      ///< per triangle: leaflet 0, 1, 2; skirt 3
  std::vector<Vec3> fibre1, fibre2;    ///< per triangle, in the reference
  std::vector<Edge> ties;              ///< tissue node, frame node
};

/// The cut pattern of one leaflet.
struct Pattern {
  std::vector<Vec2> boundary;  ///< counter-clockwise: the crown from -60 to 60 degrees, then the free edge
  std::vector<double> phi;     ///< of the crown's vertices, on the crown
  std::vector<int> stitched;   ///< frame node of a crown vertex, or -1
  double width_parameter = 0;  ///< e
  double free_edge_mm = 0;
  double crown_edge_mm = 0;
};

Pattern cut_leaflet(const Crown& crown, const Profile& surface, const std::vector<Stitch>& stitches,
                    const TissueDesign& design);

struct LeafletMeasures {
  double free_edge_mm = 0;
  double free_edge_excess = 0;   ///< over a third of the circumference at the commissures
  double mounting_strain = 0;    ///< largest relative change of an edge's length
  double orifice_radius_mm = 0;  ///< smallest distance of a free edge from the axis
  double smallest_angle_deg = 0;
  double mean_edge_mm = 0, largest_edge_mm = 0;
};

/// `commissures`: ascending angles. Leaflet k lies between commissures k and k + 1.
Tissue make_leaflets(const Crown& crown, const Frame& frame, const std::array<double, 3>& commissures,
                     const TissueDesign& design, LeafletMeasures& measures);

Tissue make_skirt(const Crown& crown, const Frame& frame, const std::array<double, 3>& commissures,
                  const TissueDesign& design);

/// The surface on which the skirt's middle lies, and that of the leaflets' crowns.
Profile skirt_surface(const Frame& frame, const TissueDesign& design);
Profile leaflet_surface(const Frame& frame, const TissueDesign& design);

}  // namespace valsalva::stent
