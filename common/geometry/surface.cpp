#include "geometry/surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/errors.hpp"

namespace valsalva::geometry {
namespace {

Vec3 double_area_vector(const TriMesh& mesh, const Triangle& t) {
  return (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]);
}

/// The start of each border edge -> its end.
std::map<int, int> border_successors(const TriMesh& mesh) {
  std::set<Edge> directed;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) directed.insert({t[k], t[(k + 1) % 3]});
  std::map<int, int> next;
  for (const Edge& edge : directed)
    if (!directed.count({edge[1], edge[0]})) next[edge[0]] = edge[1];
  return next;
}

}  // namespace

double surface_area(const TriMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += 0.5 * double_area_vector(mesh, t).norm();
  return sum;
}

double enclosed_volume(const TriMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]])) / 6;
  return sum;
}

EdgeLengths edge_lengths(const TriMesh& mesh) {
  std::set<Edge> edges;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      edges.insert({low, high});
    }
  EdgeLengths lengths;
  if (edges.empty()) return lengths;
  lengths.shortest = std::numeric_limits<double>::infinity();
  for (const Edge& e : edges) {
    const double length = (mesh.points[e[0]] - mesh.points[e[1]]).norm();
    lengths.shortest = std::min(lengths.shortest, length);
    lengths.longest = std::max(lengths.longest, length);
    lengths.mean += length / edges.size();
  }
  return lengths;
}

std::vector<std::vector<int>> border_loops(const TriMesh& mesh) {
  auto next = border_successors(mesh);
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int> loop;
    const int start = next.begin()->first;
    for (int at = start; next.count(at);) {
      loop.push_back(at);
      const int to = next[at];
      next.erase(at);
      at = to;
    }
    loops.push_back(loop);
  }
  return loops;
}

std::vector<std::vector<int>> vertex_neighbours(const TriMesh& mesh) {
  std::vector<std::vector<int>> neighbours(mesh.points.size());
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      for (int other : {t[(k + 1) % 3], t[(k + 2) % 3]}) neighbours[t[k]].push_back(other);
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

Points vertex_normals(const TriMesh& mesh) {
  Points normals(mesh.points.size(), Vec3::Zero());
  for (const Triangle& t : mesh.triangles)
    for (int node : t) normals[node] += double_area_vector(mesh, t);
  for (Vec3& n : normals)
    if (n.norm() > 0) n.normalize();
  return normals;
}

double total_gauss_curvature(const TriMesh& mesh) {
  std::vector<double> angles(mesh.points.size(), 0.0);
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = mesh.points[t[(k + 1) % 3]] - mesh.points[t[k]];
      const Vec3 b = mesh.points[t[(k + 2) % 3]] - mesh.points[t[k]];
      angles[t[k]] += std::atan2(a.cross(b).norm(), a.dot(b));
    }
  std::vector<char> inside(mesh.points.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (int node : t) inside[node] = 1;
  for (const auto& [from, to] : border_successors(mesh)) inside[from] = inside[to] = 0;
  double sum = 0;
  for (std::size_t i = 0; i < angles.size(); ++i)
    if (inside[i]) sum += std::abs(2 * std::numbers::pi - angles[i]);
  return sum;
}

TriMesh compacted(const TriMesh& mesh, std::vector<int>* origin) {
  std::vector<int> index(mesh.points.size(), -1);
  for (const Triangle& t : mesh.triangles)
    for (int node : t) index[node] = 0;
  TriMesh result;
  if (origin) origin->clear();
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] < 0) continue;
    index[i] = static_cast<int>(result.points.size());
    result.points.push_back(mesh.points[i]);
    if (origin) origin->push_back(static_cast<int>(i));
  }
  for (const Triangle& t : mesh.triangles)
    result.triangles.push_back({index[t[0]], index[t[1]], index[t[2]]});
  return result;
}

}  // namespace valsalva::geometry
