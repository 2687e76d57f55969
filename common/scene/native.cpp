#include "scene/scene.hpp"

namespace valsalva {

void declare_native(Schema& schema) {
  schema.table("native", "Native aortic valve leaflets fitted to the root; absent: no native leaflets");
  schema.real("native.c10_kPa", 0.1463, positive(),
              "C10 of the Holzapfel-Gasser-Ogden law (Brown et al. 2022, table 1, healthy native leaflets)");
  schema.real("native.c01", 26.21, positive(), "C01 of the law (same table)");
  schema.real("native.k1_kPa", 7.072, not_negative(), "k1 of the two fibre families (same table)");
  schema.real("native.k2", 147.5, positive(), "k2 of the two fibre families (same table)");
  schema.real(
      "native.fibre_angle_deg", 26.21, {0, 90},
      "The families run at plus and minus this angle to the commissure-to-commissure direction (same table)");
  schema.real("native.stenosis_factor", 1, {1, 1e5},
              "Multiplies C10; 1000 is the severe stenosis of Brown et al. 2022");
  schema.real("native.belly_thickness_mm", 0.4, {0.05, 3}, "Thickness of the belly (Brown et al. 2022)");
  schema.real("native.nodule_thickness_mm", 0.92, {0.05, 4},
              "Thickness at the nodules of Arantius, mid free edge (Brown et al. 2022)");
  schema.real("native.nodule_radius_mm", 2.0, positive(), "Radius over which a nodule fades (assumed)");
  schema.real("native.rim_thickness_mm", 0.6, {0.05, 3}, "Thickness at the attachment (assumed)");
  schema.real("native.rim_width_mm", 1.5, positive(), "Distance over which the rim fades (assumed)");

  schema.real(
      "native.commissure_height_factor", 0.71, {0.4, 1.2},
      "Height of the commissures above the nadirs in annulus diameters (Swanson and Clark 1974); never above "
      "the sinotubular junction");
  schema.real("native.free_edge_factor", 1.24, {1, 2},
              "Length of a closed free edge in annulus diameters (Swanson and Clark 1974); more where the "
              "commissures stand too far apart for it");
  schema.real("native.coaptation_height_factor", 0.17, {0.05, 0.4},
              "Height of coaptation in annulus diameters (Swanson and Clark 1974)");
  schema.real("native.free_edge_excess", 0.03, {0, 0.3},
              "Relative length of free edge and leaflet beyond what the closed shape needs");
  schema.real(
      "native.closed_stretch", 0, {0, 1.3},
      "Stretch of the free edge in the closed, loaded valve, whose lengths the published ones are; 0: "
      "1.05, or 1 with a stenosis_factor above 10 (stiff leaflets do not stretch)");
  schema.real(
      "native.free_edge_peak_factor", 0.05, {0, 0.15},
      "Rise of the free edge at its middle in annulus diameters, so that the centre closes (assumed)");
  schema.real("native.commissure_gap_mm", 0.8, {0.1, 5},
              "Distance between neighbouring leaflets at a commissure: more than a rim thickness (assumed)");
  schema.real("native.attachment_inset_mm", 0.1, {0, 1}, "How deep the attached edge lies in the wall");

  schema.real("native.calcium_stiffness_factor", 100, {1, 1e5},
              "Stiffness of leaflet elements within reach of calcium, relative to tissue (assumed)");
  schema.real("native.calcium_reach_mm", 1.0, {0, 5},
              "Elements nearer than this to segmented calcium count as calcified (assumed)");
}

}  // namespace valsalva
