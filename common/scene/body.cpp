#include "scene/scene.hpp"

namespace valsalva {
namespace {

void declare_mesh_keys(Schema& schema) {
  schema.choice(
      "body.shape", "file",
      {"file", "plate", "box", "corners", "cylinder", "sphere", "annulus", "disc", "ball", "line", "arc",
       "leaflet", "crown"},
      "Where the mesh comes from: a file, or generated in the frame origin, direction1, direction2");
  schema.text("body.file", "",
              "Mesh file: .msh (gmsh), .vtk (legacy), .bdf, .unv, .mesh, .stl, .ply, .obj or .off");
  schema.text("body.group", "", "Physical group of the file that holds the elements; empty: all");
  schema.real("body.scale_to_mm", 1, positive(), "Factor on the coordinates of the file");
  schema.reals("body.origin_mm", {0, 0, 0}, 3, unlimited(), "Origin of the generated shape's frame");
  schema.reals("body.direction1", {1, 0, 0}, 3, unlimited(), "First axis of that frame");
  schema.reals("body.direction2", {0, 1, 0}, 3, unlimited(),
               "Second axis, made normal to the first; the third is their cross product");
  schema.reals(
      "body.size_mm", {}, 0, positive(),
      "plate: length and width; box: three lengths; cylinder: height; annulus: its width; line: length");
  schema.reals(
      "body.corners_mm", {}, 0, unlimited(),
      "corners: 4 points of a sheet, counter-clockwise, or 8 of a solid (bottom, then top), in space");
  schema.boolean("body.sewn", true, "Generated shapes: is a full turn closed? false leaves a slit");
  schema.reals(
      "body.divisions", {}, 0, {1, 1e5},
      "Elements along size_mm; cylinder and sphere: round, along; line, arc: one number; solids: three");
  schema.real(
      "body.radius_mm", 0, not_negative(),
      "Radius of cylinder, sphere, arc, disc, ball (inner one of a solid cylinder or sphere, of an annulus)");
  schema.real("body.wall_mm", 0, not_negative(), "Thickness of a solid cylinder, sphere, annulus or disc");
  schema.reals("body.angle_deg", {0, 360}, 2, {-360, 360},
               "Azimuth from direction1 towards direction2, from and to");
  schema.reals("body.polar_deg", {0, 180}, 2, {0, 180}, "sphere: angle from the third axis, from and to");
  schema.integer("body.copies", 1, {1, 1000},
                 "Generated shapes: copies turned evenly about the third axis, as one body");
  schema.real("body.attachment_mm", 0, not_negative(),
              "leaflet, crown: height of the attachment, from its lowest point to the commissure");
  schema.real("body.attachment_exponent", 2, {1, 10},
              "leaflet, crown: the attachment is height |s|^exponent");
  schema.real("body.commissure_mm", 0, not_negative(), "leaflet, crown: straight post above the attachment");
  schema.real("body.free_edge_gap_mm", 0, not_negative(),
              "leaflet: distance of the free edge's middle from the axis, at rest");
  schema.real(
      "body.free_edge_exponent", 0, {0, 10},
      "leaflet: 0: its free edge is bowed to a circle, at rest; p > 0: it follows the tube beside the "
      "commissures and turns inwards as cos^p");
  schema.real("body.free_edge_peak_mm", 0, not_negative(), "leaflet: rise of the free edge in its middle");
  schema.real("body.leaflet_half_angle_deg", 60, {10, 60},
              "leaflet, crown: azimuth from its middle to a commissure; below 60: room for posts");
  schema.reals("body.leaflet_part", {-1, 1}, 2, {-1, 1},
               "leaflet, crown: the part that is modelled, from -1 (one commissure) to 1; half: 0 to 1");
  schema.real("body.base_mm", 0, not_negative(), "crown: its depth below the attachment's lowest point");
  schema.real("body.twist_deg", 0, {-720, 720}, "plate, box: turn about direction1 at the far end");
  schema.reals("body.grading", {1, 1, 1}, 3, positive(),
               "Sheets, solids: size of the last element over the first, along each direction of divisions");
  schema.choice("body.pattern", "alternating", {"alternating", "right", "left", "crossed"},
                "Diagonals of a generated triangle mesh; crossed: four triangles round a centre node");
  schema.choice("body.element", "hex8", {"tet4", "tet10", "hex8", "hex27"}, "Element of a generated solid");
}

void declare_material_keys(Schema& schema) {
  schema.text("body.material", "", "Name of a published material (valsalva-material --list); or give law");
  schema.text(
      "body.law", "",
      "Name of an elastic law (valsalva-material --laws); \"linear\": young, poisson; beams: \"linear\" or "
      "\"superelastic\"");
  schema.texts("body.law_parameters", {}, "Its parameters, each as text \"key = value\"");
  schema.reals("body.fibre_grid", {5, 5, 2}, 3, {1, 20},
               "Superelastic beams: points over width and depth, stations along an element");
  schema.real("body.young_kPa", 0, not_negative(), "Young's modulus of the linear law and of beams");
  schema.real("body.poisson", 0.3, {0, 0.5}, "Poisson number of the linear law and of beams");
  schema.choice("body.volumetric", "none", {"none", "j-ln-j", "quadratic", "logarithmic", "simo-taylor"},
                "Volumetric term; none: shells are incompressible, solids need one (or a law W(E))");
  schema.real("body.bulk_modulus_kPa", 0, not_negative(), "Modulus of the volumetric term");
  schema.choice("body.split", "modified", {"modified", "full"},
                "Does the law see shape change only (modified) or the whole deformation?");
  schema.choice("body.formulation", "mixed", {"mixed", "displacement"},
                "Solids: mixed does not lock near incompressibility");
  schema.real("body.density_g_per_mm3", 1.1e-3, positive(), "Density");
  schema.real("body.stiffness_factor", 1, positive(), "Multiplies the law's matrix part and bending");
  schema.choice(
      "body.shell_element", "kirchhoff", {"kirchhoff", "hinge"},
      "Shells: Kirchhoff-Love triangles (bending on any mesh), or flat triangles with bending hinges");
  schema.real("body.membrane_scale", 1, positive(), "Multiplies a shell's membrane stiffness alone");
  schema.real("body.bending_scale", 1, not_negative(), "Multiplies a shell's bending stiffness alone");
  schema.choice("body.fibres", "none", {"none", "constant", "cylindrical"},
                "Mean fibre direction: one direction, or turned from the circumference to the axis");
  schema.reals("body.fibre_direction", {1, 0, 0}, 3, unlimited(),
               "constant: the mean direction; cylindrical: the axis");
  schema.reals("body.fibre_axis_point_mm", {0, 0, 0}, 3, unlimited(), "cylindrical: a point of the axis");
  schema.real("body.fibre_mean_deg", 0, {-90, 90},
              "cylindrical: mean direction from the circumference towards the axis");
  schema.reals("body.fibre_angles_deg", {}, 0, {-90, 90},
               "Families from the mean direction; empty: those of the material, else one at 0");
}

}  // namespace

void declare_body(Schema& schema) {
  schema.tables("body", "A body: shell, solid, beams or rigid surface");
  schema.text("body.name", "", "Its name; every body has its own");
  schema.choice("body.kind", "shell", {"shell", "solid", "beams", "rigid"}, "What it is made of");
  declare_mesh_keys(schema);
  schema.real("body.thickness_mm", 0, not_negative(),
              "Thickness of a shell; contact thickness of a rigid body");
  schema.reals(
      "body.thickness_grid_mm", {}, 0, positive(),
      "Generated shells: thickness on a grid over the sheet, first direction fastest, bilinear between");
  schema.reals("body.thickness_grid", {}, 0, {2, 1000}, "Points of that grid along both directions");
  schema.text("body.thickness_field", "", "Node data of the file (gmsh view) that holds the thickness in mm");
  schema.real("body.width_mm", 0, not_negative(), "Beams: section across depth_direction");
  schema.real("body.depth_mm", 0, not_negative(), "Beams: section along depth_direction");
  schema.reals("body.depth_direction", {0, 0, 1}, 3, unlimited(), "Beams: direction of the depth, or axis");
  schema.choice("body.depth", "constant", {"constant", "radial"},
                "Beams: the depth points along depth_direction, or away from the axis along it through "
                "depth_point_mm");
  schema.reals("body.depth_point_mm", {0, 0, 0}, 3, unlimited(), "radial: a point of that axis");
  schema.real("body.torsion_mm4", 0, not_negative(), "Beams: torsion constant; 0: the rectangle's");
  schema.real("body.shear_area_mm2", 0, not_negative(),
              "Beams: area for shear, 5/6 of a rectangle's; 0: no shear flexibility");
  declare_material_keys(schema);
  schema.reals("body.velocity_mm_per_s", {0, 0, 0}, 3, unlimited(), "Velocity at the start");
  schema.reals("body.spin_rad_per_s", {0, 0, 0}, 3, unlimited(),
               "Spin about its centre of mass at the start");
  schema.texts(
      "body.start_displacement", {},
      "In fluid: displacement from the stress-free shape at the start, mm: three expressions of x, y, z");
  schema.choice(
      "body.motion", "fixed", {"fixed", "free"},
      "rigid: fixed, unless supports move it; free: six degrees of freedom (explicit, quasi_static)");
  schema.real("body.mass_g", 0, not_negative(),
              "rigid, free: its mass; 0: of its closed surface, filled with density_g_per_mm3");
  schema.reals("body.inertia_g_mm2", {}, 0, unlimited(),
               "rigid, free: xx, yy, zz, xy, yz, zx about the centre; empty: of the uniform inside");
  schema.reals("body.centre_mm", {}, 0, unlimited(),
               "rigid, free: centre of mass; empty: of the uniform inside");
}

void declare_nodes(Schema& schema) {
  schema.tables("nodes", "A named set of nodes of a body, chosen in its reference shape");
  schema.text("nodes.name", "", "Its name");
  schema.text("nodes.body", "", "The body");
  schema.choice("nodes.select", "all",
                {"all", "group", "box", "plane", "sphere", "cylinder", "nearest", "numbers", "border",
                 "union", "intersection", "difference"},
                "group: physical group of the file; border: edge of a sheet, surface of a solid; union, "
                "intersection, difference: of sets; the others by place, within tolerance_mm");
  schema.texts("nodes.sets", {},
               "union, intersection: sets of nodes; difference: the first without the others");
  schema.text("nodes.group", "", "Name of the physical group");
  schema.reals("nodes.low_mm", {-1e9, -1e9, -1e9}, 3, unlimited(), "box: lower corner");
  schema.reals("nodes.high_mm", {1e9, 1e9, 1e9}, 3, unlimited(), "box: upper corner");
  schema.reals("nodes.point_mm", {0, 0, 0}, 3, unlimited(),
               "plane, cylinder: a point of plane or axis; sphere: centre; nearest: the place");
  schema.reals("nodes.direction", {0, 0, 1}, 3, unlimited(), "plane: its normal; cylinder: its axis");
  schema.real("nodes.radius_mm", 0, not_negative(), "sphere, cylinder: nodes on the surface of this radius");
  schema.boolean("nodes.inside", false, "sphere, cylinder: the nodes inside too; plane: those behind it too");
  schema.reals("nodes.numbers", {}, 0, {0, 1e9}, "numbers: node numbers of the body, from 0");
  schema.real("nodes.tolerance_mm", 1e-6, not_negative(),
              "Distance up to which a node counts as on the surface");
}

void declare_support(Schema& schema) {
  schema.tables("support", "What holds or moves a set of nodes");
  schema.text("support.name", "", "Its name");
  schema.text("support.nodes", "", "The set of nodes");
  schema.texts("support.hold", {}, "Any of x, y, z, rx, ry, rz, all (rotations: of beams); or symmetry");
  schema.reals("support.normal", {0, 0, 0}, 3, unlimited(),
               "symmetry: normal of the plane; holds the motion along it and rotations about its tangents");
  schema.reals("support.displacement_mm", {0, 0, 0}, 3, unlimited(),
               "Prescribed displacement of the held components at factor 1");
  schema.reals("support.gradient", {}, 0, unlimited(),
               "Nine numbers, row by row: adds gradient (X - turn_point_mm) to the displacement");
  schema.real("support.turn_deg", 0, unlimited(),
              "Prescribed turn about turn_axis at factor 1; hold = [\"all\"]");
  schema.reals("support.turn_axis", {0, 0, 1}, 3, unlimited(), "Axis of the turn");
  schema.reals("support.turn_point_mm", {0, 0, 0}, 3, unlimited(), "A point of that axis");
  schema.real("support.stiffness_N_per_mm", 0, not_negative(),
              "Above 0: elastic tethers, one a node, to its (displaced) place instead of a rigid hold");
  schema.reals("support.time_s", {}, 0, not_negative(), "Times of the factor table, ascending");
  schema.reals("support.factor", {}, 0, unlimited(), "Its values; empty: 0 at the start to 1 at the end");
}

void declare_load(Schema& schema) {
  schema.tables("load", "What pushes");
  schema.text("load.name", "", "Its name");
  schema.choice(
      "load.kind", "force", {"force", "moment", "pressure", "traction", "gravity", "volume"},
      "force, moment: dead, on nodes (moment on a shell's edge: follows it); pressure: follows the surface; "
      "traction: dead, per reference area; volume: the pressure that keeps an enclosed volume");
  schema.text("load.nodes", "", "force, moment: the set; pressure, traction: faces with all nodes in it");
  schema.text("load.body", "", "pressure, traction, gravity: the body; gravity: empty for all");
  schema.reals("load.force_N", {0, 0, 0}, 3, unlimited(), "force at factor 1");
  schema.reals("load.moment_N_mm", {0, 0, 0}, 3, unlimited(),
               "moment at factor 1, on beam nodes or along a shell's edge");
  schema.choice("load.share", "total", {"total", "node", "length", "area"},
                "force, moment: the sum over the set, evenly by node, by length of edge or beam, by area of "
                "surface; node: on each node");
  schema.real("load.volume_ratio", 1, positive(), "volume: wanted over reference volume, at factor 1");
  schema.real("load.bulk_kPa", 1e4, positive(), "volume: pressure per relative volume that is missing");
  schema.reals("load.point_mm", {0, 0, 0}, 3, unlimited(),
               "volume: apex of the cones over the surface; with symmetry planes a point of all of them");
  schema.real("load.pressure_kPa", 0, unlimited(),
              "pressure at factor 1: pushes along the surface's normal (a solid: into the body)");
  schema.reals("load.traction_kPa", {0, 0, 0}, 3, unlimited(), "traction at factor 1");
  schema.reals("load.acceleration_mm_per_s2", {0, 0, 0}, 3, unlimited(),
               "gravity at factor 1 (9810 on earth)");
  schema.reals("load.time_s", {}, 0, not_negative(), "Times of the factor table, ascending");
  schema.reals("load.factor", {}, 0, unlimited(),
               "Its values; empty: 0 to 1 over the run where the solver is static, else 1 at all times");
}

void declare_tie(Schema& schema) {
  schema.tables("tie",
                "Sews each node of one set to the nearest node of another, with the offset that it has");
  schema.text("tie.name", "", "Its name");
  schema.text("tie.nodes", "", "The set that is sewn");
  schema.text("tie.to", "", "The set that it is sewn to; beam nodes turn the offset");
  schema.real("tie.stiffness_N_per_mm", 0, not_negative(),
              "Of each tie; 0: the mean stiffness of the nodes that are tied");
}

void declare_contact_pair(Schema& schema) {
  schema.tables("contact_pair",
                "Two bodies that may touch, a body that may touch itself, or a rigid surface");
  schema.text("contact_pair.name", "", "Its name");
  schema.text("contact_pair.body", "", "The body");
  schema.text("contact_pair.other", "", "The other body; the same one: self contact; empty: the surface");
  schema.choice("contact_pair.surface", "none", {"none", "plane", "sphere", "cylinder", "level_set"},
                "Rigid surface: plane (free side: its normal), sphere, endless cylinder, or a level set");
  schema.text(
      "contact_pair.file", "",
      "level_set: closed surface (.stl, .ply, .obj, .off), or a state of segment or mesher (its lumen)");
  schema.real("contact_pair.spacing_mm", 0.5, positive(), "level_set of a surface: spacing of its grid");
  schema.reals("contact_pair.point_mm", {0, 0, 0}, 3, unlimited(), "Point of the plane or axis, centre");
  schema.reals("contact_pair.direction", {0, 0, 1}, 3, unlimited(),
               "Normal of the plane, axis of the cylinder");
  schema.real("contact_pair.radius_mm", 0, not_negative(), "Radius of sphere or cylinder");
  schema.boolean("contact_pair.inside", false, "Is the body inside the sphere, cylinder or level set?");
  schema.reals("contact_pair.displacement_mm", {0, 0, 0}, 3, unlimited(),
               "Displacement of the rigid surface at factor 1");
  schema.real("contact_pair.radius_change_mm", 0, unlimited(),
              "Change of the radius of sphere or cylinder at factor 1");
  schema.reals("contact_pair.time_s", {}, 0, not_negative(), "Times of its factor table");
  schema.reals("contact_pair.factor", {}, 0, unlimited(),
               "Its values; empty: 0 at the start to 1 at the end");
  schema.real("contact_pair.friction", 0, {0, 10}, "Coulomb coefficient");
  schema.real("contact_pair.slip_share", 0.05, {1e-6, 1},
              "Friction between bodies: way of a pair before it slips, over the contact distance");
  schema.real("contact_pair.stiffness_kPa_per_mm", 1e4, positive(), "Penalty against the rigid surface");
  schema.real("contact_pair.offset_mm", -1, {-1, 100},
              "Distance at which a node meets the rigid surface; -1: half the thickness (solids: 0)");
  schema.real("contact_pair.distance_mm", 0, not_negative(),
              "Distance at which bodies meet; 0: the sum of the half thicknesses");
  schema.real("contact_pair.modulus_kPa", 1000, positive(), "Stiffness scale of the law between bodies");
  schema.choice("contact_pair.law", "barrier", {"barrier", "penalty"}, "Law between bodies");
}

void declare_dynamics(Schema& schema) {
  schema.table("dynamics", "How a scene without fluid is advanced");
  schema.choice("dynamics.solver", "explicit", {"explicit", "quasi_static", "static", "implicit"},
                "explicit: central differences; quasi_static: load steps, each brought to rest by damping; "
                "static: load steps by Newton; implicit: generalised-alpha");
  schema.real("dynamics.end_s", 1, positive(),
              "End of the run; for static solvers the end of the load tables");
  schema.real("dynamics.step_s", 0, not_negative(),
              "Largest time step; 0: explicit takes the stable one, implicit 1 % of end_s");
  schema.real("dynamics.safety", 0.8, {0.01, 1}, "Of the stable step");
  schema.integer("dynamics.load_steps", 10, {1, 100000}, "Load steps of the static solvers");
  schema.real("dynamics.damping_per_s", 0, not_negative(),
              "Mass-proportional damping of explicit and implicit");
  schema.boolean("dynamics.mass_scaling", false, "explicit: may masses be raised where step_s asks for it?");
  schema.real("dynamics.spectral_radius", 0.8, {0, 1}, "implicit: at infinite frequency");
  schema.real("dynamics.residual", 0, {0, 0.1},
              "Unbalanced force over the forces that act; 0: 1e-4 for quasi_static, 1e-8 for Newton");
  schema.real("dynamics.energy_ratio", 1e-6, {1e-15, 0.1},
              "quasi_static: kinetic over stored energy at rest");
  schema.integer("dynamics.max_iterations", 400000, {1, 100000000},
                 "quasi_static: most iterations a load step");
  schema.integer("dynamics.newton_iterations", 25, {2, 1000}, "static, implicit: before the step is halved");
  schema.choice("dynamics.prestress", "none", {"none", "backward_displacement"},
                "Is the given shape the loaded one (static solvers: at the end; dynamic ones: at the start, "
                "with the loads "
                "of time 0), from which the stress-free shape is found?");
  schema.real("dynamics.prestress_tolerance_mm", 1e-3, positive(),
              "Largest distance of a node of the loaded shape from the given one");
  schema.integer("dynamics.prestress_iterations", 50, {1, 10000}, "Most equilibria on the way there");
  schema.real("dynamics.speed_limit_mm_per_s", 1e6, positive(), "explicit: alarm");
  schema.integer("dynamics.history_rows", 200, {1, 1000000},
                 "Rows of history.csv over the run (dynamic solvers)");
}

void declare_probe(Schema& schema) {
  schema.tables("probe", "A column of history.csv and a metric of summary.json, named by probe and unit");
  schema.text("probe.name", "", "Its name");
  schema.choice(
      "probe.quantity", "displacement",
      {"displacement", "position", "velocity", "rotation", "reaction", "reaction_moment", "contact_force",
       "contact_area", "penetration", "kinetic_energy", "stored_energy", "total_energy", "momentum",
       "angular_momentum", "stretch", "von_mises", "stress", "volume", "pressure"},
      "What is measured");
  schema.text(
      "probe.of", "",
      "displacement, position, velocity, rotation: node set; reaction, reaction_moment: support; "
      "contact_force, contact_area, penetration: contact pair; stored_energy: body, tie or pair, empty "
      "for all; momentum, angular_momentum: body, empty for all; stretch, von_mises, stress: body; "
      "volume: body, or volume load; pressure: volume load");
  schema.choice(
      "probe.component", "magnitude",
      {"x", "y", "z", "magnitude", "direction", "radial", "xx", "yy", "zz", "xy", "yz", "zx", "principal_max",
       "principal_min", "mean", "fibre"},
      "Component; direction: along probe.direction (of shells: as it moves with the sheet); radial: of "
      "displacement, position, velocity, reaction, contact_force away from the axis through point_mm "
      "along direction, node by node; of "
      "stress (Cauchy): xx to mean, direction, fibre (of shells: the first family)");
  schema.choice(
      "probe.layer", "largest", {"largest", "bottom", "middle", "top", "bending"},
      "stretch, von_mises, stress of Kirchhoff shells: at this height; middle: the membrane stress; "
      "bending: stress at the top less that at the bottom, by two; largest: of bottom, middle, top");
  schema.reals(
      "probe.point_mm", {}, 0, unlimited(),
      "stretch, von_mises, stress: at the element nearest to this point of the reference; empty: the "
      "largest of the body; reaction_moment, angular_momentum: about this point; radial: of the axis; empty: "
      "the origin");
  schema.reals("probe.direction", {0, 0, 1}, 3, unlimited(), "For component = \"direction\"");
  schema.choice("probe.statistic", "mean", {"mean", "min", "max"}, "Over the nodes of the set");
}

}  // namespace valsalva
