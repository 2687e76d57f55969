// Elementary figures and topology of triangle surfaces. Lengths mm.
#pragma once

#include <map>
#include <vector>

#include "geometry/mesh.hpp"

namespace valsalva::geometry {

double surface_area(const TriMesh& mesh);

/// Sum of the signed tetrahedra from the origin; the enclosed volume when the surface is closed and outward.
double enclosed_volume(const TriMesh& mesh);

struct EdgeLengths {
  double shortest = 0;
  double mean = 0;
  double longest = 0;
};
EdgeLengths edge_lengths(const TriMesh& mesh);

/// Border edges in the direction of their triangle, chained to loops of vertex indices. The surface must be
/// manifold; a closed one has none.
std::vector<std::vector<int>> border_loops(const TriMesh& mesh);

/// The vertices that share an edge with each vertex, ascending.
std::vector<std::vector<int>> vertex_neighbours(const TriMesh& mesh);

/// Area-weighted unit normals at the vertices (zero where no triangle meets).
Points vertex_normals(const TriMesh& mesh);

/// Integral of |Gaussian curvature| over the interior vertices by the angle defect, in steradian: 0 for a
/// surface that unrolls into the plane, 2 pi for a hemispherical cup.
double total_gauss_curvature(const TriMesh& mesh);

/// Only the vertices that triangles use, renumbered in their order; origin[new] = old where asked for.
TriMesh compacted(const TriMesh& mesh, std::vector<int>* origin = nullptr);

}  // namespace valsalva::geometry
