#include "scene/scene.hpp"

namespace valsalva {

namespace {

/// What stands behind the prescribed values of sides and openings: their factor over time, resistance,
/// Windkessel.
void declare_course(Schema& schema, const std::string& table) {
  schema.reals(table + ".time_s", {}, 0, not_negative(), "Times of the factor table, ascending");
  schema.reals(table + ".factor", {}, 0, unlimited(), "Its values; linear between them");
  schema.text(table + ".factor_file", "", "The table as two columns, time_s and factor (.csv)");
  schema.text(table + ".factor_of_t", "", "Or an expression of t");
  schema.real(table + ".period_s", 0, not_negative(), "Period after which the table begins anew; 0: none");
  schema.real(table + ".resistance_Pa_s_per_mL", 0, not_negative(),
              "Known pressure: resistance behind it (with a compliance: the peripheral one)");
  schema.real(table + ".characteristic_Pa_s_per_mL", 0, not_negative(),
              "Known pressure with a compliance: resistance before it");
  schema.real(table + ".compliance_mL_per_Pa", 0, not_negative(),
              "Known pressure: compliance of a Windkessel");
}

}  // namespace

void declare_boundary(Schema& schema) {
  schema.tables("boundary",
                "What happens on sides of the fluid's box; sides without an entry are slip sides");
  schema.text("boundary.name", "", "Its name");
  schema.texts("boundary.sides", {},
               "Of x_low, x_high, y_low, y_high, z_low, z_high; x, y, z: both; all: all six");
  schema.choice("boundary.kind", "wall", {"wall", "slip", "periodic", "inflow", "outflow"},
                "wall: moves with velocity, if given; slip: symmetry; inflow: known velocity; outflow: known "
                "pressure");
  schema.texts("boundary.velocity", {"0", "0", "0"},
               "wall (tangential), inflow with profile = \"given\": mm/s, three expressions of x, y, z, t");
  schema.choice("boundary.profile", "given", {"given", "uniform", "parabola", "disc"},
                "inflow: velocity as given, or normal to the side: even, parabolic between the walls beside "
                "it, or that of Poiseuille on the disc of centre_mm and radius_mm");
  schema.reals("boundary.centre_mm", {0, 0, 0}, 3, unlimited(), "disc: its centre; uniform: of radius_mm");
  schema.real("boundary.radius_mm", 0, not_negative(), "disc: its radius; uniform: 0 for the whole side");
  schema.real("boundary.speed_mm_per_s", 0, unlimited(), "Largest speed of a profile, inwards, at factor 1");
  schema.real("boundary.mean_speed_mm_per_s", 0, unlimited(), "Or its mean where it is not zero");
  schema.real("boundary.flow_mL_per_s", 0, unlimited(), "Or its flow, exact on the grid");
  schema.real("boundary.pressure_Pa", 0, unlimited(),
              "outflow: pressure at factor 1; behind a resistance: that of its far end");
  declare_course(schema, "boundary");
}

void declare_obstacle(Schema& schema) {
  schema.tables("obstacle", "A rigid body in the fluid's box, or what encloses the fluid");
  schema.text("obstacle.name", "", "Its name");
  schema.choice("obstacle.shape", "sphere",
                {"sphere", "ellipsoid", "cylinder", "box", "half_space", "revolution", "torus", "expression",
                 "file", "union", "intersection", "difference"},
                "revolution: about an axis, by a table of radii; half_space: behind a plane; expression: a "
                "level set; file: a closed surface; the last three: of other obstacles");
  schema.choice("obstacle.fluid", "outside", {"outside", "inside"}, "Where the fluid is");
  schema.boolean("obstacle.part", false, "Is it only a part of a union, intersection or difference?");
  schema.texts("obstacle.of", {}, "union, intersection: the parts; difference: the first without the others");
  schema.reals("obstacle.centre_mm", {0, 0, 0}, 3, unlimited(),
               "Centre; revolution: where the table's s is 0; half_space: a point of the plane");
  schema.reals("obstacle.axis", {0, 0, 1}, 3, unlimited(),
               "Of cylinder, torus, revolution, box (third edge); half_space: its normal, into the fluid");
  schema.reals("obstacle.direction", {1, 0, 0}, 3, unlimited(),
               "box, ellipsoid: first edge, made normal to axis");
  schema.real("obstacle.radius_mm", 0, not_negative(), "sphere, cylinder; torus: of its middle line");
  schema.real("obstacle.tube_mm", 0, not_negative(), "torus: radius of the tube");
  schema.real("obstacle.length_mm", 0, not_negative(), "cylinder: 0 for an endless one");
  schema.reals("obstacle.size_mm", {}, 0, positive(), "box: three edges; ellipsoid: three diameters");
  schema.reals("obstacle.profile_mm", {}, 0, unlimited(),
               "revolution: s and radius by turns, s ascending (equal s: a step); closed at both ends");
  schema.text("obstacle.distance", "",
              "expression of x, y, z (mm), negative in the body; near its zero it should be a distance");
  schema.text("obstacle.file", "", "Closed surface (.stl, .ply, .obj, .off)");
  schema.real("obstacle.scale_to_mm", 1, positive(), "file: factor on its coordinates");
  schema.real("obstacle.spacing_mm", 0, not_negative(),
              "file: samples of its level set; 0: the fluid's cells");
  schema.texts("obstacle.displacement", {},
               "Prescribed motion, mm: three expressions of t; shape and centre are those at displacement 0");
  schema.text("obstacle.turn_deg", "", "Prescribed turn about turn_axis through turn_point_mm: of t");
  schema.reals("obstacle.turn_axis", {0, 0, 1}, 3, unlimited(), "Axis of the turn");
  schema.reals("obstacle.turn_point_mm", {0, 0, 0}, 3, unlimited(),
               "A point of it, moving with displacement");
}

void declare_opening(Schema& schema) {
  schema.tables("opening", "Where a plane cuts a vessel open inside the fluid's box");
  schema.text("opening.name", "", "Its name");
  schema.reals("opening.centre_mm", {0, 0, 0}, 3, unlimited(),
               "A point of the plane, in the vessel's middle");
  schema.reals("opening.normal", {0, 0, 1}, 3, unlimited(), "Normal of the plane, out of the fluid");
  schema.real("opening.radius_mm", 0, not_negative(),
              "The plane cuts within this of centre_mm; across the whole vessel, and no other one");
  schema.choice("opening.kind", "pressure", {"pressure", "flow"}, "What is known there");
  schema.real("opening.pressure_Pa", 0, unlimited(),
              "pressure: at factor 1; behind a resistance: that of its far end");
  schema.real("opening.flow_mL_per_s", 0, unlimited(),
              "flow: into the fluid, at factor 1; exact on the grid");
  schema.choice("opening.profile", "uniform", {"uniform", "parabola"},
                "flow: even, or that of developed flow over the section, whatever its shape");
  declare_course(schema, "opening");
}

void declare_flow_probe(Schema& schema) {
  schema.tables("flow_probe", "Columns of history.csv and metrics of summary.json of a scene of fluid");
  schema.text("flow_probe.name", "", "Its name");
  schema.choice(
      "flow_probe.quantity", "velocity",
      {"velocity",          "pressure",       "profile",          "flow",        "section_pressure",
       "side_flow",         "opening_flow",   "opening_pressure", "force",       "moment",
       "wall_shear_stress", "momentum",       "kinetic_energy",   "dissipation", "enstrophy",
       "divergence",        "velocity_error", "pressure_error",   "step",        "pressure_iterations"},
      "At a point; along a line (own file); through a section or a side; on an obstacle; of the whole "
      "box; against exact expressions");
  schema.choice("flow_probe.component", "all", {"all", "x", "y", "z", "magnitude"},
                "Of velocity, force, moment, wall_shear_stress; all: three columns");
  schema.reals(
      "flow_probe.point_mm", {0, 0, 0}, 3, unlimited(),
      "velocity, pressure: the place; moment: about it; wall_shear_stress: of the wall nearest to it");
  schema.reals("flow_probe.minus_point_mm", {}, 0, unlimited(), "pressure: the difference to this point");
  schema.reals("flow_probe.line_mm", {}, 0, unlimited(), "profile: from and to, six numbers");
  schema.integer("flow_probe.points", 101, {2, 100000}, "profile: evenly spaced points");
  schema.text("flow_probe.side", "", "side_flow: x_low ... z_high; counted out of the box");
  schema.choice("flow_probe.axis", "z", {"x", "y", "z"},
                "flow, section_pressure: normal of the section, the plane of faces nearest to at_mm");
  schema.real("flow_probe.at_mm", 0, unlimited(), "Its place on that axis");
  schema.reals("flow_probe.low_mm", {-1e9, -1e9, -1e9}, 3, unlimited(), "Only faces above this corner");
  schema.reals("flow_probe.high_mm", {1e9, 1e9, 1e9}, 3, unlimited(), "and below this one");
  schema.text(
      "flow_probe.of", "",
      "force, moment: the obstacle or body; wall_shear_stress: the obstacle; opening_flow (out of the "
      "fluid), opening_pressure: the opening");
  schema.texts("flow_probe.with", {}, "force, moment: further obstacles and bodies, whose part is added");
  schema.real("flow_probe.reference_speed_mm_per_s", 0, not_negative(),
              "force: with it and the area, columns of coefficients, force / (density speed^2 area / 2)");
  schema.real("flow_probe.reference_area_mm2", 0, not_negative(), "The area");
  schema.texts(
      "flow_probe.exact", {},
      "velocity_error: three expressions of x, y, z, t (mm/s); pressure_error: one (Pa), up to a constant");
  schema.choice("flow_probe.norm", "rms", {"rms", "largest"}, "Of the errors");
}

}  // namespace valsalva
