#include "geometry/repair_soup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/errors.hpp"
#include "geometry/surface.hpp"

namespace valsalva::geometry {
namespace {

void require_sound_numbers(const TriMesh& raw, const std::string& name) {
  if (raw.triangles.empty()) throw InputError("{}: the surface has no triangles", name);
  const int count = static_cast<int>(raw.points.size());
  for (std::size_t i = 0; i < raw.points.size(); ++i)
    if (!raw.points[i].allFinite())
      throw InputError("{}: vertex {} has a coordinate that is not finite", name, i);
  for (std::size_t i = 0; i < raw.triangles.size(); ++i)
    for (int node : raw.triangles[i])
      if (node < 0 || node >= count)
        throw InputError("{}: triangle {} refers to vertex {}, but there are {}", name, i, node, count);
}

/// The first vertex within the tolerance stands for all of them.
std::vector<int> weld(const Points& points, double tolerance) {
  using Cell = std::array<std::int64_t, 3>;
  std::map<Cell, std::vector<int>> grid;
  std::vector<int> stands_for(points.size());
  const double width = 2 * tolerance;
  for (std::size_t i = 0; i < points.size(); ++i) {
    Cell cell{};
    for (int d = 0; d < 3; ++d) cell[d] = static_cast<std::int64_t>(std::floor(points[i][d] / width));
    stands_for[i] = static_cast<int>(i);
    for (int n = 0; n < 27; ++n) {
      const auto found = grid.find({cell[0] + n % 3 - 1, cell[1] + n / 3 % 3 - 1, cell[2] + n / 9 - 1});
      if (found == grid.end()) continue;
      for (int other : found->second)
        if ((points[other] - points[i]).norm() <= tolerance) stands_for[i] = std::min(stands_for[i], other);
    }
    if (stands_for[i] == static_cast<int>(i)) grid[cell].push_back(static_cast<int>(i));
  }
  return stands_for;
}

Edge undirected(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

std::map<Edge, int> edge_uses(const std::vector<Triangle>& triangles) {
  std::map<Edge, int> uses;
  for (const Triangle& t : triangles)
    for (int k = 0; k < 3; ++k) ++uses[undirected(t[k], t[(k + 1) % 3])];
  return uses;
}

/// Removes triangles with an edge of three or more sheets and an edge of their own, until there are none.
std::size_t remove_fins(std::vector<Triangle>& triangles) {
  const std::size_t before = triangles.size();
  for (bool removed = true; removed;) {
    const auto uses = edge_uses(triangles);
    const std::size_t count = triangles.size();
    std::erase_if(triangles, [&](const Triangle& t) {
      bool crowded = false, free = false;
      for (int k = 0; k < 3; ++k) {
        const int n = uses.at(undirected(t[k], t[(k + 1) % 3]));
        crowded = crowded || n > 2;
        free = free || n == 1;
      }
      return crowded && free;
    });
    removed = triangles.size() < count;
  }
  return before - triangles.size();
}

}  // namespace

TriMesh clean_soup(const TriMesh& raw, const std::string& name, std::vector<std::string>& actions) {
  require_sound_numbers(raw, name);
  const auto stands_for = weld(raw.points, 1e-4 * std::max(edge_lengths(raw).mean, 1e-12));
  TriMesh mesh{raw.points, {}};
  std::set<int> merged;
  std::set<std::array<int, 3>> seen;
  std::size_t degenerate = 0, doubled = 0;
  for (const Triangle& t : raw.triangles) {
    const Triangle welded{stands_for[t[0]], stands_for[t[1]], stands_for[t[2]]};
    for (int k = 0; k < 3; ++k)
      if (welded[k] != t[k]) merged.insert(t[k]);
    if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) {
      ++degenerate;
      continue;
    }
    auto key = welded;
    std::sort(key.begin(), key.end());
    if (!seen.insert(key).second) {
      ++doubled;
      continue;
    }
    mesh.triangles.push_back(welded);
  }
  if (!merged.empty()) actions.push_back(fmt::format("{} coincident vertices welded", merged.size()));
  if (degenerate) actions.push_back(fmt::format("{} degenerate triangles dropped", degenerate));
  if (doubled) actions.push_back(fmt::format("{} doubled triangles dropped", doubled));
  if (const std::size_t fins = remove_fins(mesh.triangles))
    actions.push_back(fmt::format("{} fin triangles removed", fins));

  std::size_t crowded = 0;
  Vec3 place = Vec3::Zero();
  for (const auto& [edge, uses] : edge_uses(mesh.triangles)) {
    if (uses <= 2) continue;
    if (!crowded++) place = 0.5 * (mesh.points[edge[0]] + mesh.points[edge[1]]);
  }
  if (crowded)
    throw InputError(
        "{}: {} non-manifold edges (three or more triangles on one edge), the first near ({:.2f}, {:.2f}, "
        "{:.2f}) mm; "
        "expected a surface with two triangles on every edge: separate the sheets there",
        name, crowded, place.x(), place.y(), place.z());
  return compacted(mesh);
}

namespace {

/// The triangles at each edge, by number; one or two after clean_soup.
std::map<Edge, std::vector<int>> triangles_by_edge(const std::vector<Triangle>& triangles) {
  std::map<Edge, std::vector<int>> at;
  for (std::size_t i = 0; i < triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      at[undirected(triangles[i][k], triangles[i][(k + 1) % 3])].push_back(static_cast<int>(i));
  return at;
}

bool runs_along(const Triangle& t, int from, int to) {
  return (t[0] == from && t[1] == to) || (t[1] == from && t[2] == to) || (t[2] == from && t[0] == to);
}

/// Where two fans meet in one vertex, every fan after the first gets its own copy.
std::size_t split_pinched_vertices(TriMesh& mesh) {
  std::vector<std::vector<int>> fans(mesh.points.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int node : mesh.triangles[i]) fans[node].push_back(static_cast<int>(i));
  const std::size_t before = mesh.points.size();
  for (std::size_t node = 0; node < before; ++node) {
    std::vector<int> left = fans[node];
    for (bool first = true; !left.empty(); first = false) {
      std::vector<int> fan{left.front()};
      left.erase(left.begin());
      for (std::size_t n = 0; n < fan.size(); ++n)
        std::erase_if(left, [&](int candidate) {
          int shared = 0;
          for (int a : mesh.triangles[fan[n]])
            for (int b : mesh.triangles[candidate]) shared += a == b;
          if (shared == 2) fan.push_back(candidate);
          return shared == 2;
        });
      if (first) continue;
      for (int triangle : fan)
        std::replace(mesh.triangles[triangle].begin(), mesh.triangles[triangle].end(), static_cast<int>(node),
                     static_cast<int>(mesh.points.size()));
      mesh.points.push_back(mesh.points[node]);
    }
  }
  return mesh.points.size() - before;
}

}  // namespace

TriMesh oriented_soup(const TriMesh& input, const std::string& name, std::vector<std::string>& actions) {
  TriMesh mesh = input;
  const auto at = triangles_by_edge(mesh.triangles);
  std::vector<char> settled(mesh.triangles.size(), 0);
  std::size_t turned_in_all = 0;
  for (std::size_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (settled[seed]) continue;
    settled[seed] = 1;
    std::vector<int> piece{static_cast<int>(seed)};
    std::size_t turned = 0;
    for (std::size_t n = 0; n < piece.size(); ++n) {
      const Triangle t = mesh.triangles[piece[n]];
      for (int k = 0; k < 3; ++k)
        for (int other : at.at(undirected(t[k], t[(k + 1) % 3]))) {
          if (other == piece[n]) continue;
          const bool disagrees = runs_along(mesh.triangles[other], t[k], t[(k + 1) % 3]);
          if (settled[other] && disagrees) {
            const Vec3& place = mesh.points[t[k]];
            throw InputError(
                "{}: the surface has one side only (a Moebius band), noticed near ({:.2f}, {:.2f}, {:.2f}) "
                "mm; expected "
                "one that encloses a volume",
                name, place.x(), place.y(), place.z());
          }
          if (settled[other]) continue;
          if (disagrees) std::swap(mesh.triangles[other][1], mesh.triangles[other][2]);
          turned += disagrees;
          settled[other] = 1;
          piece.push_back(other);
        }
    }
    // The sign of the whole is settled later: the smaller part is the one that was flipped.
    turned_in_all += std::min(turned, piece.size() - turned);
  }
  if (turned_in_all) actions.push_back(fmt::format("{} flipped triangles turned", turned_in_all));
  if (const std::size_t split = split_pinched_vertices(mesh))
    actions.push_back(fmt::format("{} vertices duplicated where the surface touches itself", split));
  return mesh;
}

}  // namespace valsalva::geometry
