#include "scene/scene.hpp"

namespace valsalva {
namespace {

void declare_box(Schema& schema) {
  schema.reals("fluid.box_mm", {}, 0, unlimited(),
               "Makes a scene of fluid alone: low and high corner, six numbers; a periodic or slip direction "
               "of no extent gets four cells");
  schema.real("fluid.grid_mm", 0, not_negative(), "Cell size in the box; or give cells");
  schema.reals("fluid.cells", {}, 0, {1, 1e5}, "Cells along x, y, z of the box; they must come out as cubes");
  schema.integer("fluid.order", 2, {2, 4}, "Order in space, 2 or 4; 4 in boxes that are periodic all round");
  schema.choice("fluid.time_scheme", "ab2", {"ab2", "rk3"},
                "Adams-Bashforth 2, or Runge-Kutta 3: three times the work, three times the step");
  schema.choice(
      "fluid.pressure_solver", "auto", {"auto", "direct", "krylov"},
      "In a box: direct (all cells, known pressure on sides of one axis), krylov (cells of the fluid "
      "alone, tight walls, openings anywhere), or auto: direct wherever it can");
  schema.real("fluid.pressure_tolerance", 1e-8, {1e-14, 1e-2},
              "krylov: divergence that is left, root mean square over the cells, of largest speed / cell");
  schema.real("fluid.end_s", 1, positive(), "End of the run");
  schema.real("fluid.step_s", 0, not_negative(),
              "Fixed step (shortened so that rows are met); 0: as large as cfl and viscosity allow");
  schema.real("fluid.cfl", 0, {0, 2}, "Largest step x (|u|+|v|+|w|) / cell; 0: 0.35 for ab2 and 1 for rk3");
  schema.integer("fluid.history_rows", 200, {1, 1000000}, "Rows of history.csv over the run, evenly spaced");
  schema.real("fluid.average_from_s", -1, {-1, 1e9},
              "Means, extremes and frequencies are taken from here on; -1: from half of the run");
  schema.texts("fluid.velocity", {"0", "0", "0"},
               "Velocity at the start, mm/s: three expressions of x, y, z (mm)");
  schema.text("fluid.pressure", "0", "Pressure at the start, Pa: an expression of x, y, z");
  schema.texts("fluid.body_force_Pa_per_mm", {"0", "0", "0"},
               "Force on the fluid: three expressions of x, y, z, t");
}

}  // namespace

void declare_fluid(Schema& schema) {
  schema.table("fluid",
               "Blood, and the uniform staggered grid it is solved on; without this table there is no fluid");
  schema.real("fluid.spacing_mm", {1.0, 0.75, 0.5, 0.39}, {0.05, 5}, "Cell size, the same in all directions");
  schema.real("fluid.density_g_per_mm3", 1.0e-3, {1e-6, 1e3}, "Density (blood 1.0e-3, saline 1.0e-3)");
  schema.real("fluid.viscosity_Pa_s", 3.5e-3, {0, 1e4}, "Viscosity (blood 3.5e-3, saline about 0.9e-3)");
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
  schema.choice(
      "fluid.wall_convection", "as_inside", {"as_inside", "upwind1"},
      "Beside walls: as elsewhere, or with first-order upwinding more, which ends motions there that "
      "coarse grids carry on");
  schema.real(
      "fluid.penalisation_s", 1e-8, {1e-12, 1e-5},
      "Time constant of solid faces; a solid lets velocity penalisation/density x pressure gradient through");
  schema.choice("fluid.wall", "staircase", {"staircase", "interpolated"},
                "How walls cut the grid: whole faces, or second-order by interpolation");
  schema.real("fluid.margin_cells", 2, {1, 50}, "Cells between the lumen and the sides of the box");
  declare_box(schema);
}

}  // namespace valsalva
