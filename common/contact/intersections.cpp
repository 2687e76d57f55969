#include "contact/intersections.hpp"

#include <Eigen/Geometry>

#include "contact/broad_phase.hpp"

namespace valsalva::contact {

bool segment_crosses_triangle(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto volume = [](const Vec3& o, const Vec3& u, const Vec3& v, const Vec3& w) {
    return (u - o).cross(v - o).dot(w - o);
  };
  const double sp = volume(a, b, c, p), sq = volume(a, b, c, q);
  if (!((sp > 0 && sq < 0) || (sp < 0 && sq > 0))) return false;
  const double s0 = volume(p, q, a, b), s1 = volume(p, q, b, c), s2 = volume(p, q, c, a);
  return (s0 > 0 && s1 > 0 && s2 > 0) || (s0 < 0 && s1 < 0 && s2 < 0);
}

std::vector<std::array<int, 2>> crossings(const CollisionMesh& mesh, const Points& x) {
  const auto box = [&](const auto& nodes) {
    Box b{x[nodes[0]], x[nodes[0]]};
    for (int n : nodes) {
      b.low = b.low.cwiseMin(x[n]);
      b.high = b.high.cwiseMax(x[n]);
    }
    return b;
  };
  std::vector<Box> edges, faces;
  for (const auto& e : mesh.edges()) edges.push_back(box(e.node));
  for (const auto& f : mesh.faces()) faces.push_back(box(f.node));
  std::vector<std::array<int, 2>> found;
  for (const auto& pair : overlapping_boxes(edges, faces, false)) {
    const auto& e = mesh.edges()[pair[0]].node;
    const auto& f = mesh.faces()[pair[1]].node;
    bool neighbours = false;
    for (int n : e)
      for (int m : f) neighbours = neighbours || mesh.identity(n) == mesh.identity(m);
    if (!neighbours && segment_crosses_triangle(x[e[0]], x[e[1]], x[f[0]], x[f[1]], x[f[2]]))
      found.push_back(pair);
  }
  return found;
}

}  // namespace valsalva::contact
