// The crown: the curve on the frame along which a leaflet is sewn, and where stitches can be made.
//
// Over the angle phi from the leaflet's middle (nadir, phi = 0) to a commissure (phi = 60 degrees): from the
// commissure down it runs along struts, crossing by crossing; below the crossing (phi_J, z_J) it is round,
//   z = z_nadir + (z_J - z_nadir) (|phi| / phi_J)^q,     q = (dz/dphi at phi_J) phi_J / (z_J - z_nadir),
// which continues the strut's slope. J is the largest number of struts for which q <= 4, so that the bottom
// has no corner. A frame without rows (graph file) has no known struts: then phi_J is the commissure and q
// = 3.
//
// Stitches: where the crown crosses a strut, or passes within `reach_mm` of a frame node, the tissue is sewn
// to that node. Between stitches the edge is free to fold. Tissue sewn to a node far away would swing out of
// the frame when it closes, because ties keep their offset; hence stitches only where strut and crown meet.
#pragma once

#include <utility>
#include <vector>

#include "frame.hpp"

namespace valsalva::stent {

struct Crown {
  double nadir_mm = 0;
  double half_angle = 0;                          ///< rad, to the commissure
  double exponent = 3;                            ///< q
  std::vector<std::pair<double, double>> struts;  ///< (phi, z) ascending from (phi_J, z_J) to the commissure

  double commissure_mm() const { return struts.back().second; }
  double height(double phi) const;
};

/// InputError when the cells are not a multiple of 3, the commissures are not at a row of crossings (within
/// 0.5 mm) or the nadir is not below them.
Crown crown_of_rows(const FrameDesign& design, double nadir_mm, double commissure_mm);
Crown crown_without_rows(double nadir_mm, double commissure_mm);

/// Angles of the three commissures, ascending in [0, 2 pi): crossings at the commissure height.
/// InputError when there is no crossing within 2 mm of that height.
std::array<double, 3> commissure_angles(const Frame& frame, double commissure_mm);

struct Stitch {
  int frame_node = 0;
  double phi = 0;          ///< where the crown is sewn
  double distance_mm = 0;  ///< on the surface, from there to the node
};

/// Of the leaflet whose middle stands at `middle` rad, ascending in phi; at most one a frame node, none
/// closer together than `spacing_mm`.
std::vector<Stitch> stitches_along(const Crown& crown, const Frame& frame, double middle, double reach_mm,
                                   double spacing_mm);

}  // namespace valsalva::stent
