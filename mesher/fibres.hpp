// Fibre directions of a leaflet: two families at plus and minus an angle to the mean direction, which runs
// from commissure to commissure.
//
// The mean direction is the gradient of a potential that is 0 at one commissure and 1 at the other and flows
// past free and attached edges (Laplace equation on the surface, linear elements); so it follows the free
// edge and hangs like a hammock in the belly. Such interpolation is used for bioprosthetic leaflets by Lee et
// al. 2020 (pulse-duplicator); Brown et al. 2022 name commissure to commissure as mean direction and 26.21
// degrees.
#pragma once

#include <vector>

#include "geometry/mesh.hpp"

namespace valsalva::mesher {

struct FibreField {
  Points first, second;  ///< one unit vector a triangle, tangent to it
};

/// potential: known[i] >= 0 is the prescribed value at vertex i; the others are solved for. At least two
/// values.
std::vector<double> harmonic(const geometry::TriMesh& mesh, const std::vector<double>& known);

FibreField fibre_families(const geometry::TriMesh& mesh, const std::vector<double>& potential,
                          double angle_deg);

/// Largest deviation from unit length and from tangency (component along the triangle's normal) of all
/// fibres.
double fibre_unit_error(const geometry::TriMesh& mesh, const FibreField& fibres);

}  // namespace valsalva::mesher
