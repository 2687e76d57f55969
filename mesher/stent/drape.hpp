// Form finding: how a flat cut sheet hangs when its edge is sewn to the crown.
//
// The sheet keeps its lengths: every triangle edge is a spring of unit relative stiffness, E = 1/2 (l - L)^2
// / L, and the line across every inner edge, between the two opposite corners, a spring softer by `bending`,
// which flattens. Sewn nodes are held. The sheet stays inside the surface of revolution r <= profile(z) and
// on its own side of the two planes through the axis that bound its sector, at `clearance_mm` from them
// (penalties of the springs' order). Minimum by FIRE (Bitzek, Koskinen, Gaehler, Moseler and Gumbsch 2006,
// Phys. Rev. Lett. 97:170201) from the given start. The result is a position, not a stress state: the
// stress-free shape is the flat pattern. Lengths mm.
#pragma once

#include <vector>

#include "core/types.hpp"
#include "profile.hpp"

namespace valsalva::stent {

struct DrapeSettings {
  double bending = 0.05;    ///< stiffness across an edge relative to that along it
  double clearance_mm = 0;  ///< from the planes that bound the sector
  double half_angle = 0;    ///< of the sector about +x, rad
  double tolerance = 1e-5;  ///< largest force at rest, in units of edge length times stiffness
  int most_iterations = 20000;
};

struct Draped {
  Points points;
  int iterations = 0;
  double largest_edge_strain = 0;  ///< max |l/L - 1|
};

/// `start`: the positions of all nodes; those with held[i] stay. NumericalFailure when the positions do not
/// settle.
Draped drape(const Points& flat, const std::vector<Triangle>& triangles, const std::vector<bool>& held,
             Points start, const Profile& inside, const DrapeSettings& settings);

}  // namespace valsalva::stent
