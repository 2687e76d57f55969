// The vessel in a field that is negative in blood: parted from its neighbours, cut at both ends, smoothed.
//
// A wall thinner than a voxel is only a little darker than the blood on both sides: walls are looked for at
// rising thresholds, up to the first at which the vessel comes apart from its neighbours. Lengths mm.
#pragma once

#include <string>

#include "lumen.hpp"

namespace valsalva::segment {

inline constexpr double vessel_ends_mm = 20;  ///< straight continuation while distances are taken
inline constexpr double vessel_reach_mm = 9;  ///< distances are right up to here, and every radius is smaller

/// From the raw field on the working grid to the open-ended lumen. The field rises by one spacing from blood
/// to the lumen's edge. seeds (LPS): points on both sides of the valve, so that leaflets that touch do not
/// part the vessel. InputError says what leaks where, or why there is too little.
Lumen vessel_of(geometry::GridSdf field, const Frame& frame, const std::vector<Vec3>& seeds,
                const LumenOptions& options, const Statistics& found);

/// The grid on which vessels are looked for: the working box with its ends.
template <class Function>
geometry::GridSdf working_grid(const LumenOptions& options, Function&& value) {
  const double w = options.half_width_mm;
  return geometry::sample(Vec3(-w, -w, -options.lower_cut_mm - vessel_ends_mm),
                          Vec3(w, w, options.upper_cut_mm + vessel_ends_mm), options.spacing_mm, value);
}

/// "(x, y, z) mm LPS", for messages.
std::string text_of(const Vec3& position);

}  // namespace valsalva::segment
