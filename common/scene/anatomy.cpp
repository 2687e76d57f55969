#include "scene/scene.hpp"

namespace valsalva {

void declare_anatomy(Schema& schema) {
  schema.table("anatomy", "Where the aortic root comes from and how its lumen is found");
  schema.choice(
      "anatomy.kind", "ct", {"ct", "labels", "surface", "phantom"},
      "What anatomy.image is: a contrast CT, a label map, a closed surface of the lumen; or a synthetic CT "
      "made from [phantom]");
  schema.text("anatomy.image", "",
              "CT or label map (.nrrd, .nhdr, .nii, .nii.gz, .mha, .mhd, or a folder with a DICOM series), "
              "or surface "
              "in mm (.stl, .ply, .obj, .off, .vtp)");
  schema.choice(
      "anatomy.coordinates", "LPS", {"LPS", "RAS"},
      "Patient coordinates of the points given here: x left, y back (LPS) or x right, y front (RAS); z to "
      "the head");
  schema.reals(
      "anatomy.annulus_centre_mm", {}, 0, unlimited(),
      "A point of the annulus plane inside the lumen, three numbers; empty: found from seeds or labels");
  schema.reals("anatomy.annulus_normal", {}, 0, unlimited(),
               "Normal of the annulus plane from ventricle to aorta, three numbers (any length)");
  schema.reals("anatomy.seeds_mm", {}, 0, unlimited(),
               "Points in contrast-filled blood, three numbers each: first in the outflow tract, last in the "
               "ascending "
               "aorta; empty: 8 mm below and 25 mm above the annulus");
  schema.reals("anatomy.labels", {}, 0, unlimited(), "Label map: the labels that make up the lumen");
  schema.reals("anatomy.annulus_labels", {}, 0, unlimited(),
               "Label map: ventricle and aorta; the annulus plane is fitted to where they touch");
  schema.real("anatomy.lumen_threshold_HU", 0, unlimited(),
              "Blood is brighter than this; absent: half way between blood near the seeds and soft tissue");
  schema.real("anatomy.calcium_threshold_HU", 0, unlimited(),
              "Calcium is brighter than this; absent: blood + the greater of 200 HU and six times the noise");
  schema.real("anatomy.metal_threshold_HU", 2000, positive(),
              "Brighter values are capped; bright pieces that reach it are metal, not calcium");
  schema.real("anatomy.min_calcium_mm3", 3, not_negative(), "Smaller bright pieces are noise");
  schema.real("anatomy.lower_cut_mm", 15, {5, 40},
              "Depth below the annulus at which the outflow tract is cut");
  schema.real("anatomy.upper_cut_mm", 45, {25, 100},
              "Height above the annulus at which the aorta is cut; lower where it leans too much");
  schema.real("anatomy.half_width_mm", 50, {25, 100}, "Half width of the working box around the axis");
  schema.real("anatomy.channel_margin_mm", 2.5, {0, 15},
              "How far the outflow tract may reach beyond the annulus contour; parts it from the ventricle");
  schema.real("anatomy.level_set_mm", {0.5, 0.5, 0.5, 0.4}, {0.2, 2}, "Sample spacing of the level set");
  schema.integer("anatomy.denoise_steps", 4, {0, 50}, "Steps of edge-preserving diffusion");
  schema.real("anatomy.closing_mm", 3, {0, 8}, "Leaflets and gaps narrower than twice this are filled");
  schema.real("anatomy.opening_mm", 2.5, {0, 8},
              "Side vessels and leaks narrower than twice this are removed");
  schema.real("anatomy.smoothing_mm", 1, {0, 5},
              "Length below which the surface is smoothed, at constant volume");
  schema.real("anatomy.lvot_below_mm", 5, {1, 15},
              "Depth below the annulus of the outflow tract's measurement");
}

void declare_phantom(Schema& schema) {
  schema.table("phantom",
               "The synthetic contrast CT made where anatomy.kind = \"phantom\" (every number assumed)");
  schema.real("phantom.annulus_mm", 22.5, {15, 35}, "Mean annulus diameter");
  schema.real("phantom.ovality", 0.85, {0.6, 1}, "Least over greatest annulus diameter");
  schema.real("phantom.lvot_mm", 23, {12, 40}, "Diameter of the outflow tract");
  schema.real("phantom.sinus_mm", 31.5, {18, 50}, "Largest diameter of the sinuses");
  schema.real("phantom.junction_mm", 26.5, {15, 45}, "Diameter of the sinotubular junction");
  schema.real("phantom.junction_height_mm", 20, {10, 30}, "Height of the junction above the annulus");
  schema.real("phantom.ascending_mm", 30, {15, 50}, "Diameter of the ascending aorta");
  schema.real("phantom.bend_radius_mm", 90, {50, 1000}, "Radius of the aorta's bend");
  schema.real("phantom.orifice_mm", 9, {3, 20}, "Opening left by the stenotic leaflets");
  schema.real("phantom.leaflet_mm", 1.6, {0.3, 3}, "Leaflet thickness");
  schema.real("phantom.commissure_rotation_deg", 20, {-180, 180}, "Angle of the first commissure");
  schema.integer("phantom.nodules", 12, {0, 60}, "Number of calcium nodules");
  schema.real("phantom.nodule_mm", 3.2, {0.5, 8}, "Mean diameter of the nodules");
  schema.reals("phantom.centre_mm", {6, -12, 20}, 3, unlimited(), "Annulus centre in the scanner (LPS)");
  schema.reals("phantom.axis", {-0.35, -0.25, 0.9}, 3, unlimited(),
               "Direction from ventricle to aorta (LPS)");
  schema.real("phantom.spacing_mm", 0.8, {0.4, 2}, "Voxel size");
  schema.real("phantom.blood_HU", 400, {200, 700}, "Contrast of the blood");
  schema.real("phantom.noise_HU", 18, {0, 100}, "Standard deviation of the noise");
  schema.real("phantom.blur_mm", 0.6, {0, 2}, "Standard deviation of the scanner's blur");
  schema.integer("phantom.seed", 20260101, {0, 1e15}, "Seed of nodules and noise");
}

}  // namespace valsalva
