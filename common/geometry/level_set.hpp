// Level sets on dense grids: distance, surface, smoothing, components. The narrow-band work is OpenVDB's; the
// band is carried into the whole grid by fast sweeping (Zhao 2005, Math. Comp. 74, eq. 2.4), first order away
// from the band, which no wall or contact query reaches.
//
// Lengths mm; negative inside. Beyond the faces of the grid lies the outside, so a body that reaches a face
// is closed there; pad the grid where that matters.
#pragma once

#include "geometry/grid_sdf.hpp"
#include "geometry/mesh.hpp"

namespace valsalva::geometry {

/// Signed distance to the zero level of any continuous field (only its zero level and its sign count).
/// Farther away than `reach_mm` only the sign is right, and the size is at least the reach.
GridSdf redistanced(const GridSdf& field, double reach_mm = 1e9);

/// Signed distance to a closed surface, on the grid of `shape` (its values are not read).
GridSdf signed_distance(const TriMesh& closed, const GridSdf& shape);

/// The zero level as triangles, outward (towards positive). Open where it meets no face; see above.
TriMesh zero_surface(const GridSdf& field);

/// Mean curvature flow for the pseudo-time length^2 / 2 (features below `length_mm` go), then an offset of
/// the whole surface that restores the volume to 1e-4. Argument and result are signed distances.
GridSdf smoothed(const GridSdf& distance, double length_mm);

/// Volume where the signed distance is negative, by a Heaviside function smeared over one spacing; mm3.
double volume_inside(const GridSdf& distance);

/// The parts of the inside that are connected to the samples nearest to the seeds (6 neighbours); every other
/// inside sample gets +spacing / 2. Empty (all positive) when all seeds are outside.
GridSdf component_at(const GridSdf& field, const std::vector<Vec3>& seeds);

/// Outside samples that no path of outside samples joins to a face of the grid become inside.
GridSdf without_cavities(const GridSdf& field);

/// Samples [low, high] of the grid, both included, in each direction.
GridSdf cropped(const GridSdf& field, const std::array<int, 3>& low, const std::array<int, 3>& high);

}  // namespace valsalva::geometry
