#include "structure/kirchhoff_edges.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

// Weights w (a column a target) of least norm sum_k w_k^2 / trust_k that reproduce the targets: data w =
// targets. Empty when the data do not determine them.
Eigen::MatrixXd least_weights(const Eigen::MatrixXd& data, const Eigen::VectorXd& trust,
                              const Eigen::MatrixXd& targets) {
  if (data.cols() < data.rows()) return {};
  const Eigen::VectorXd unit = data.rowwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * data;
  const Eigen::MatrixXd plain = scaled * scaled.transpose();
  if (!(plain.ldlt().vectorD().minCoeff() > 1e-3)) return {};
  const Eigen::MatrixXd weighted = scaled * trust.asDiagonal();
  const Eigen::MatrixXd gram = weighted * scaled.transpose();
  return weighted.transpose() * gram.ldlt().solve(unit.asDiagonal() * targets);
}

using Vectors = Eigen::Matrix<double, 3, ShellEdges::vectors>;

// What the mirror image leaves of d, x,ss, x,sy, x,yy at the edge on a plane of normal m.
void mirror(const Vec3& m, Eigen::Ref<Vectors> v) {
  for (int k : {0, 2}) v.col(k) = m * m.dot(v.col(k));
  for (int k : {1, 3}) v.col(k) -= m * m.dot(v.col(k));
}

}  // namespace

ShellEdges::ShellEdges(const Points& reference, const std::vector<Triangle>& triangles,
                       const EdgeConditions& conditions)
    : nodes_(static_cast<int>(reference.size())), neighbours_(reference.size()) {
  find_edges(triangles, conditions);
  weigh(reference);
}

void ShellEdges::find_edges(const std::vector<Triangle>& triangles, const EdgeConditions& conditions) {
  std::map<Edge, int> index;
  of_triangle_.resize(triangles.size());
  for (int e = 0; e < static_cast<int>(triangles.size()); ++e) {
    const Triangle& t = triangles[e];
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      if (a < 0 || a >= nodes_)
        throw InputError("shell: triangle {} refers to node {}; the mesh has {} nodes", e, a, nodes_);
      if (a == b) throw InputError("shell: triangle {} has node {} twice", e, a);
      const auto [entry, created] = index.try_emplace({std::min(a, b), std::max(a, b)}, count());
      of_triangle_[e][k] = entry->second;
      if (created) {
        edges_.push_back({{a, b}, {e, -1}, {c, -1}, {}});
        neighbours_[a].push_back(b);
        neighbours_[b].push_back(a);
        continue;
      }
      ShellEdge& edge = edges_[entry->second];
      if (edge.triangles[1] >= 0)
        throw InputError(
            "shell: edge {}-{} belongs to triangles {}, {} and {}; expected at most two: the mesh is not "
            "manifold",
            std::min(a, b), std::max(a, b), edge.triangles[0], edge.triangles[1], e);
      if (edge.nodes[0] == a)
        throw InputError(
            "shell: triangles {} and {} at edge {}-{} are turned against each other; expected one "
            "orientation",
            edge.triangles[0], e, a, b);
      edge.triangles[1] = e;
      edge.opposite[1] = c;
    }
  }
  for (int a = 0; a < nodes_; ++a)
    if (neighbours_[a].empty()) throw InputError("shell: node {} belongs to no triangle; remove it", a);
  for (const auto& [edge, condition] : conditions) {
    const auto found = index.find(edge);
    if (found == index.end() || edges_[found->second].triangles[1] >= 0)
      throw InputError(
          "shell: the support of edge {}-{} is not on the border of the mesh; expected border edges", edge[0],
          edge[1]);
    EdgeCondition& own = edges_[found->second].condition = condition;
    if (condition.support != EdgeSupport::symmetry) continue;
    if (!(condition.normal.norm() > 0))
      throw InputError("shell: symmetry at edge {}-{} has no plane; give its normal", edge[0], edge[1]);
    own.normal.normalize();
  }
}

void ShellEdges::weigh(const Points& x) {
  for (const ShellEdge& e : edges_) {
    const auto [a, b] = e.nodes;
    const Vec3 along = (x[b] - x[a]).normalized();
    Vec3 normal = along.cross(x[e.opposite[0]] - x[a]).normalized();
    if (e.opposite[1] >= 0) normal -= along.cross(x[e.opposite[1]] - x[a]).normalized();
    const Vec3 across = along.cross(normal).normalized();
    Row row;
    row.begin = static_cast<int>(terms_.size());
    Fit own = fit(x, e, along, across, false);
    row.trust = trust_in(x, e, own);
    if (e.condition.support == EdgeSupport::clamped) {
      for (const Term& t : own.terms)
        row.fixed += x[t.node] * Eigen::Map<const Eigen::RowVector4d>(t.weight.data());
      own = fit(x, e, along, across, true);
      row.fixed.col(3) = own.by_slope * row.fixed.col(0);
      for (Term& t : own.terms) t.weight = {0, 0, 0, t.weight[3]};
      row.clamp = e.condition.clamp;
    } else if (e.condition.support == EdgeSupport::symmetry) {
      row.plane = static_cast<int>(normals_.size());
      normals_.push_back(e.condition.normal);
    }
    terms_.insert(terms_.end(), own.terms.begin(), own.terms.end());
    row.end = static_cast<int>(terms_.size());
    rows_.push_back(row);
  }
}

double ShellEdges::trust_in(const Points& x, const ShellEdge& e, const Fit& fit) const {
  if (!fit.quadratic) return 0;
  const Vec3 side = x[e.nodes[1]] - x[e.nodes[0]];
  double area = 0;
  for (int c : e.opposite) area += 0.5 * side.cross(x[c < 0 ? e.opposite[0] : c] - x[e.nodes[0]]).norm();
  double most = 0;
  for (int v = 1; v < vectors; ++v) {
    double sum = 0;
    for (const Term& t : fit.terms) sum += std::abs(t.weight[v]);
    most = std::max(most, sum * area);
  }
  return std::min(1.0, 100 / (most * most));
}

ShellEdges::Fit ShellEdges::fit(const Points& x, const ShellEdge& e, const Vec3& along, const Vec3& across,
                                bool slope_known) const {
  const auto [a, b] = e.nodes;
  const double h = (x[b] - x[a]).norm();
  const Vec3 middle = 0.5 * (x[a] + x[b]);
  std::vector<int> around{a, b};
  const auto add = [&](int v) {
    if (v >= 0 && std::find(around.begin(), around.end(), v) == around.end()) around.push_back(v);
  };
  for (int v : e.opposite) add(v);
  for (int side = 0; side < 2; ++side)
    if (e.triangles[side] >= 0)
      for (int i : of_triangle_[e.triangles[side]])
        for (int v : edges_[i].opposite) add(v);
  for (int wider = 0;; ++wider) {
    const int count = static_cast<int>(around.size()), given = count + (slope_known ? 1 : 0);
    Eigen::MatrixXd data(6, given);
    Eigen::VectorXd trust(given);
    for (int k = 0; k < count; ++k) {
      const Vec3 r = (x[around[k]] - middle) / h;
      const double s = r.dot(along), y = r.dot(across);
      data.col(k) << 1, s, y, s * s, s * y, y * y;
      trust[k] = std::pow(r.squaredNorm() + 0.05, -4);
    }
    if (slope_known) {
      data.col(count) = Eigen::Matrix<double, 6, 1>::Unit(2) / h;
      trust[count] = std::pow(0.05, -4) * h * h;
    }
    // With too few nodes for a quadratic (a strip of one row), at last a linear function.
    const int size = wider < 3 ? 6 : 3;
    Eigen::MatrixXd targets = Eigen::MatrixXd::Zero(size, vectors);
    targets(2, 0) = 1 / h;
    if (size == 6) targets.bottomRightCorner<3, 3>().diagonal() = Vec3(2, 1, 2) / (h * h);
    const Eigen::MatrixXd w = least_weights(data.topRows(size), trust, targets);
    if (w.size() > 0) {
      Fit found;
      found.quadratic = size == 6;
      for (int k = 0; k < count; ++k)
        found.terms.push_back({around[k], {w(k, 0), w(k, 1), w(k, 2), w(k, 3)}});
      if (slope_known) found.by_slope = w(count, 3);
      return found;
    }
    VALSALVA_ASSERT(size == 6);
    const std::vector<int> now = around;
    for (int v : now)
      for (int n : neighbours_[v]) add(n);
  }
}

void ShellEdges::gather(const Points& x, int offset, Points& vertices, std::span<const Mat3> clamps) const {
  vertices.resize(this->vertices());
  std::copy(x.begin() + offset, x.begin() + offset + nodes_, vertices.begin());
  const Vec3* node = x.data() + offset;
#pragma omp parallel for schedule(static) if (count() > 2000)
  for (int i = 0; i < count(); ++i) {
    const Row& row = rows_[i];
    double sums[3][vectors] = {};
    for (int k = row.begin; k < row.end; ++k) {
      const Vec3& at = node[terms_[k].node];
      for (int c = 0; c < 3; ++c)
        for (int v = 0; v < vectors; ++v) sums[c][v] += at[c] * terms_[k].weight[v];
    }
    Vectors sum = Eigen::Map<const Eigen::Matrix<double, 3, vectors, Eigen::RowMajor>>(&sums[0][0]);
    if (row.plane >= 0) mirror(normals_[row.plane], sum);
    if (row.clamp >= 0)
      sum += row.clamp < static_cast<int>(clamps.size()) ? Vectors(clamps[row.clamp] * row.fixed) : row.fixed;
    for (int k = 0; k < vectors; ++k) vertices[vertex(i) + k] = sum.col(k);
  }
}

void ShellEdges::scatter(const Points& vertex_forces, Points& f, int offset) const {
  for (int a = 0; a < nodes_; ++a) f[offset + a] += vertex_forces[a];
  for (int i = 0; i < count(); ++i) {
    const Row& row = rows_[i];
    Vectors force = Eigen::Map<const Vectors>(vertex_forces[vertex(i)].data());
    if (row.plane >= 0) mirror(normals_[row.plane], force);
    const Eigen::Matrix<double, vectors, 3> by_component = force.transpose();
    for (int k = row.begin; k < row.end; ++k) {
      const Eigen::Map<const Eigen::Vector4d> weight(terms_[k].weight.data());
      Vec3& at = f[offset + terms_[k].node];
      for (int c = 0; c < 3; ++c) at[c] += by_component.col(c).dot(weight);
    }
  }
}

void ShellEdges::reach(int triangle, std::vector<int>& nodes, Eigen::MatrixXd& weights) const {
  const auto& own = of_triangle_[triangle];
  nodes.clear();
  for (int k = 0; k < 3; ++k) {
    const ShellEdge& e = edges_[own[k]];
    nodes.push_back(e.nodes[e.triangles[0] == triangle ? 0 : 1]);
  }
  const auto place = [&](int a) { return std::find(nodes.begin(), nodes.end(), a) - nodes.begin(); };
  for (int i : own)
    for (int t = rows_[i].begin; t < rows_[i].end; ++t)
      if (place(terms_[t].node) == static_cast<long>(nodes.size())) nodes.push_back(terms_[t].node);
  weights.setZero(3 * vectors, nodes.size());
  for (int k = 0; k < 3; ++k)
    for (int t = rows_[own[k]].begin; t < rows_[own[k]].end; ++t)
      weights.block<vectors, 1>(vectors * k, place(terms_[t].node)) =
          Eigen::Map<const Eigen::Vector4d>(terms_[t].weight.data());
}

void ShellEdges::project(int edge, int first, Eigen::Ref<Eigen::MatrixXd> k) const {
  if (rows_[edge].plane < 0) return;
  const Vec3& m = normals_[rows_[edge].plane];
  for (int i = 0; i < k.rows(); ++i) {
    Vectors row = k.block<1, 3 * vectors>(i, first).reshaped(3, vectors);
    mirror(m, row);
    k.block<1, 3 * vectors>(i, first) = row.reshaped().transpose();
  }
  for (int i = 0; i < k.cols(); ++i) {
    Vectors column = k.block<3 * vectors, 1>(first, i).reshaped(3, vectors);
    mirror(m, column);
    k.block<3 * vectors, 1>(first, i) = column.reshaped();
  }
}

void ShellEdges::add_matrix(std::span<const int> vertices, const Eigen::Ref<const Eigen::MatrixXd>& k,
                            BlockMatrix& out, int offset) const {
  std::vector<int> slots;
  std::vector<int> node;
  const auto slot_of = [&](int a) {
    const auto found = std::find(node.begin(), node.end(), a);
    if (found != node.end()) return static_cast<int>(found - node.begin());
    node.push_back(a);
    slots.push_back(offset + a);
    return static_cast<int>(node.size()) - 1;
  };
  // Factors of the nodes in each vertex: weights, and the plane that some are projected on.
  std::vector<std::vector<std::pair<int, double>>> factors(vertices.size());
  std::vector<Mat3> projected(vertices.size(), Mat3::Identity());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (vertices[v] < nodes_) {
      factors[v].emplace_back(slot_of(vertices[v]), 1.0);
      continue;
    }
    const Row& row = row_of_d(vertices[v]);
    for (int t = row.begin; t < row.end; ++t)
      factors[v].emplace_back(slot_of(terms_[t].node), terms_[t].weight[0]);
    if (row.plane >= 0) projected[v] = normals_[row.plane] * normals_[row.plane].transpose();
  }
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3 * slots.size(), 3 * slots.size());
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (std::size_t w = 0; w < vertices.size(); ++w) {
      const Mat3 block = projected[v] * k.block<3, 3>(3 * v, 3 * w) * projected[w];
      for (const auto& [i, fi] : factors[v])
        for (const auto& [j, fj] : factors[w]) sum.block<3, 3>(3 * i, 3 * j) += fi * fj * block;
    }
  out.add(slots, sum);
}

void ShellEdges::scatter_bound(const std::vector<double>& vertex_bound, std::vector<double>& bound,
                               int offset) const {
  for (int a = 0; a < nodes_; ++a) bound[offset + a] += vertex_bound[a];
  for (int i = 0; i < count(); ++i) {
    const double spread = rows_[i].plane >= 0 ? std::sqrt(3.0) : 1;
    for (int k = rows_[i].begin; k < rows_[i].end; ++k)
      bound[offset + terms_[k].node] += spread * std::abs(terms_[k].weight[0]) * vertex_bound[vertex(i)];
  }
}

const ShellEdges::Row& ShellEdges::row_of_d(int vertex) const {
  VALSALVA_ASSERT((vertex - nodes_) % vectors == 0);
  return rows_[(vertex - nodes_) / vectors];
}

}  // namespace valsalva::structure
