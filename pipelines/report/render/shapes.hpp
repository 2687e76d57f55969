// Surfaces to draw, and how they are made from meshes: tubes from struts, boundary of a solid, half-space
// cuts, cross-sections. Lengths in mm.
#pragma once

#include <functional>
#include <vector>

#include "core/types.hpp"
#include "render/image.hpp"

namespace valsalva::report {

struct Surface {
  Points points;
  std::vector<Triangle> triangles;
  Colour colour{0.7f, 0.7f, 0.7f};
  std::vector<Colour> point_colours;  ///< replaces `colour` when given; one a point
  std::vector<float> point_opacity;   ///< multiplies `opacity` when given; one a point
  double opacity = 1;
  bool lit = true;     ///< false: the colour itself (data shown by colour)
  bool smooth = true;  ///< false: one normal a triangle
  bool glass = false;  ///< more opaque where seen at a grazing angle: a hull that shows its inside
  bool edges = false;  ///< draw the edges of the triangles
};

/// Half-space: keeps the triangles all of whose corners satisfy `keep`; points stay, indices too.
Surface clip(const Surface& surface, const std::function<bool(const Vec3&)>& keep);

/// Struts as tubes of `sides` sides; radius per edge. Ends are closed by a shared ring of half-spheres' worth
/// of overlap: each tube is lengthened by half its radius.
Surface tubes(const Points& points, const std::vector<Edge>& edges, const std::vector<double>& radius,
              int sides);

/// Triangles that belong to one tetrahedron only, seen from outside, among the tetrahedra that `keep` accepts
/// by centroid.
Surface boundary(const Points& points, const std::vector<Tetrahedron>& tetrahedra,
                 const std::function<bool(const Vec3&)>& keep);

/// At most `triangles` triangles, by merging the points in the cells of a grid that grows until it is coarse
/// enough.
Surface simplified(const Surface& surface, std::size_t triangles);

/// Where the plane through `origin` with `normal` cuts the triangles: pairs of points.
std::vector<std::array<Vec3, 2>> cross_section(const Points& points, const std::vector<Triangle>& triangles,
                                               const Vec3& origin, const Vec3& normal);

/// Segments as tubes of one radius.
Surface strokes(const std::vector<std::array<Vec3, 2>>& segments, double radius);

struct Box {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  void add(const Points& points);
  bool empty() const { return low.x() > high.x(); }
};

}  // namespace valsalva::report
