#include "lumen_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/errors.hpp"
#include "geometry/remesh.hpp"
#include "geometry/repair.hpp"
#include "geometry/surface_cut.hpp"
#include "geometry/tetrahedralise.hpp"

namespace valsalva::mesher {
namespace {

double error_pct(double value, double expected) {
  return 100 * std::abs(value / expected - 1);
}

std::vector<std::int64_t> regions(const geometry::TetMesh& wall, double junction_z) {
  std::vector<std::int64_t> region;
  for (const auto& t : wall.tetrahedra) {
    double z = 0;
    for (int node : t) z += wall.points[node].z() / 4;
    region.push_back(z < 0 ? 0 : z < junction_z ? 1 : 2);
  }
  return region;
}

}  // namespace

LumenMeshes mesh_lumen(const AnatomyState& anatomy, const LumenOptions& options, const std::string& name) {
  const auto repaired =
      geometry::repair_closed_surface(anatomy.surface, {options.max_hole_perimeter_mm}, name);
  double bottom = std::numeric_limits<double>::infinity(), top = -bottom;
  for (const Vec3& p : repaired.mesh.points) {
    bottom = std::min(bottom, p.z());
    top = std::max(top, p.z());
  }
  const double low = std::max(bottom, anatomy.lower_cut_mm) + anatomy.lumen.spacing;
  const double high = std::min(top, anatomy.upper_cut_mm) - anatomy.lumen.spacing;
  if (low >= high)
    throw InputError(
        "{}: the surface spans z = {:.2f} to {:.2f} mm, the cut planes {:.2f} to {:.2f} mm; expected overlap",
        name, bottom, top, anatomy.lower_cut_mm, anatomy.upper_cut_mm);

  LumenMeshes meshes;
  meshes.repairs = repaired.actions;
  const auto cut = geometry::without_caps(geometry::cut_closed_between(repaired.mesh, low, high), low, high);
  geometry::RemeshOptions smooth_rims;
  smooth_rims.edge_mm = options.surface_edge_mm;
  smooth_rims.corner_angle_deg = 180;
  // Ears that remeshing leaves on a rim lie in its plane like a cap.
  const auto open = geometry::without_caps(geometry::remesh(cut, smooth_rims), low, high);
  meshes.lumen = geometry::closed_by_caps(open, options.surface_edge_mm);
  auto wall =
      geometry::tetrahedral_wall(open, anatomy.lumen, {options.wall_thickness_mm, options.wall_layers});
  meshes.wall = std::move(wall.mesh);
  meshes.thinned_nodes = wall.thinned_nodes;
  meshes.wall_region = regions(meshes.wall, anatomy.junction_mm);
  meshes.quality = geometry::quality_of(meshes.wall);

  constexpr double deepest = -std::numeric_limits<double>::infinity();
  meshes.lumen_volume_error_pct = error_pct(geometry::enclosed_volume(meshes.lumen),
                                            geometry::level_set_volume(anatomy.lumen, deepest, 0, low, high));
  meshes.wall_volume_error_pct =
      error_pct(meshes.quality.volume_mm3,
                geometry::level_set_volume(anatomy.lumen, 0, options.wall_thickness_mm, low, high));
  return meshes;
}

}  // namespace valsalva::mesher
