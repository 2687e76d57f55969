// Where the annulus plane is not given: found between two labels, or from seeds alone.
#pragma once

#include "lumen.hpp"

namespace valsalva::segment {

/// The plane between two labels: centroid and normal (from upstream to downstream) of the voxels of
/// `downstream` that touch `upstream`. InputError when they do not touch.
Frame interface_of(const Image& labels, double upstream, double downstream);

/// The narrowest section between the upstream seed and the widest section (the sinuses) on the way to the
/// downstream seed.
Frame annulus_from_seeds(const Image& image, const std::vector<Vec3>& seeds, const LumenOptions& options);

}  // namespace valsalva::segment
