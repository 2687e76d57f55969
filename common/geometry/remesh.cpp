#include "geometry/remesh.hpp"

#include <CGAL/Polygon_mesh_processing/remesh.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "geometry/quality.hpp"
#include "geometry/surface.hpp"
#include "geometry/surface_cgal.hpp"
#include "geometry/surface_fill.hpp"

namespace valsalva::geometry {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using EdgeFlags = CgalMesh::Property_map<CgalMesh::Edge_index, bool>;
using VertexFlags = CgalMesh::Property_map<CgalMesh::Vertex_index, bool>;

/// Borders, and edges whose faces turn by more than the feature angle.
EdgeFlags kept_edges(CgalMesh& mesh, double feature_angle_deg) {
  auto kept = mesh.add_property_map<CgalMesh::Edge_index, bool>("e:kept", false).first;
  const double threshold =
      feature_angle_deg < 180 ? std::cos(feature_angle_deg * std::numbers::pi / 180) : -2;
  const auto normal = [&](CgalMesh::Halfedge_index h) -> Vec3 {
    const Vec3 a = from_cgal(mesh.point(mesh.source(h))), b = from_cgal(mesh.point(mesh.target(h)));
    return (b - a).cross(from_cgal(mesh.point(mesh.target(mesh.next(h)))) - a).normalized();
  };
  for (const auto edge : mesh.edges()) {
    const auto h = mesh.halfedge(edge);
    kept[edge] = mesh.is_border(edge) || normal(h).dot(normal(mesh.opposite(h))) < threshold;
  }
  return kept;
}

/// Kept points: where kept lines end, branch, or turn by more than the corner angle.
VertexFlags corners_of(CgalMesh& mesh, const EdgeFlags& kept, double corner_angle_deg) {
  auto corners = mesh.add_property_map<CgalMesh::Vertex_index, bool>("v:corner", false).first;
  std::vector<std::vector<CgalMesh::Vertex_index>> along(mesh.number_of_vertices());
  for (const auto edge : mesh.edges()) {
    if (!kept[edge]) continue;
    const auto a = mesh.vertex(edge, 0), b = mesh.vertex(edge, 1);
    along[a.idx()].push_back(b);
    along[b.idx()].push_back(a);
  }
  const double threshold = std::cos(corner_angle_deg * std::numbers::pi / 180);
  for (const auto vertex : mesh.vertices()) {
    const auto& ends = along[vertex.idx()];
    if (ends.empty()) continue;
    if (ends.size() != 2) {
      corners[vertex] = true;
      continue;
    }
    const Vec3 here = from_cgal(mesh.point(vertex));
    const Vec3 in = (here - from_cgal(mesh.point(ends[0]))).normalized();
    const Vec3 out = (from_cgal(mesh.point(ends[1])) - here).normalized();
    corners[vertex] = in.dot(out) < threshold;
  }
  return corners;
}

/// The kept lines as they were given.
class KeptLines {
 public:
  KeptLines(const CgalMesh& mesh, const EdgeFlags& kept) {
    for (const auto edge : mesh.edges())
      if (kept[edge])
        segments_.push_back(
            {from_cgal(mesh.point(mesh.vertex(edge, 0))), from_cgal(mesh.point(mesh.vertex(edge, 1)))});
  }
  bool none() const { return segments_.empty(); }
  Vec3 nearest(const Vec3& x) const {
    Vec3 best = x;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : segments_) {
      const double f = std::clamp((x - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-30), 0.0, 1.0);
      const Vec3 candidate = a + f * (b - a);
      if ((candidate - x).squaredNorm() < least) {
        least = (candidate - x).squaredNorm();
        best = candidate;
      }
    }
    return best;
  }

 private:
  std::vector<std::array<Vec3, 2>> segments_;
};

double longest_of(const CgalMesh& mesh, const EdgeFlags& kept) {
  double longest = 0;
  for (const auto edge : mesh.edges())
    if (kept[edge])
      longest = std::max(
          longest,
          (from_cgal(mesh.point(mesh.vertex(edge, 0))) - from_cgal(mesh.point(mesh.vertex(edge, 1)))).norm());
  return longest;
}

/// Evens out the spacing of vertices along the kept lines, without leaving them.
void slide_along(CgalMesh& mesh, const KeptLines& lines, const EdgeFlags& kept, const VertexFlags& corners) {
  constexpr int sweeps = 6;
  std::map<CgalMesh::Vertex_index, std::vector<CgalMesh::Vertex_index>> along;
  for (const auto edge : mesh.edges()) {
    if (!kept[edge]) continue;
    along[mesh.vertex(edge, 0)].push_back(mesh.vertex(edge, 1));
    along[mesh.vertex(edge, 1)].push_back(mesh.vertex(edge, 0));
  }
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (const auto& [vertex, ends] : along) {
      if (corners[vertex] || ends.size() != 2) continue;
      const Vec3 middle = 0.5 * (from_cgal(mesh.point(ends[0])) + from_cgal(mesh.point(ends[1])));
      mesh.point(vertex) = to_cgal(lines.nearest(middle));
    }
}

/// Moves inner vertices of sharp triangles within the surface, towards the middle of their neighbours or in
/// one of twelve directions, as long as the sharpest angle around them grows.
class SharpTriangles {
 public:
  explicit SharpTriangles(TriMesh& mesh)
      : mesh_(mesh),
        around_(mesh.points.size()),
        fixed_(mesh.points.size(), 0),
        neighbours_(vertex_neighbours(mesh)) {
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
      for (int node : mesh.triangles[i]) around_[node].push_back(static_cast<int>(i));
    for (const auto& loop : border_loops(mesh))
      for (int node : loop) fixed_[node] = 1;
  }
  void improve() {
    for (int sweep = 0; sweep < 10; ++sweep)
      for (std::size_t i = 0; i < mesh_.points.size(); ++i)
        if (!fixed_[i] && !around_[i].empty()) improve(static_cast<int>(i));
  }

 private:
  double sharpest(int node) const {
    double least = 180;
    for (int i : around_[node]) {
      const auto& [a, b, c] = mesh_.triangles[i];
      least = std::min(least, triangle_min_angle_deg(mesh_.points[a], mesh_.points[b], mesh_.points[c]));
    }
    return least;
  }
  void improve(int node) {
    double best = sharpest(node);
    if (best > 27) return;
    Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();
    for (int k : around_[node]) {
      const auto& [a, b, c] = mesh_.triangles[k];
      normal += (mesh_.points[b] - mesh_.points[a]).cross(mesh_.points[c] - mesh_.points[a]);
    }
    for (int other : neighbours_[node]) middle += mesh_.points[other] / double(neighbours_[node].size());
    normal.normalize();
    Vec3& x = mesh_.points[node];
    const Vec3 start = x;
    Vec3 chosen = start;
    const auto consider = [&](const Vec3& offset) {
      x = start + offset - offset.dot(normal) * normal;
      const double reached = sharpest(node);
      if (reached > best) {
        best = reached;
        chosen = x;
      }
    };
    for (const double fraction : {1.0, 0.5}) consider(fraction * (middle - start));
    const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
    const double radius = (mesh_.points[neighbours_[node].front()] - start).norm();
    for (int k = 0; k < 12; ++k) {
      const double angle = k * std::numbers::pi / 6;
      for (const double fraction : {0.08, 0.25})
        consider(fraction * radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    x = chosen;
  }

  TriMesh& mesh_;
  std::vector<std::vector<int>> around_;
  std::vector<char> fixed_;
  std::vector<std::vector<int>> neighbours_;
};

}  // namespace

TriMesh remesh(const TriMesh& input, const RemeshOptions& options) {
  VALSALVA_ASSERT(options.edge_mm > 0);
  CgalMesh mesh = to_cgal(input);
  const auto kept = kept_edges(mesh, options.feature_angle_deg);
  const auto corners = corners_of(mesh, kept, options.corner_angle_deg);
  const KeptLines lines(mesh, kept);
  const int rounds = lines.none() || options.protect_borders ? 1 : 3;
  for (int round = 0; round < rounds; ++round) {
    if (round > 0) slide_along(mesh, lines, kept, corners);
    // CGAL protects only lines without edges longer than 4/3 of the target.
    const bool even = round == rounds - 1 && round > 0 && longest_of(mesh, kept) < 1.3 * options.edge_mm;
    pmp::isotropic_remeshing(mesh.faces(), options.edge_mm, mesh,
                             pmp::parameters::number_of_iterations((options.iterations + rounds - 1) / rounds)
                                 .number_of_relaxation_steps(3)
                                 .edge_is_constrained_map(kept)
                                 .vertex_is_constrained_map(corners)
                                 .relax_constraints(false)
                                 .protect_constraints(options.protect_borders || even));
  }
  TriMesh result = from_cgal(mesh);
  if (options.feature_angle_deg >= 180) SharpTriangles(result).improve();
  return result;
}

TriMesh closed_by_caps(const TriMesh& open, double edge_mm) {
  using Position = std::array<double, 3>;
  const auto position_of = [](const Vec3& p) { return Position{p.x(), p.y(), p.z()}; };
  TriMesh closed = open;
  std::map<Position, int> number;
  for (const auto& loop : border_loops(open)) {
    double longest = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3 &a = open.points[loop[k]], &b = open.points[loop[(k + 1) % loop.size()]];
      longest = std::max(longest, (a - b).norm());
      number[position_of(a)] = loop[k];
    }
    RemeshOptions options;
    options.edge_mm = std::max(edge_mm, 0.8 * longest);
    options.protect_borders = true;
    const TriMesh cap = remesh(compacted({open.points, filled_loop(open.points, loop)}), options);
    for (const Triangle& t : cap.triangles) {
      Triangle joined{};
      for (int k = 0; k < 3; ++k) {
        const Vec3& p = cap.points[t[k]];
        const auto [found, fresh] =
            number.try_emplace(position_of(p), static_cast<int>(closed.points.size()));
        if (fresh) closed.points.push_back(p);
        joined[k] = found->second;
      }
      closed.triangles.push_back(joined);
    }
  }
  return closed;
}

}  // namespace valsalva::geometry
