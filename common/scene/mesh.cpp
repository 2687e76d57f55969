#include "scene/scene.hpp"

namespace valsalva {

void declare_mesh(Schema& schema) {
  schema.table("mesh", "From the closed lumen surface to surface and wall meshes, and how fine they are");
  schema.real("mesh.surface_edge_mm", {1.5, 1.0, 0.75, 0.5}, {0.2, 5},
              "Edge length of the remeshed lumen surface");
  schema.real("mesh.wall_thickness_mm", 1.0, {0.2, 5},
              "Thickness of the wall (Brown et al. 2022: 1.0 mm); the wall lies outside the lumen");
  schema.integer("mesh.wall_layers", 2, {1, 8}, "Layers of elements through the wall");
  schema.real("mesh.max_hole_perimeter_mm", 15, not_negative(),
              "Holes of the surface up to this perimeter are closed; a longer one is refused with its place");
  schema.real("mesh.leaflet_edge_mm", {0.5, 0.37, 0.25, 0.2}, {0.1, 2},
              "Mean edge length of leaflet meshes: half a fluid cell or less, or the closed valve leaks");
}

}  // namespace valsalva
