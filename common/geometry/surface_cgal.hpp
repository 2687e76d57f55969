// Conversion between plain meshes and CGAL's surface mesh; for the sources of this module only.
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include "core/errors.hpp"
#include "geometry/mesh.hpp"

namespace valsalva::geometry {

using CgalKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalPoint = CgalKernel::Point_3;
using CgalMesh = CGAL::Surface_mesh<CgalPoint>;

inline CgalPoint to_cgal(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}
inline Vec3 from_cgal(const CgalPoint& p) {
  return {p.x(), p.y(), p.z()};
}

/// The mesh must be manifold and consistently oriented.
inline CgalMesh to_cgal(const TriMesh& mesh) {
  CgalMesh result;
  for (const Vec3& p : mesh.points) result.add_vertex(to_cgal(p));
  using Vertex = CgalMesh::Vertex_index;
  for (const Triangle& t : mesh.triangles) {
    const auto face = result.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2]));
    VALSALVA_ASSERT(face != CgalMesh::null_face());
  }
  return result;
}

/// Collects garbage first, so that indices are dense.
inline TriMesh from_cgal(CgalMesh& mesh) {
  mesh.collect_garbage();
  TriMesh result;
  for (const auto vertex : mesh.vertices()) result.points.push_back(from_cgal(mesh.point(vertex)));
  for (const auto face : mesh.faces()) {
    Triangle triangle{};
    int k = 0;
    for (const auto vertex : vertices_around_face(mesh.halfedge(face), mesh))
      triangle[k++] = static_cast<int>(vertex.idx());
    result.triangles.push_back(triangle);
  }
  return result;
}

}  // namespace valsalva::geometry
