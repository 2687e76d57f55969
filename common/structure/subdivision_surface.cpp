#include "structure/subdivision_surface.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/errors.hpp"

namespace valsalva::structure {

SubdivisionSurface::SubdivisionSurface(const Points& points, const std::vector<Triangle>& triangles,
                                       const EdgeConditions& conditions, Given given)
    : topology_(subdivision_topology(static_cast<int>(points.size()), triangles, conditions)) {
  for (std::size_t a = 0; a < points.size(); ++a)
    if (!points[a].allFinite()) throw InputError("shell: node {} is not at a finite position", a);
  // The weights at the border depend on where the control vertices are, those on the weights: twice is
  // enough, as both differ by h^2.
  reference_ = points;
  Points vertices = points;
  for (const Ghost& g : topology_.ghosts) {
    const auto [i, j, k] = g.plus_plus_minus;
    vertices.push_back(points[i] + points[j] - points[k]);
  }
  VertexRows at_rest;
  for (int pass = 0; pass < 3; ++pass) {
    at_rest = vertex_rows(topology_, reference_, vertices, false);
    if (given == Given::surface) reference_ = solve_for(points, at_rest);
    gather(reference_, 0, at_rest, vertices, {});
  }
  at_rest = vertex_rows(topology_, reference_, vertices, false);
  rows_ = vertex_rows(topology_, reference_, vertices, true);
  if (given == Given::surface) reference_ = solve_for(points, at_rest);
  gather(reference_, 0, at_rest, vertices, {});
  Points clamped;
  gather(reference_, 0, rows_, clamped, {});
  row_of_.assign(topology_.vertices(), -1);
  for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
    const int vertex = rows_.vertex[i];
    row_of_[vertex] = static_cast<int>(i);
    if (rows_.rows[i].clamp >= 0) rows_.rows[i].offset = vertices[vertex] - clamped[vertex];
  }
}

TrianglePatch SubdivisionSurface::patch(int triangle) const {
  const Triangle& t = topology_.triangles[triangle];
  TrianglePatch patch;
  std::map<int, int> local;
  const auto index = [&](int vertex) {
    const auto [entry, created] = local.try_emplace(vertex, static_cast<int>(patch.vertices.size()));
    if (created) patch.vertices.push_back(vertex);
    return entry->second;
  };
  for (int v : t) index(v);
  for (int k = 0; k < 3; ++k) {
    std::vector<int> ring = topology_.rings[t[k]];
    std::rotate(ring.begin(), std::find(ring.begin(), ring.end(), t[(k + 1) % 3]), ring.end());
    VALSALVA_ASSERT(ring[1] == t[(k + 2) % 3]);
    for (int v : ring) patch.rings.rings[k].push_back(index(v));
  }
  patch.rings.vertices = static_cast<int>(patch.vertices.size());
  return patch;
}

void SubdivisionSurface::gather(const Points& x, int offset, Points& vertices,
                                std::span<const Mat3> clamps) const {
  gather(x, offset, rows_, vertices, clamps);
}

void SubdivisionSurface::gather_change(const Points& direction, int offset, Points& vertices) const {
  gather_linear(direction, offset, rows_, vertices);
}

void SubdivisionSurface::gather_linear(const Points& x, int offset, const VertexRows& rows,
                                       Points& vertices) const {
  vertices.resize(topology_.vertices());
  std::copy(x.begin() + offset, x.begin() + offset + nodes(), vertices.begin());
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    Vec3 sum = Vec3::Zero();
    for (const VertexRow::Term& term : rows.rows[i].terms)
      sum += term.mirror == 0 ? Vec3(term.weight * x[offset + term.node])
                              : Vec3(term.weight * (rows.mirrors[term.mirror] * x[offset + term.node]));
    vertices[rows.vertex[i]] = sum;
  }
}

void SubdivisionSurface::gather(const Points& x, int offset, const VertexRows& rows, Points& vertices,
                                std::span<const Mat3> clamps) const {
  gather_linear(x, offset, rows, vertices);
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    const VertexRow& row = rows.rows[i];
    vertices[rows.vertex[i]] += row.shift;
    if (row.clamp >= 0)
      vertices[rows.vertex[i]] +=
          row.clamp < static_cast<int>(clamps.size()) ? Vec3(clamps[row.clamp] * row.offset) : row.offset;
  }
}

void SubdivisionSurface::scatter(const Points& vertex_forces, Points& f, int offset) const {
  for (int a = 0; a < nodes(); ++a)
    if (is_node(a)) f[offset + a] += vertex_forces[a];
  for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
    const Vec3& force = vertex_forces[rows_.vertex[i]];
    for (const VertexRow::Term& term : rows_.rows[i].terms)
      f[offset + term.node] += term.mirror == 0
                                   ? Vec3(term.weight * force)
                                   : Vec3(term.weight * (rows_.mirrors[term.mirror].transpose() * force));
  }
}

void SubdivisionSurface::add_matrix(std::span<const int> vertices, const Eigen::Ref<const Eigen::MatrixXd>& k,
                                    BlockMatrix& out, int offset) const {
  std::vector<int> slots;
  if (std::all_of(vertices.begin(), vertices.end(), [&](int v) { return is_node(v); })) {
    for (int v : vertices) slots.push_back(offset + v);
    out.add(slots, k);
    return;
  }
  std::map<int, int> index;
  const auto slot_of = [&](int node) {
    const auto [entry, created] = index.try_emplace(node, static_cast<int>(slots.size()));
    if (created) slots.push_back(offset + node);
    return entry->second;
  };
  struct Factor {
    int row, column;
    Mat3 block;
  };
  std::vector<Factor> factors;
  for (std::size_t a = 0; a < vertices.size(); ++a) {
    const int row = static_cast<int>(a), v = vertices[a];
    if (is_node(v)) {
      factors.push_back({row, slot_of(v), Mat3::Identity()});
      continue;
    }
    for (const VertexRow::Term& term : rows_.rows[row_of_[v]].terms)
      factors.push_back({row, slot_of(term.node), term.weight * rows_.mirrors[term.mirror]});
  }
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(3 * vertices.size(), 3 * slots.size());
  for (const Factor& f : factors) change.block<3, 3>(3 * f.row, 3 * f.column) += f.block;
  out.add(slots, change.transpose() * k * change);
}

std::vector<double> SubdivisionSurface::gather_bound() const {
  std::vector<double> bound(vertices(), 1.0);
  for (std::size_t i = 0; i < rows_.rows.size(); ++i) {
    double& sum = bound[rows_.vertex[i]] = 0;
    for (const VertexRow::Term& term : rows_.rows[i].terms)
      sum += std::abs(term.weight) * rows_.mirrors[term.mirror].cwiseAbs().rowwise().sum().maxCoeff();
  }
  return bound;
}

void SubdivisionSurface::scatter_bound(const std::vector<double>& vertex_bound, std::vector<double>& bound,
                                       int offset) const {
  for (int a = 0; a < nodes(); ++a)
    if (is_node(a)) bound[offset + a] += vertex_bound[a];
  for (std::size_t i = 0; i < rows_.rows.size(); ++i)
    for (const VertexRow::Term& term : rows_.rows[i].terms)
      bound[offset + term.node] += std::abs(term.weight) *
                                   rows_.mirrors[term.mirror].cwiseAbs().colwise().sum().maxCoeff() *
                                   vertex_bound[rows_.vertex[i]];
}

std::vector<std::pair<int, double>> SubdivisionSurface::limit_weights(int node) const {
  const std::vector<int>& ring = topology_.rings[node];
  const double l = loop_limit_weight(static_cast<int>(ring.size()));
  std::vector<std::pair<int, double>> weights{{node, 1 - l * static_cast<double>(ring.size())}};
  for (int a : ring) weights.emplace_back(a, l);
  return weights;
}

Points SubdivisionSurface::surface_of(const Points& vertices) const {
  Points points(nodes(), Vec3::Zero());
  for (int v = 0; v < nodes(); ++v) {
    const std::vector<int>& ring = topology_.rings[v];
    const double l = loop_limit_weight(static_cast<int>(ring.size()));
    points[v] = (1 - l * static_cast<double>(ring.size())) * vertices[v];
    for (int a : ring) points[v] += l * vertices[a];
  }
  return points;
}

Points SubdivisionSurface::surface(const Points& x, int offset, std::span<const Mat3> clamps) const {
  Points vertices;
  gather(x, offset, vertices, clamps);
  return surface_of(vertices);
}

Points SubdivisionSurface::nodes_of(const Points& surface_points) const {
  return solve_for(surface_points, rows_);
}

Points SubdivisionSurface::solve_for(const Points& points, const VertexRows& rows) const {
  Points x = points, vertices;
  double size = 0;
  for (const Vec3& p : points) size = std::max(size, (p - points[0]).norm());
  constexpr int most = 3000;
  for (int iteration = 0; iteration < most; ++iteration) {
    gather(x, 0, rows, vertices, {});
    const Points now = surface_of(vertices);
    double change = 0;
    for (int a = 0; a < nodes(); ++a) {
      if (topology_.supported(a)) continue;  // is a point of the surface already
      x[a] += points[a] - now[a];
      change = std::max(change, (points[a] - now[a]).norm());
    }
    if (change <= 1e-14 * size) return x;
    if (!std::isfinite(change) || (iteration + 1 == most && change > 1e-10 * size))
      throw InputError(
          "shell: no control net interpolates the nodes (largest distance {} mm after {} steps); the mesh is "
          "too "
          "distorted at its border: remesh it, or give the control net itself",
          change, iteration + 1);
  }
  return x;
}

}  // namespace valsalva::structure
