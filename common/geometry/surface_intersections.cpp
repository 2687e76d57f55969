#include "geometry/surface_intersections.hpp"

#include <CGAL/Polygon_mesh_processing/self_intersections.h>

#include <algorithm>

#include "geometry/surface_cgal.hpp"

namespace valsalva::geometry {

std::vector<std::pair<int, int>> self_intersections(const TriMesh& mesh) {
  const CgalMesh surface = to_cgal(mesh);
  std::vector<std::pair<CgalMesh::Face_index, CgalMesh::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(found));
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [a, b] : found) {
    const auto [low, high] = std::minmax({static_cast<int>(a.idx()), static_cast<int>(b.idx())});
    pairs.emplace_back(low, high);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace valsalva::geometry
