#include "from_case.hpp"

namespace valsalva::segment {
namespace {

Vec3 vector(const std::vector<double>& numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

Phantom phantom_of(const Case& scene) {
  PhantomShape shape;
  shape.annulus_mm = scene.real("phantom.annulus_mm");
  shape.ovality = scene.real("phantom.ovality");
  shape.lvot_mm = scene.real("phantom.lvot_mm");
  shape.sinus_mm = scene.real("phantom.sinus_mm");
  shape.junction_mm = scene.real("phantom.junction_mm");
  shape.junction_height_mm = scene.real("phantom.junction_height_mm");
  shape.ascending_mm = scene.real("phantom.ascending_mm");
  shape.bend_radius_mm = scene.real("phantom.bend_radius_mm");
  shape.orifice_mm = scene.real("phantom.orifice_mm");
  shape.leaflet_mm = scene.real("phantom.leaflet_mm");
  shape.commissure_rotation_deg = scene.real("phantom.commissure_rotation_deg");
  shape.nodules = int(scene.integer("phantom.nodules"));
  shape.nodule_mm = scene.real("phantom.nodule_mm");
  PhantomScan scan;
  scan.annulus_centre = vector(scene.reals("phantom.centre_mm"));
  scan.axis = vector(scene.reals("phantom.axis"));
  scan.spacing_mm = scene.real("phantom.spacing_mm");
  scan.blood = scene.real("phantom.blood_HU");
  scan.noise = scene.real("phantom.noise_HU");
  scan.blur_mm = scene.real("phantom.blur_mm");
  scan.seed = std::uint64_t(scene.integer("phantom.seed"));
  return make_phantom(shape, scan);
}

}  // namespace valsalva::segment
