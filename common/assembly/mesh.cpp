#include "assembly/mesh.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::assembly {
namespace {

/// Renumbers nodes: to[old] = new, or -1.
BodyMesh renumbered(const BodyMesh& mesh, const std::vector<int>& to, int count) {
  BodyMesh out = mesh;
  out.points.assign(count, Vec3::Zero());
  for (auto& [name, values] : out.fields) values.assign(count, 0);
  for (std::size_t a = mesh.points.size(); a-- > 0;) {
    if (to[a] < 0) continue;
    out.points[to[a]] = mesh.points[a];
    for (auto& [name, values] : out.fields) values[to[a]] = mesh.fields.at(name)[a];
  }
  for (Triangle& t : out.triangles)
    for (int& a : t) a = to[a];
  for (Edge& e : out.lines)
    for (int& a : e) a = to[a];
  for (SolidCell& s : out.solids)
    for (int& a : s.nodes) a = to[a];
  for (auto& [name, nodes] : out.groups) {
    for (int& a : nodes) a = to[a];
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    std::erase(nodes, -1);
  }
  return out;
}

}  // namespace

BodyMesh compacted(const BodyMesh& mesh) {
  std::vector<int> to(mesh.points.size(), -1);
  for (const Triangle& t : mesh.triangles)
    for (int a : t) to[a] = 0;
  for (const Edge& e : mesh.lines)
    for (int a : e) to[a] = 0;
  for (const SolidCell& s : mesh.solids)
    for (int a : s.nodes) to[a] = 0;
  int count = 0;
  for (int& a : to)
    if (a == 0) a = count++;
  return renumbered(mesh, to, count);
}

BodyMesh merged(const BodyMesh& mesh, double tolerance_mm) {
  std::map<std::array<long, 3>, std::vector<int>> cells;
  std::vector<int> to(mesh.points.size());
  int count = 0;
  for (std::size_t a = 0; a < mesh.points.size(); ++a) {
    std::array<long, 3> at;
    for (int d = 0; d < 3; ++d) at[d] = std::lround(mesh.points[a][d] / (4 * tolerance_mm));
    int same = -1;
    for (long i = -1; i <= 1 && same < 0; ++i)
      for (long j = -1; j <= 1 && same < 0; ++j)
        for (long k = -1; k <= 1 && same < 0; ++k) {
          const auto found = cells.find({at[0] + i, at[1] + j, at[2] + k});
          if (found == cells.end()) continue;
          for (int b : found->second)
            if ((mesh.points[b] - mesh.points[a]).norm() < tolerance_mm) same = b;
        }
    if (same < 0) cells[at].push_back(static_cast<int>(a));
    to[a] = same < 0 ? count++ : to[same];
  }
  BodyMesh out = renumbered(mesh, to, count);
  std::erase_if(out.triangles,
                [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[0] == t[2]; });
  std::erase_if(out.lines, [](const Edge& e) { return e[0] == e[1]; });
  return out;
}

std::vector<std::array<int, 2>> border_edges(const std::vector<Triangle>& triangles) {
  std::map<std::array<int, 2>, std::vector<std::array<int, 2>>> users;
  for (std::size_t e = 0; e < triangles.size(); ++e)
    for (int k = 0; k < 3; ++k) {
      const int a = triangles[e][k], b = triangles[e][(k + 1) % 3];
      users[{std::min(a, b), std::max(a, b)}].push_back({static_cast<int>(e), k});
    }
  std::vector<std::array<int, 2>> alone;
  for (const auto& [edge, list] : users)
    if (list.size() == 1) alone.push_back(list.front());
  return alone;
}

}  // namespace valsalva::assembly
