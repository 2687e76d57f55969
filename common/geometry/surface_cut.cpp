#include "geometry/surface_cut.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.hpp"
#include "geometry/surface.hpp"
#include "geometry/surface_fill.hpp"

namespace valsalva::geometry {
namespace {

/// Keeps the side where sign * (z - plane) < 0; the border lies exactly in the plane.
TriMesh half(const TriMesh& input, double plane, double sign) {
  TriMesh mesh{input.points, {}};
  const double snap = 0.15 * edge_lengths(input).mean;
  for (Vec3& p : mesh.points)
    if (std::abs(p.z() - plane) < snap) p.z() = plane;
  const auto height = [&](int node) { return sign * (mesh.points[node].z() - plane); };

  std::map<Edge, int> crossings;
  const auto crossing = [&](int a, int b) {
    const Edge key{std::min(a, b), std::max(a, b)};
    const auto [found, fresh] = crossings.try_emplace(key, static_cast<int>(mesh.points.size()));
    if (fresh) {
      const Vec3 low = mesh.points[key[0]], high = mesh.points[key[1]];
      const double fraction = (plane - low.z()) / (high.z() - low.z());
      Vec3 x = low + fraction * (high - low);
      x.z() = plane;
      mesh.points.push_back(x);
    }
    return found->second;
  };
  for (const Triangle& t : input.triangles) {
    std::vector<int> kept;
    bool strictly_inside = false;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      const double from = height(a), to = height(b);
      strictly_inside = strictly_inside || from < 0;
      if (from <= 0) kept.push_back(a);
      if (from * to < 0) kept.push_back(crossing(a, b));
    }
    if (!strictly_inside) continue;
    for (std::size_t k = 2; k < kept.size(); ++k) mesh.triangles.push_back({kept[0], kept[k - 1], kept[k]});
  }
  return compacted(mesh);
}

}  // namespace

TriMesh cut_closed_between(const TriMesh& closed, double low_z, double high_z) {
  VALSALVA_ASSERT(low_z < high_z);
  TriMesh mesh = closed;
  for (const double sign : {1.0, -1.0}) {
    const double plane = sign > 0 ? high_z : low_z;
    mesh = half(mesh, plane, sign);
    const auto loops = border_loops(mesh);
    if (loops.empty())
      throw InputError("the lumen surface does not reach the cut plane z = {:.3f} mm", plane);
    for (const auto& loop : loops) {
      const auto cap = filled_loop(mesh.points, loop);
      mesh.triangles.insert(mesh.triangles.end(), cap.begin(), cap.end());
    }
  }
  return mesh;
}

TriMesh without_caps(const TriMesh& mesh, double low_z, double high_z) {
  const double tolerance = 1e-6 * std::max(1.0, high_z - low_z);
  TriMesh open{mesh.points, {}};
  for (const Triangle& t : mesh.triangles) {
    bool in_low = true, in_high = true;
    for (int node : t) {
      in_low = in_low && std::abs(mesh.points[node].z() - low_z) < tolerance;
      in_high = in_high && std::abs(mesh.points[node].z() - high_z) < tolerance;
    }
    if (!in_low && !in_high) open.triangles.push_back(t);
  }
  return compacted(open);
}

}  // namespace valsalva::geometry
