#include "geometry/tetrahedralise.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "geometry/quality.hpp"
#include "geometry/surface.hpp"

namespace valsalva::geometry {
namespace {

constexpr double poor_scaled_jacobian = 0.15;
constexpr int normal_smoothings = 4;
constexpr int outer_smoothings = 60;
constexpr double folded_scaled_jacobian = 0.06;
constexpr int thinnings = 14;
constexpr double least_share = 0.2;  ///< of the thickness

/// A vertex of the border may move in its cut plane only.
struct InnerSurface {
  const TriMesh& mesh;
  std::vector<std::vector<int>> neighbours;
  std::vector<char> border;

  explicit InnerSurface(const TriMesh& surface)
      : mesh(surface), neighbours(vertex_neighbours(surface)), border(surface.points.size(), 0) {
    for (const auto& loop : border_loops(surface))
      for (int node : loop) border[node] = 1;
  }
  Vec3 allowed(int node, Vec3 direction) const {
    if (border[node]) direction.z() = 0;
    return direction;
  }
  /// Mean over the neighbours; a border vertex looks along the border only.
  Vec3 mean_around(int node, const Points& field) const {
    Vec3 sum = Vec3::Zero();
    int count = 0;
    for (int other : neighbours[node]) {
      if (border[node] && !border[other]) continue;
      sum += field[other];
      ++count;
    }
    return count ? Vec3(sum / count) : field[node];
  }
};

Points growth_directions(const InnerSurface& inner) {
  Points directions = vertex_normals(inner.mesh);
  for (int sweep = 0; sweep <= normal_smoothings; ++sweep) {
    Points next = directions;
    for (std::size_t i = 0; i < next.size(); ++i) {
      const int node = static_cast<int>(i);
      if (sweep > 0) next[i] = 0.5 * (directions[i] + inner.mean_around(node, directions));
      next[i] = inner.allowed(node, next[i]);
      if (next[i].norm() > 0) next[i].normalize();
    }
    directions = next;
  }
  return directions;
}

/// The first point on the ray where phi reaches the level, searched up to three times the level's distance.
Vec3 point_at_level(const GridSdf& phi, const Vec3& start, const Vec3& direction, double level) {
  const double step = 0.1 * level;
  double low = 0, high = step;
  while (high < 3 * level && phi.value(start + high * direction) < level) {
    low = high;
    high += step;
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (phi.value(start + middle * direction) < level ? low : high) = middle;
  }
  return start + 0.5 * (low + high) * direction;
}

TetMesh prisms_cut(const TriMesh& inner, const Points& outer, int layers) {
  TetMesh wall;
  const int count = static_cast<int>(inner.points.size());
  for (int layer = 0; layer <= layers; ++layer)
    for (int i = 0; i < count; ++i)
      wall.points.push_back(inner.points[i] + (double(layer) / layers) * (outer[i] - inner.points[i]));
  for (int layer = 0; layer < layers; ++layer)
    for (Triangle t : inner.triangles) {
      // Rotate so that the lowest vertex number comes first: its diagonals are then settled.
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      const int base = layer * count, top = base + count;
      const int a = base + t[0], b = base + t[1], c = base + t[2], A = top + t[0], B = top + t[1],
                C = top + t[2];
      if (t[1] < t[2])
        wall.tetrahedra.insert(wall.tetrahedra.end(), {{a, b, c, C}, {a, b, C, B}, {a, B, C, A}});
      else
        wall.tetrahedra.insert(wall.tetrahedra.end(), {{a, b, c, B}, {a, B, c, C}, {a, B, C, A}});
    }
  return wall;
}

/// Outer nodes of elements with a scaled Jacobian below the limit.
std::vector<char> nodes_of_poor(const TetMesh& wall, std::size_t count, double limit) {
  std::vector<char> poor(count, 0);
  for (const auto& t : wall.tetrahedra)
    if (tetrahedron_scaled_jacobian(wall.points[t[0]], wall.points[t[1]], wall.points[t[2]],
                                    wall.points[t[3]]) < limit)
      for (int node : t) poor[node % count] = 1;
  return poor;
}

std::vector<char> with_neighbours(std::vector<char> nodes, const InnerSurface& inner) {
  const std::vector<char> given = nodes;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (given[i])
      for (int other : inner.neighbours[i]) nodes[other] = 1;
  return nodes;
}

bool any(const std::vector<char>& nodes) {
  return std::any_of(nodes.begin(), nodes.end(), [](char flag) { return flag; });
}

void relax_outer(Points& outer, const InnerSurface& inner, const GridSdf& phi, double level,
                 const std::vector<char>& moved) {
  Points next = outer;
  for (std::size_t i = 0; i < outer.size(); ++i) {
    if (!moved[i]) continue;
    const int node = static_cast<int>(i);
    next[i] = 0.5 * (outer[i] + inner.mean_around(node, outer));
    for (int newton = 0; newton < 4; ++newton) {
      const Vec3 slope = inner.allowed(node, phi.gradient(next[i]));
      if (slope.squaredNorm() < 1e-6) break;
      next[i] += (level - phi.value(next[i])) / slope.squaredNorm() * slope;
    }
  }
  outer = next;
}

}  // namespace

WallMesh tetrahedral_wall(const TriMesh& lumen, const GridSdf& phi, const WallOptions& options) {
  VALSALVA_ASSERT(options.thickness_mm > 0 && options.layers > 0);
  const InnerSurface inner(lumen);
  const Points directions = growth_directions(inner);
  Points outer;
  for (std::size_t i = 0; i < lumen.points.size(); ++i)
    outer.push_back(point_at_level(phi, lumen.points[i], directions[i], options.thickness_mm));

  const std::size_t count = lumen.points.size();
  WallMesh wall{prisms_cut(lumen, outer, options.layers)};
  for (int sweep = 0; sweep < outer_smoothings; ++sweep) {
    const auto poor = nodes_of_poor(wall.mesh, count, poor_scaled_jacobian);
    if (!any(poor)) break;
    relax_outer(outer, inner, phi, options.thickness_mm, with_neighbours(poor, inner));
    wall.mesh = prisms_cut(lumen, outer, options.layers);
  }
  std::vector<double> share(count, 1.0);
  for (int sweep = 0; sweep < thinnings; ++sweep) {
    const auto folded = nodes_of_poor(wall.mesh, count, folded_scaled_jacobian);
    if (!any(folded)) break;
    const auto thinned = with_neighbours(folded, inner);
    for (std::size_t i = 0; i < count; ++i) {
      if (!thinned[i] || share[i] < least_share) continue;
      share[i] *= 0.85;
      outer[i] = lumen.points[i] + 0.85 * (outer[i] - lumen.points[i]);
    }
    wall.mesh = prisms_cut(lumen, outer, options.layers);
  }
  wall.thinned_nodes =
      static_cast<int>(std::count_if(share.begin(), share.end(), [](double s) { return s < 1; }));

  const TetQuality quality = quality_of(wall.mesh);
  if (quality.min_scaled_jacobian <= 0) {
    const Vec3 place = wall.mesh.points[wall.mesh.tetrahedra[quality.worst][0]];
    throw NumericalFailure(
        "the wall of {:.2f} mm folds over itself near ({:.2f}, {:.2f}, {:.2f}) mm: reduce "
        "mesh.wall_thickness_mm or smooth the lumen there",
        options.thickness_mm, place.x(), place.y(), place.z());
  }
  return wall;
}

double level_set_volume(const GridSdf& phi, double low_value, double high_value, double low_z,
                        double high_z) {
  constexpr int samples = 8;
  const double h = phi.spacing;
  const double reach = h * std::sqrt(3.0);
  double sum = 0;
  for (int k = 0; k + 1 < phi.dimensions[2]; ++k) {
    const double z = phi.origin.z() + k * h;
    const double slab = std::min(z + h, high_z) - std::max(z, low_z);
    if (slab <= 0) continue;
    const bool cut = slab < h * (1 - 1e-12);
    for (int j = 0; j + 1 < phi.dimensions[1]; ++j)
      for (int i = 0; i + 1 < phi.dimensions[0]; ++i) {
        const double corner = phi.at(i, j, k);
        const bool surely_out = corner < low_value - 2 * reach || corner > high_value + 2 * reach;
        if (surely_out) continue;
        const bool surely_in = corner > low_value + 2 * reach && corner < high_value - 2 * reach;
        if (surely_in && !cut) {
          sum += h * h * h;
          continue;
        }
        int inside = 0;
        for (int n = 0; n < samples * samples * samples; ++n) {
          const Vec3 f((n % samples + 0.5) / samples, (n / samples % samples + 0.5) / samples,
                       (n / (samples * samples) + 0.5) / samples);
          Vec3 x = phi.origin + h * (Vec3(i, j, k) + f);
          // Samples are spread over the part of the cell between the planes.
          x.z() = std::max(z, low_z) + f.z() * slab;
          const double value = phi.value(x);
          inside += value > low_value && value < high_value;
        }
        sum += h * h * slab * inside / (samples * samples * samples);
      }
  }
  return sum;
}

}  // namespace valsalva::geometry
