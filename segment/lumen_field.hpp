// Steps of the segmentation on the working grid, each a field to a field; negative inside.
#pragma once

#include "geometry/grid_sdf.hpp"
#include "geometry/planes.hpp"

namespace valsalva::segment {

/// Fills gaps narrower than twice the radius. In and out: signed distances, right up to a few mm.
geometry::GridSdf closed(const geometry::GridSdf& distance, double radius_mm);
/// Removes parts narrower than twice the radius and what hangs on them; keeps the pieces at the seeds, and
/// their corners: all of the inside within `corner_mm` of the opened body stays.
geometry::GridSdf parted(const geometry::GridSdf& distance, double radius_mm, double corner_mm,
                         const std::vector<Vec3>& seeds);
/// Below z = 0 only what lies within `margin` of the contour's inside stays.
void limit_to_channel(geometry::GridSdf& field, const geometry::Loop& annulus, double margin_mm);
/// Every layer below z_lower (above z_upper) becomes the layer at that height.
void continue_straight(geometry::GridSdf& field, double z_lower_mm, double z_upper_mm);
/// Does the inside touch a side face (x or y) between the two heights? Where first.
bool touches_side(const geometry::GridSdf& field, double z_lower_mm, double z_upper_mm, Vec3* where);

}  // namespace valsalva::segment
