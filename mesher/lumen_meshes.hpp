// Lumen surface and wall of an anatomy: repaired, cut plane, remeshed, and grown to tetrahedra.
#pragma once

#include <string>
#include <vector>

#include "anatomy_state.hpp"
#include "geometry/quality.hpp"
#include "geometry/surface.hpp"

namespace valsalva::mesher {

struct LumenOptions {
  double surface_edge_mm = 1;
  double wall_thickness_mm = 1;
  int wall_layers = 2;
  double max_hole_perimeter_mm = 15;
};

struct LumenMeshes {
  geometry::TriMesh lumen;  ///< closed
  geometry::TetMesh wall;   ///< open at both cuts
  std::vector<std::int64_t>
      wall_region;  ///< a tetrahedron: 0 below the annulus plane, 1 sinuses, 2 above the junction
  std::vector<std::string> repairs;
  int thinned_nodes = 0;  ///< outer wall nodes nearer than the thickness (folds)
  geometry::TetQuality quality;
  double lumen_volume_error_pct = 0;  ///< against the level set between the same planes
  double wall_volume_error_pct = 0;
};

/// The cut planes lie one grid spacing inside segment's, so that both rims are plane.
LumenMeshes mesh_lumen(const AnatomyState& anatomy, const LumenOptions& options, const std::string& name);

}  // namespace valsalva::mesher
