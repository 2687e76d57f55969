#include "scene/scene.hpp"

namespace valsalva {

void declare_fluid(Schema& schema) {
  schema.table("fluid",
               "Blood, and the uniform staggered grid it is solved on; without this table there is no fluid");
  schema.real("fluid.spacing_mm", {1.0, 0.75, 0.5, 0.39}, {0.05, 5}, "Cell size, the same in all directions");
  schema.real("fluid.density_g_per_mm3", 1.0e-3, {1e-4, 1e-1}, "Density (blood 1.0e-3, saline 1.0e-3)");
  schema.real("fluid.viscosity_Pa_s", 3.5e-3, {0, 10}, "Viscosity (blood 3.5e-3, saline about 0.9e-3)");
  schema.choice(
      "fluid.convection", "upwind3", {"upwind3", "centred4", "centred2"},
      "Third-order upwind-biased convection, or fourth- or second-order centred without dissipation");
  schema.real(
      "fluid.penalisation_s", 1e-8, {1e-12, 1e-5},
      "Time constant of solid faces; a solid lets velocity penalisation/density x pressure gradient through");
  schema.real("fluid.margin_cells", 2, {1, 50}, "Cells between the lumen and the sides of the box");
}

}  // namespace valsalva
