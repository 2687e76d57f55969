// Cutting a closed surface by planes z = const.
#pragma once

#include "geometry/mesh.hpp"

namespace valsalva::geometry {

/// The part between two planes z = const, closed again by plane caps. Vertices within 1e-3 of the mean edge
/// of a plane are moved onto it. InputError when a plane misses the surface.
TriMesh cut_closed_between(const TriMesh& closed, double low_z, double high_z);

/// Removes the triangles that lie in the planes z = low_z and z = high_z.
TriMesh without_caps(const TriMesh& mesh, double low_z, double high_z);

}  // namespace valsalva::geometry
