// The velocity of developed laminar flow over a section of any shape: lap f = -1 in the section, f = 0 at its
// wall, by differences of second order (walls where the level set says, as in Gibou et al. 2002). On a disc
// of radius R: f = (R^2 - r^2) / 4.
#pragma once

#include <functional>

#include "core/types.hpp"

namespace valsalva::flow_scene {

/// fluid(x): distance to the wall, mm, positive in the fluid. The section: where it is positive on the plane
/// through `centre` within `radius`. spacing: of the differences, mm. The function has values on the plane,
/// mm2, 0 outside the section.
std::function<double(const Vec3&)> section_profile(const Vec3& centre, const Vec3& normal, double radius,
                                                   const std::function<double(const Vec3&)>& fluid,
                                                   double spacing);

}  // namespace valsalva::flow_scene
