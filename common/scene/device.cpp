#include "scene/scene.hpp"

namespace valsalva {

namespace {

void declare_frame(Schema& schema) {
  schema.choice(
      "device.frame", "supra-annular", {"supra-annular", "cylinder", "graph"},
      "Where the frame comes from: the library of self-expanding supra-annular sizes, a plain cylinder "
      "(tests), or a centreline graph file (device.graph_file)");
  schema.real(
      "device.size_mm", 0, {0, 60},
      "Nominal size: 23, 26, 29 or 34 of the library, the outer diameter of a cylinder; 0: what segment "
      "recommends");
  schema.text("device.graph_file", "",
              "Centreline graph (JSON, docs/stent.md), for device.frame = \"graph\"");
  schema.integer("device.cells", 0, {0, 60},
                 "Diamond cells around; 0: the library's number (leaflets need a multiple of 3)");
  schema.reals(
      "device.level_heights_mm", {}, 0, not_negative(),
      "Heights of the rows of strut crossings above the inflow, ascending from 0; empty: the library's");
  schema.reals("device.profile_mm", {}, 0, not_negative(),
               "Outer diameter along the height as pairs height, diameter; empty: the library's");
  schema.real("device.strut_width_mm", 0, {0, 2}, "Circumferential strut width; 0: the library's");
  schema.real("device.strut_depth_mm", 0, {0, 2}, "Radial strut depth; 0: the library's");
  schema.integer("device.beams_per_strut", 4, {1, 20}, "Beam elements from one strut crossing to the next");
  schema.real(
      "device.frame_youngs_modulus_GPa", 50, positive(),
      "Young's modulus of the frame: Nitinol taken as elastic (assumed; published austenite values 52-63)");
  schema.real("device.frame_poisson", 0.33, {0, 0.5},
              "Poisson number of the frame (published decks: 0.30-0.33)");
  schema.real("device.frame_density_g_per_mm3", 6.45e-3, positive(), "Density of Nitinol");
  schema.choice("device.frame_law", "linear", {"linear", "superelastic"},
                "Law of the struts: linear with frame_youngs_modulus_GPa, or superelastic with the loops of "
                "frame_alloy (the modulus and Poisson's ratio above are then those of the alloy)");
  schema.choice("device.frame_alloy", "nitinol-62.9", {"nitinol-62.9", "nitinol-51.7"},
                "Published parameter set of the superelastic law (common/materials/superelastic.cpp)");
  schema.integer("device.frame_fibres", 6, {2, 20},
                 "Fibres over the width and over the depth of a superelastic strut");
}

void declare_tissue(Schema& schema) {
  schema.boolean("device.tissue", true, "Are leaflets and skirt sewn to the frame?");
  schema.real("device.thickness_mm", 0.34, {0.05, 1},
              "Thickness of leaflets and skirt (Brown et al. 2022, figure 2)");
  schema.real("device.gap_mm", 0.05, {0.001, 1},
              "Free space between strut and skirt, skirt and leaflet, leaflet and leaflet (assumed): contact "
              "does not start active");
  schema.real("device.leaflet_edge_mm", {0.5, 0.37, 0.25, 0.2}, {0.1, 3},
              "Edge length of leaflet triangles: half the fluid grid's spacing or less");
  schema.real("device.skirt_edge_mm", {1.0, 0.75, 0.5, 0.4}, {0.1, 3}, "Edge length of skirt triangles");
  schema.real("device.nadir_height_mm", 0, {0, 40},
              "Height of the lowest point of the leaflets' attachment above the inflow; 0: the library's");
  schema.real("device.commissure_height_mm", 0, {0, 60},
              "Height of the commissures above the inflow, a row of crossings; 0: the library's");
  schema.real("device.free_edge_peak_mm", 1.0, {0, 5},
              "Rise of the flat leaflet's free edge from the commissures to its middle (assumed)");
  schema.real(
      "device.free_edge_excess", 0.03, {-0.1, 0.3},
      "Relative length of the free edge beyond a third of the circumference at the commissures (assumed; "
      "less leaves a central hole, more flutters)");

  schema.real("device.c10_kPa", 15.14, positive(),
              "C10 of the Holzapfel-Gasser-Ogden law (Brown et al. 2022, table 1, porcine pericardium)");
  schema.real("device.c01", 13.48, positive(), "C01 of the law (same table)");
  schema.real("device.k1_kPa", 152.6, not_negative(), "k1 of the two fibre families (same table)");
  schema.real("device.k2", 107.3, positive(), "k2 of the two fibre families (same table)");
  schema.real("device.fibre_angle_deg", 7.81, {0, 90},
              "The families run at plus and minus this angle to the mean direction (same table)");
  schema.real(
      "device.leaflet_mean_fibre_deg", 45, {-90, 90},
      "Mean fibre direction of the leaflets, from the circumference towards the outflow (Brown et al. 2022)");
  schema.real("device.skirt_mean_fibre_deg", 90, {-90, 90},
              "Mean fibre direction of the skirt; 90 is parallel to the flow (Brown et al. 2022)");
  schema.real(
      "device.bending_modulus_MPa", 1.22, not_negative(),
      "Young's modulus in bending of leaflets and skirt: 6 C10 C01, the law's modulus at rest (assumed)");
  schema.real("device.tissue_density_g_per_mm3", 1.1e-3, positive(),
              "Density of fixed pericardium (assumed)");
}

}  // namespace

void declare_device(Schema& schema) {
  schema.table("device", "The transcatheter valve: frame, leaflets and skirt; absent: no device");
  declare_frame(schema);
  declare_tissue(schema);
}

}  // namespace valsalva
