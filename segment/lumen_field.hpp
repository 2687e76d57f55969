// Steps of the segmentation on the working grid, each a field to a field; negative inside.
#pragma once

#include "geometry/grid_sdf.hpp"
#include "geometry/planes.hpp"

namespace valsalva::segment {

/// Fills gaps narrower than twice the radius. In and out: signed distances, right up to a few mm.
geometry::GridSdf closed(const geometry::GridSdf& distance, double radius_mm);
/// Removes parts narrower than twice the radius and what hangs on them; keeps the pieces at the seeds.
geometry::GridSdf parted(const geometry::GridSdf& distance, double radius_mm, const std::vector<Vec3>& seeds);
/// The part of `field` at most `margin_mm` outside of `body`, a signed distance.
geometry::GridSdf within(const geometry::GridSdf& field, const geometry::GridSdf& body, double margin_mm);
/// The space that is searched: above z_lower, within 20 mm of the axis below the annulus, 24 mm at it,
/// opening by 45 degrees above.
double guard_radius(double z_mm, double half_width_mm);
void limit_to_guard(geometry::GridSdf& field, double half_width_mm, double z_lower_mm);
/// Below z = 0 only what lies within `margin` of the contour's inside stays.
void limit_to_channel(geometry::GridSdf& field, const geometry::Loop& annulus, double margin_mm);
/// Every layer below z_lower (above z_upper) becomes the layer at that height.
void continue_straight(geometry::GridSdf& field, double z_lower_mm, double z_upper_mm);
/// Does the inside come within a sample of the guard, between the two heights? Where first.
bool touches_guard(const geometry::GridSdf& field, double z_lower_mm, double z_upper_mm, double half_width_mm,
                   Vec3* where);

}  // namespace valsalva::segment
