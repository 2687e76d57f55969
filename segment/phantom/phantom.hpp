// A synthetic contrast CT of an aortic root with stenotic leaflets, from a parametric shape and a fixed seed.
//
// Root: outflow tract, oval annulus, three sinuses r = r_base(z) + bulge sin^2(pi z / h_stj) (1 + cos 3(a -
// a0)) / 2, junction, ascending aorta bent to a circular arc. Beside it: part of the ventricle, myocardium,
// coronary arteries, a left atrium behind a thin wall, fat and lung. Leaflets are sheets from a crown-shaped
// attachment to a narrow opening; calcium nodules sit on them. Then partial volume (edges ramp over one
// voxel), Gaussian blur, noise. The segmentation knows none of this: it reads the image file.
#pragma once

#include <cstdint>

#include "image.hpp"

namespace valsalva::segment {

struct PhantomShape {
  double annulus_mm = 22.5;  ///< mean diameter
  double ovality = 0.85;     ///< least over greatest diameter of the annulus
  double lvot_mm = 23;
  double sinus_mm = 31.5;  ///< largest mean diameter
  double junction_mm = 26.5;
  double junction_height_mm = 20;
  double ascending_mm = 30;
  double bend_radius_mm = 90;
  double orifice_mm = 9;    ///< opening left by the stenotic leaflets
  double leaflet_mm = 1.6;  ///< thickness
  double commissure_rotation_deg = 20;
  int nodules = 12;
  double nodule_mm = 3.2;  ///< mean diameter
};

struct PhantomScan {
  Vec3 annulus_centre = Vec3(6, -12, 20);  ///< LPS, mm
  Vec3 axis = Vec3(-0.35, -0.25, 0.9);
  double spacing_mm = 0.8;
  double half_width_mm = 56;
  double blood = 400, tissue = 100, leaflet = 130, calcium = 1000, fat = -80, lung = -800;  ///< HU
  double blur_mm = 0.6;  ///< standard deviation of the blur
  double noise = 18;     ///< HU
  std::uint64_t seed = 20260101;
};

struct Phantom {
  Image image;
  double calcium_mm3 = 0;  ///< true volume of the nodules, by voxel counts before the blur
  double lumen_mm3 = 0;    ///< of the root between annulus and junction, leaflets included
};

Phantom make_phantom(const PhantomShape& shape, const PhantomScan& scan);

}  // namespace valsalva::segment
