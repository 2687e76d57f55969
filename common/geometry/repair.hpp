// Makes a closed, outward, manifold surface free of self-intersections out of a raw one, or says why not.
//
// Repaired, and said in `actions`: coincident vertices (within 1e-4 of the mean edge), doubled and degenerate
// triangles, fins (triangles on an edge that already has two, with a free edge of their own), flipped
// triangles, surfaces inside out, vertices where two fans touch, splinters below 1 % of the area, holes up to
// a given perimeter, local self-intersections as long as the volume changes by less than 1 %. Refused with
// the place (InputError): values that are not finite, larger holes, edges with three or more sheets, several
// large pieces, self-intersections that local repair does not remove.
#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.hpp"

namespace valsalva::geometry {

struct RepairLimits {
  double max_hole_perimeter_mm = 15;
  double max_splinter_area_fraction = 0.01;
  double max_volume_change_fraction = 0.01;
};

struct RepairedSurface {
  TriMesh mesh;
  std::vector<std::string> actions;  ///< one line a repair; empty when the surface was sound
};

/// name: what the surface is called in messages, for instance "lumen of state_000000.h5".
RepairedSurface repair_closed_surface(const TriMesh& raw, const RepairLimits& limits,
                                      const std::string& name);

}  // namespace valsalva::geometry
