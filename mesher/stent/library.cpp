#include "library.hpp"

#include <algorithm>

#include "core/errors.hpp"

namespace valsalva::stent {

namespace {

// All assumed. Inflow: the nominal size, by which the device is named. Waist, outflow and height of the 26 mm
// device: 22, 32 and 45 mm; of the others: scaled to keep the waist (leaflets) 20 to 24 mm and the outflow 34
// to 38 mm, as descriptions of the family give them.
struct Proportions {
  double size, waist, outflow, height;
};
constexpr Proportions proportions[] = {
    {23, 20, 34, 45}, {26, 22, 32, 45}, {29, 23, 34, 45}, {34, 24, 38, 46}};

// Assumed: eight rows of crossings, seven half cells of 6.2-6.8 mm. Struts that steep lengthen the frame by
// 6-10 % when it closes, which tissue sewn to it can follow.
const std::vector<double> rows_of_45mm{0, 6.2, 12.6, 19.2, 26.0, 32.2, 38.6, 45.0};

// Assumed: where along the height (relative) the profile passes from inflow to waist to outflow.
FrameDesign frame_of(const Proportions& p) {
  FrameDesign frame;
  frame.cells = 15;
  const double stretch = p.height / rows_of_45mm.back();
  for (double z : rows_of_45mm) frame.level_mm.push_back(z * stretch);
  const auto between = [](double a, double b, double share) { return a + share * (b - a); };
  frame.profile_mm = {{0, p.size},
                      {6 * stretch, between(p.size, p.waist, 0.25)},
                      {13 * stretch, between(p.size, p.waist, 0.70)},
                      {20 * stretch, p.waist},
                      {26 * stretch, between(p.waist, p.outflow, 0.03)},
                      {36 * stretch, between(p.waist, p.outflow, 0.55)},
                      {45 * stretch, p.outflow}};
  frame.width_mm = 0.25;
  frame.depth_mm = 0.45;
  return frame;
}

}  // namespace

Device supra_annular(double size_mm) {
  const auto* found = std::find_if(std::begin(proportions), std::end(proportions),
                                   [&](const Proportions& p) { return p.size == size_mm; });
  if (found == std::end(proportions))
    throw InputError(
        "device.size_mm: the library has no supra-annular frame of {} mm; expected 23, 26, 29 or 34",
        size_mm);
  Device device;
  device.name = fmt::format("supra-annular {:g}", size_mm);
  device.nominal_size_mm = size_mm;
  device.frame = frame_of(*found);
  device.commissure_mm = device.frame.level_mm[4];
  device.nadir_mm = 10.0 * found->height / rows_of_45mm.back();
  return device;
}

Device cylinder(double diameter_mm) {
  Device device;
  device.name = fmt::format("cylinder {:g}", diameter_mm);
  device.nominal_size_mm = diameter_mm;
  device.frame.cells = 12;
  device.frame.level_mm = {0, 5, 10, 15, 20};
  device.frame.profile_mm = {{0, diameter_mm}};
  device.frame.width_mm = 0.25;
  device.frame.depth_mm = 0.35;
  device.commissure_mm = 20;
  device.nadir_mm = 7;
  return device;
}

}  // namespace valsalva::stent
