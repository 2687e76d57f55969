#include "scene/scene.hpp"

namespace valsalva {

void declare_fluid(Schema& schema) {
  schema.table("fluid",
               "Blood, and the uniform staggered grid it is solved on; without this table there is no fluid");
  schema.real("fluid.spacing_mm", {1.0, 0.75, 0.5, 0.39}, {0.05, 5}, "Cell size, the same in all directions");
  schema.real("fluid.density_g_per_mm3", 1.0e-3, {1e-4, 1e-1}, "Density (blood 1.0e-3, saline 1.0e-3)");
  schema.real("fluid.viscosity_Pa_s", 3.5e-3, {0, 10}, "Viscosity (blood 3.5e-3, saline about 0.9e-3)");
  schema.choice(
      "fluid.viscosity_model", "newtonian", {"newtonian", "carreau-yasuda"},
      "Constant viscosity, or blood that thins with shear: viscosity_Pa_s is then that at high shear");
  schema.real("fluid.zero_shear_viscosity_Pa_s", 0.056, {0, 10},
              "Carreau-Yasuda: viscosity at rest (assumed)");
  schema.real("fluid.carreau_time_s", 1.902, {0, 1000}, "Carreau-Yasuda: time lambda (assumed)");
  schema.real("fluid.carreau_exponent", 0.22, {0, 1}, "Carreau-Yasuda: exponent n (assumed)");
  schema.real("fluid.carreau_transition", 1.25, {0.1, 10}, "Carreau-Yasuda: transition a (assumed)");
  schema.choice("fluid.viscosity_scheme", "explicit", {"explicit", "implicit"},
                "How the constant viscosity is advanced; implicit (Crank-Nicolson) has no limit on the step");
  schema.choice("fluid.subgrid", "none", {"none", "vreman"},
                "Model of the eddies that the grid does not resolve");
  schema.real("fluid.vreman_constant", 0.07, {0, 1},
              "c of Vreman's model; 2.5 times Smagorinsky's constant squared");
  schema.choice(
      "fluid.convection", "upwind3", {"upwind3", "centred4", "centred2", "weno5"},
      "Third-order upwind-biased convection; fourth- or second-order centred without dissipation; or limited "
      "(fifth-order WENO), for jets that the grid does not resolve");
  schema.real(
      "fluid.penalisation_s", 1e-8, {1e-12, 1e-5},
      "Time constant of solid faces; a solid lets velocity penalisation/density x pressure gradient through");
  schema.choice("fluid.wall", "staircase", {"staircase", "interpolated"},
                "How the lumen's wall cuts the grid: whole faces, or second-order by interpolation");
  schema.real("fluid.margin_cells", 2, {1, 50}, "Cells between the lumen and the sides of the box");
}

}  // namespace valsalva
