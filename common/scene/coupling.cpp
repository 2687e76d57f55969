#include "scene/scene.hpp"

namespace valsalva {

void declare_coupling(Schema& schema) {
  schema.table("coupling", "How the bodies of a scene with fluid.box_mm meet the fluid");
  schema.choice("coupling.kernel", "cbs43",
                {"linear", "ib3", "ib4", "bspline3", "bspline4", "cbs32", "cbs43"},
                "Regularised kernel; cbs43 keeps the content of closed bodies, ib4 allows the largest steps");
  schema.choice("coupling.points", "auto", {"auto", "nodes", "quadrature"},
                "Where bodies couple to the grid: at their nodes, or at points inside their elements; auto: "
                "nodes for shells and beams whose edges are at most 0.75 cells, points for the others");
  schema.real("coupling.spacing_cells", 0.5, {0.1, 2}, "quadrature: largest distance of points, in cells");
  schema.boolean("coupling.excess_mass", true,
                 "Does the mass count that bodies have beyond the fluid's density? Without it they are as "
                 "inert as the fluid, and may be lighter");
  schema.real("coupling.tie_rate_per_s", 0, not_negative(),
              "Angular frequency of the ties to excess masses, 40 times the motion's or more; 0: a quarter "
              "of what the structure's step allows");
  schema.real("coupling.rotation_damping_per_s", 0, not_negative(), "Damping of the rotations of beam nodes");
  schema.boolean(
      "coupling.keep_volume", true,
      "Do solids keep the volume of each of their elements (tetrahedra: of those around each node)? "
      "Interpolation alone lets it drift");
  schema.real("coupling.step_safety", 0.85, {0.05, 0.95}, "Time step over the computed stability limit");
  schema.real("coupling.lead", 0, {0, 0.5},
              "Share of the step by which elastic forces run ahead: 0.25 allows steps up to twice as long, "
              "and is what "
              "solids take that keep their volume, unless this is set");
  schema.integer("coupling.probe_interval", 8, {1, 1000}, "Steps between estimates of the stability limit");
  schema.integer("coupling.probe_iterations", 2, {1, 100}, "Power iterations in each estimate");
  schema.real("coupling.largest_stretch", 4, {1, 1000},
              "Alarm: an edge of an element is longer than this times its length at rest");
}

}  // namespace valsalva
