#include "structure/kirchhoff_edges.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

// Least-norm weights w with trust w_k^2 / trust_k that reproduce a target: sum_k w_k data_k = target. Empty
// when the data do not determine it.
Eigen::VectorXd least_weights(const Eigen::MatrixXd& data, const Eigen::VectorXd& trust,
                              const Eigen::VectorXd& target) {
  if (data.cols() < data.rows()) return {};
  const Eigen::VectorXd unit = data.rowwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * data;
  const Eigen::MatrixXd plain = scaled * scaled.transpose();
  if (!(plain.ldlt().vectorD().minCoeff() > 1e-3)) return {};
  const Eigen::MatrixXd weighted = scaled * trust.asDiagonal();
  const Eigen::MatrixXd gram = weighted * scaled.transpose();
  const Eigen::VectorXd goal = unit.cwiseProduct(target);
  return weighted.transpose() * gram.ldlt().solve(goal);
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
    Row row{static_cast<int>(terms_.size()), 0};
    std::vector<Term> terms = weights(x, e, along, across);
    if (e.condition.support == EdgeSupport::clamped) {
      for (const Term& t : terms) row.fixed += t.weight * x[t.node];
      row.clamp = e.condition.clamp;
      terms.clear();
    } else if (e.condition.support == EdgeSupport::symmetry) {
      row.projector = static_cast<int>(normals_.size());
      normals_.push_back(e.condition.normal);
    }
    terms_.insert(terms_.end(), terms.begin(), terms.end());
    row.end = static_cast<int>(terms_.size());
    rows_.push_back(row);
  }
}

std::vector<ShellEdges::Term> ShellEdges::weights(const Points& x, const ShellEdge& e, const Vec3& along,
                                                  const Vec3& across) const {
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
    const int count = static_cast<int>(around.size());
    Eigen::MatrixXd data(6, count);
    Eigen::VectorXd trust(count);
    for (int k = 0; k < count; ++k) {
      const Vec3 r = (x[around[k]] - middle) / h;
      const double s = r.dot(along), y = r.dot(across);
      data.col(k) << 1, s, y, s * s, s * y, y * y;
      trust[k] = std::pow(r.squaredNorm() + 0.05, -4);
    }
    // With too few nodes for a quadratic (a strip of one row), at last a linear function.
    const int size = wider < 3 ? 6 : 3;
    Eigen::VectorXd target = Eigen::VectorXd::Zero(size);
    target[2] = 1 / h;
    const Eigen::VectorXd w = least_weights(data.topRows(size), trust, target);
    if (w.size() > 0) {
      std::vector<Term> terms;
      for (int k = 0; k < count; ++k) terms.push_back({around[k], w[k]});
      return terms;
    }
    VALSALVA_ASSERT(size == 6);
    const std::vector<int> now = around;
    for (int v : now)
      for (int n : neighbours_[v]) add(n);
  }
}

void ShellEdges::gather_change(const Points& x, int offset, Points& vertices) const {
  vertices.resize(this->vertices());
  std::copy(x.begin() + offset, x.begin() + offset + nodes_, vertices.begin());
  const Vec3* node = x.data() + offset;
#pragma omp parallel for schedule(static) if (count() > 2000)
  for (int i = 0; i < count(); ++i) {
    const Row& row = rows_[i];
    Vec3 sum = Vec3::Zero();
    for (int k = row.begin; k < row.end; ++k) sum += terms_[k].weight * node[terms_[k].node];
    if (row.projector >= 0) sum = normals_[row.projector] * normals_[row.projector].dot(sum);
    vertices[nodes_ + i] = sum;
  }
}

void ShellEdges::gather(const Points& x, int offset, Points& vertices, std::span<const Mat3> clamps) const {
  gather_change(x, offset, vertices);
  for (int i = 0; i < count(); ++i) {
    const Row& row = rows_[i];
    if (row.clamp < 0) continue;
    vertices[nodes_ + i] =
        row.clamp < static_cast<int>(clamps.size()) ? Vec3(clamps[row.clamp] * row.fixed) : row.fixed;
  }
}

void ShellEdges::scatter(const Points& vertex_forces, Points& f, int offset) const {
  for (int a = 0; a < nodes_; ++a) f[offset + a] += vertex_forces[a];
  for (int i = 0; i < count(); ++i) {
    const Row& row = rows_[i];
    Vec3 force = vertex_forces[nodes_ + i];
    if (row.projector >= 0) force = normals_[row.projector] * normals_[row.projector].dot(force);
    for (int k = row.begin; k < row.end; ++k) f[offset + terms_[k].node] += terms_[k].weight * force;
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
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    if (vertices[v] < nodes_) {
      factors[v].emplace_back(slot_of(vertices[v]), 1.0);
      continue;
    }
    const Row& row = rows_[vertices[v] - nodes_];
    for (int t = row.begin; t < row.end; ++t)
      factors[v].emplace_back(slot_of(terms_[t].node), terms_[t].weight);
  }
  const auto projected = [&](std::size_t v) {
    const int p = vertices[v] < nodes_ ? -1 : rows_[vertices[v] - nodes_].projector;
    return p < 0 ? Mat3(Mat3::Identity()) : Mat3(normals_[p] * normals_[p].transpose());
  };
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(3 * slots.size(), 3 * slots.size());
  for (std::size_t v = 0; v < vertices.size(); ++v)
    for (std::size_t w = 0; w < vertices.size(); ++w) {
      const Mat3 block = projected(v) * k.block<3, 3>(3 * v, 3 * w) * projected(w);
      for (const auto& [i, fi] : factors[v])
        for (const auto& [j, fj] : factors[w]) sum.block<3, 3>(3 * i, 3 * j) += fi * fj * block;
    }
  out.add(slots, sum);
}

std::vector<double> ShellEdges::gather_bound() const {
  std::vector<double> bound(vertices(), 1.0);
  for (int i = 0; i < count(); ++i) {
    double& sum = bound[nodes_ + i] = 0;
    for (int k = rows_[i].begin; k < rows_[i].end; ++k) sum += std::abs(terms_[k].weight);
    if (rows_[i].projector >= 0) sum *= std::sqrt(3.0);
  }
  return bound;
}

void ShellEdges::scatter_bound(const std::vector<double>& vertex_bound, std::vector<double>& bound,
                               int offset) const {
  for (int a = 0; a < nodes_; ++a) bound[offset + a] += vertex_bound[a];
  for (int i = 0; i < count(); ++i) {
    const double spread = rows_[i].projector >= 0 ? std::sqrt(3.0) : 1;
    for (int k = rows_[i].begin; k < rows_[i].end; ++k)
      bound[offset + terms_[k].node] += spread * std::abs(terms_[k].weight) * vertex_bound[nodes_ + i];
  }
}

}  // namespace valsalva::structure
