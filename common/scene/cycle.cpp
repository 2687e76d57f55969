#include "scene/scene.hpp"

namespace valsalva {

void declare_cycle(Schema& schema) {
  schema.table("cycle", "The beating valve: coupling of blood and leaflets, duration, what is recorded");
  schema.integer("cycle.beats", 1, {1, 100},
                 "Full beats after the initialisation; figures are those of the last");
  schema.real("cycle.duration_s", 0, not_negative(),
              "Simulated time, initialisation included; 0: the initialisation and all beats");
  schema.real(
      "cycle.initialisation_s", 0.03, {0.001, 0.5},
      "Both ends are brought from rest to end-diastolic pressure within this time, closing the valve");
  schema.choice(
      "cycle.kernel", "ib4", {"linear", "ib3", "ib4", "bspline3", "bspline4", "cbs32", "cbs43"},
      "Regularised kernel of the coupling; ib4 allows the largest steps, cbs43 and cbs32 leak least");
  schema.real("cycle.step_safety", 0.85, {0.05, 0.95}, "Time step over the computed stability limit");
  schema.real("cycle.max_step_s", 1e-4, {1e-7, 1e-2}, "Largest time step");
  schema.real("cycle.max_cfl", 0.35, {0.01, 1}, "Largest local CFL number");
  schema.real("cycle.largest_stretch", 1.6, {1.05, 5},
              "Alarm: an edge of a leaflet longer than this times its length at rest");
  schema.integer("cycle.probe_interval", 8, {1, 1000}, "Steps between estimates of the stability limit");
  schema.integer("cycle.probe_iterations", 2, {1, 100}, "Power iterations in each estimate");
  schema.real("cycle.strut_mask_cells", 0.5, {0, 2},
              "Fluid faces within this many cells of a strut's axis (or within its half depth) are solid");
  schema.real(
      "cycle.shell_mask_cells", 0.6, {0, 2},
      "Fluid faces within this many cells of held tissue (skirt, native leaflets under a device) are solid");
  schema.real(
      "cycle.edge_mask_cells", 0.8, {0, 2},
      "Fluid faces within this many cells of the leaflets' attached edge are solid: closes the slot there");
  schema.real("cycle.repulsion_kPa", 200, not_negative(),
              "Repulsion between leaflets that touch; two sheets push each other with at most 0.44 of it");
  schema.real("cycle.repulsion_cells", 0.6, {0.05, 3}, "Its range in cells");
  schema.real(
      "cycle.standoff_cells", 1.3, {0, 3},
      "Leaflets nearer to each other than this many cells couple to the grid as if they were this far "
      "apart, so that they can part; 0: where they are");
  schema.real("cycle.anchor_drag_N_s_per_mm", 0.05, positive(),
              "The device slides against the wall at (force - friction capacity) / this (assumed)");
  schema.integer("cycle.history_interval", 10, {1, 100000}, "Steps between rows of history.csv");
  schema.integer("cycle.frames_per_beat", 24, {0, 1000},
                 "Light pictures of the last beat kept for the report");
}

}  // namespace valsalva
