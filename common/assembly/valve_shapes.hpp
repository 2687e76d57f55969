// Sheets of an idealised trileaflet valve in a tube along the third axis of a frame: a leaflet, and the
// scallop of the crown (stent) below it; posts between scallops are patches of a cylinder.
//
// s in [-1, 1] goes over a leaflet, the azimuth being s half_angle. The attachment lies on the tube,
//   z(s) = height |s|^exponent,
// and ends in straight commissures of length `post` above it. The free edge runs from commissure to
// commissure on a circle that bows inwards to `gap` from the axis, or with edge_exponent p > 0 on
//   r(s) = radius - (radius - gap) cos^p(pi s/2),
// which follows the tube beside the commissures and is longer; it rises by `peak` in its middle. The leaflet
// is ruled between both: stress-free and half open, with a free edge longer than the chord, as tissue valves
// have. Lengths mm.
#pragma once

#include "assembly/generate.hpp"

namespace valsalva::assembly {

struct ValveShape {
  double radius = 0, height = 0, post = 0;
  double gap = 0, peak = 0;
  double exponent = 2;
  double edge_exponent = 0;
  double half_angle_deg = 60;  ///< less than 60 leaves room for posts
  double base = 0;             ///< of the crown, below the attachment's lowest point
  double wall = 0;             ///< of solids: thickness towards the aorta (leaflet), outwards (crown)
};

/// InputError with `what` when the numbers make no valve.
void check_valve(const ValveShape& valve, const std::string& what);

/// Grid: s over `part` (within -1 and 1), from attachment to free edge, through the wall. The normal points
/// to the aorta.
Map leaflet_map(const Frame& frame, const ValveShape& valve, std::array<double, 2> part);

/// Grid: s over `part`, from the base to the attachment, through the wall. The normal points outwards.
Map crown_map(const Frame& frame, const ValveShape& valve, std::array<double, 2> part);

}  // namespace valsalva::assembly
