#include "geometry/repair.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/errors.hpp"
#include "geometry/repair_soup.hpp"
#include "geometry/surface.hpp"
#include "geometry/surface_fill.hpp"
#include "geometry/surface_intersections.hpp"

namespace valsalva::geometry {
namespace {

using Actions = std::vector<std::string>;

constexpr int intersection_rounds = 3;  ///< each removes one more ring of triangles

std::string text_of(const Vec3& p) {
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) mm", p.x(), p.y(), p.z());
}

Vec3 centre_of(const TriMesh& mesh, int triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return (mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]) / 3;
}

/// The connected pieces, largest area first.
std::vector<TriMesh> pieces_of(const TriMesh& mesh) {
  const auto neighbours = vertex_neighbours(mesh);
  std::vector<int> piece(mesh.points.size(), -1);
  int count = 0;
  for (std::size_t seed = 0; seed < piece.size(); ++seed) {
    if (piece[seed] >= 0) continue;
    std::vector<int> reached{static_cast<int>(seed)};
    piece[seed] = count;
    for (std::size_t n = 0; n < reached.size(); ++n)
      for (int other : neighbours[reached[n]]) {
        if (piece[other] >= 0) continue;
        piece[other] = count;
        reached.push_back(other);
      }
    ++count;
  }
  std::vector<TriMesh> pieces(count, TriMesh{mesh.points, {}});
  for (const Triangle& t : mesh.triangles) pieces[piece[t[0]]].triangles.push_back(t);
  for (TriMesh& part : pieces) part = compacted(part);
  std::stable_sort(pieces.begin(), pieces.end(),
                   [](const TriMesh& a, const TriMesh& b) { return surface_area(a) > surface_area(b); });
  return pieces;
}

TriMesh without_splinters(const TriMesh& mesh, const RepairLimits& limits, const std::string& name,
                          Actions& actions) {
  const auto pieces = pieces_of(mesh);
  if (pieces.size() == 1) return mesh;
  const double threshold = limits.max_splinter_area_fraction * surface_area(mesh);
  const auto large = std::count_if(pieces.begin(), pieces.end(),
                                   [&](const TriMesh& p) { return surface_area(p) > threshold; });
  if (large > 1)
    throw InputError(
        "{}: {} separate pieces, the largest two at {} and {}; expected one connected lumen: keep only one",
        name, large, text_of(centre_of(pieces[0], 0)), text_of(centre_of(pieces[1], 0)));
  actions.push_back(fmt::format("{} splinters dropped", pieces.size() - 1));
  return pieces.front();
}

std::set<Edge> edges_of(const TriMesh& mesh) {
  std::set<Edge> edges;
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k)
      edges.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
  return edges;
}

void close_holes(TriMesh& mesh, const RepairLimits& limits, const std::string& name, Actions& actions) {
  for (const auto& loop : border_loops(mesh)) {
    double perimeter = 0;
    Vec3 centre = Vec3::Zero();
    for (std::size_t k = 0; k < loop.size(); ++k) {
      perimeter += (mesh.points[loop[(k + 1) % loop.size()]] - mesh.points[loop[k]]).norm();
      centre += mesh.points[loop[k]] / double(loop.size());
    }
    if (perimeter > limits.max_hole_perimeter_mm)
      throw InputError(
          "{}: a hole of {:.1f} mm perimeter ({} edges) around {}; expected a closed surface: close it, or "
          "allow it by "
          "mesh.max_hole_perimeter_mm (now {:.1f})",
          name, perimeter, loop.size(), text_of(centre), limits.max_hole_perimeter_mm);
    const auto patch = filled_loop(mesh.points, loop, edges_of(mesh));
    if (patch.empty())
      throw InputError("{}: the hole of {:.1f} mm perimeter around {} could not be closed: close it by hand",
                       name, perimeter, text_of(centre));
    mesh.triangles.insert(mesh.triangles.end(), patch.begin(), patch.end());
    actions.push_back(fmt::format("hole of {:.2f} mm perimeter around {} closed with {} triangles", perimeter,
                                  text_of(centre), patch.size()));
  }
}

/// Without the given triangles and `rings` rings of neighbours around them.
TriMesh without_neighbourhood(const TriMesh& mesh, std::set<int> removed, int rings) {
  for (int ring = 0; ring < rings; ++ring) {
    std::set<int> nodes;
    for (int triangle : removed)
      nodes.insert(mesh.triangles[triangle].begin(), mesh.triangles[triangle].end());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      if (std::any_of(mesh.triangles[i].begin(), mesh.triangles[i].end(),
                      [&](int node) { return nodes.count(node) > 0; }))
        removed.insert(static_cast<int>(i));
  }
  TriMesh rest{mesh.points, {}};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (!removed.count(static_cast<int>(i))) rest.triangles.push_back(mesh.triangles[i]);
  return compacted(rest);
}

/// Cuts the places out with growing margins and closes the holes, as long as holes and change stay small.
TriMesh without_self_intersections(const TriMesh& mesh, const RepairLimits& limits, const std::string& name,
                                   Actions& actions) {
  const auto pairs = self_intersections(mesh);
  if (pairs.empty()) return mesh;
  std::set<int> crossing;
  for (const auto& [a, b] : pairs) crossing.insert({a, b});
  const Vec3 place = centre_of(mesh, pairs.front().first);
  const double before = std::abs(enclosed_volume(mesh));
  std::string reason = "nothing was left of it";
  for (int rings = 1; rings <= intersection_rounds; ++rings) {
    TriMesh trial = without_neighbourhood(mesh, crossing, rings);
    if (trial.triangles.empty()) break;
    try {
      Actions unused;
      trial = oriented_soup(trial, name, unused);
      trial = without_splinters(trial, limits, name, unused);
      close_holes(trial, limits, name, unused);
    } catch (const InputError& error) {
      reason = error.what();
      continue;
    }
    const double change = std::abs(std::abs(enclosed_volume(trial)) / before - 1);
    reason = fmt::format("cutting it out changes the volume by {:.1f} % or leaves others", 100 * change);
    if (change > limits.max_volume_change_fraction || !self_intersections(trial).empty()) continue;
    actions.push_back(
        fmt::format("self-intersection of {} pairs of triangles near {} cut out, volume changed by {:.3f} %",
                    pairs.size(), text_of(place), 100 * change));
    return trial;
  }
  throw InputError(
      "{}: the surface passes through itself, {} pairs of triangles, the first near {}; not repaired ({}): "
      "separate the "
      "sheets there",
      name, pairs.size(), text_of(place), reason);
}

}  // namespace

RepairedSurface repair_closed_surface(const TriMesh& raw, const RepairLimits& limits,
                                      const std::string& name) {
  RepairedSurface result;
  TriMesh mesh = oriented_soup(clean_soup(raw, name, result.actions), name, result.actions);
  mesh = without_splinters(mesh, limits, name, result.actions);
  close_holes(mesh, limits, name, result.actions);
  mesh = without_self_intersections(mesh, limits, name, result.actions);
  const double volume = enclosed_volume(mesh);
  if (volume < 0) {
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    result.actions.push_back("surface was inside out: turned");
  }
  if (std::abs(volume) < 1e-9 * std::pow(surface_area(mesh), 1.5))
    throw InputError("{}: the surface encloses no volume", name);
  result.mesh = mesh;
  return result;
}

}  // namespace valsalva::geometry
