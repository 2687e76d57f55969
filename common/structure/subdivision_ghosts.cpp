#include "structure/subdivision_ghosts.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "structure/subdivision_basis.hpp"

namespace valsalva::structure {
namespace {

using Vec2 = Eigen::Vector2d;
using Quadratic = Eigen::Matrix<double, 6, 1>;  // 1, s, y, s^2, s y, y^2

Quadratic monomials(const Vec2& p) {
  return (Quadratic() << 1, p[0], p[1], p[0] * p[0], p[0] * p[1], p[1] * p[1]).finished();
}

class GhostRule {
 public:
  GhostRule(const SubdivisionTopology& topology, const Points& nodes, const Points& vertices, bool clamps)
      : t_(topology), x_(nodes), vertices_(vertices), clamps_(clamps) {}

  VertexRows build() {
    for (int g = 0; g < static_cast<int>(t_.ghosts.size()); ++g) add(t_.nodes + g, ghost_row(t_.ghosts[g]));
    const std::vector<VertexRow> ghosts = out_.rows;
    for (int v = 0; v < t_.nodes; ++v)
      if (t_.supported(v)) add(v, control_row(v, ghosts));
    return std::move(out_);
  }

 private:
  void add(int vertex, VertexRow row) {
    out_.vertex.push_back(vertex);
    out_.rows.push_back(std::move(row));
  }

  int mirror_index(const Mat3& m) {
    for (std::size_t i = 0; i < out_.mirrors.size(); ++i)
      if ((out_.mirrors[i] - m).norm() < 1e-12) return static_cast<int>(i);
    out_.mirrors.push_back(m);
    return static_cast<int>(out_.mirrors.size()) - 1;
  }

  // In the surface, across the edge, inwards.
  Vec3 inward(const BorderEdge& e) const {
    const Vec3 along = (x_[e.b] - x_[e.a]).normalized(), in = x_[e.inner] - x_[e.a];
    return (in - along.dot(in) * along).normalized();
  }

  VertexRow ghost_row(const Ghost& g) {
    const auto [i, j, k] = g.plus_plus_minus;
    Vec3 place = x_[i] + x_[j] - x_[k];
    const double h = (x_[i] - x_[k]).norm();
    Mat3 mirror = Mat3::Identity();
    VertexRow row;
    for (int edge : g.edges) {
      if (edge < 0) continue;
      const BorderEdge& e = t_.border[edge];
      const bool symmetric = e.condition.support == EdgeSupport::symmetry;
      const bool clamped = clamps_ && e.condition.support == EdgeSupport::clamped;
      if (!symmetric && !clamped) continue;
      Vec3 m = symmetric ? e.condition.normal : inward(e);
      if (m.dot(x_[e.inner] - x_[e.a]) < 0) m = -m;
      const double beyond = m.dot(x_[e.a] - place);
      if (beyond < 1e-9 * h) continue;
      place += 2 * beyond * m;
      if (symmetric) {
        row.shift += mirror * (2 * m.dot(x_[e.a]) * m);
        mirror = (mirror * (Mat3::Identity() - 2 * m * m.transpose())).eval();
      } else {
        row.clamp = e.condition.clamp;
      }
    }
    const int index = mirror_index(mirror);
    for (const auto& [node, weight] : weights_at(place, i, j, h)) row.terms.push_back({node, index, weight});
    return row;
  }

  VertexRow control_row(int v, const std::vector<VertexRow>& ghosts) {
    const std::vector<int>& ring = t_.rings[v];
    const double l = loop_limit_weight(static_cast<int>(ring.size()));
    double on_edge = 0;
    for (int a : ring) on_edge += a < t_.nodes && t_.supported(a);
    const double scale = 1 / (1 - l * (static_cast<double>(ring.size()) - on_edge));
    std::map<std::array<int, 2>, double> sum;  // by node and mirror
    VertexRow row;
    sum[{v, 0}] += scale * (1 + l * on_edge);
    for (int a : ring) {
      if (a < t_.nodes) {
        sum[{a, 0}] -= scale * l;
        continue;
      }
      const VertexRow& ghost = ghosts[a - t_.nodes];
      for (const VertexRow::Term& term : ghost.terms)
        sum[{term.node, term.mirror}] -= scale * l * term.weight;
      row.shift -= scale * l * ghost.shift;
      row.clamp = std::max(row.clamp, ghost.clamp);
    }
    for (const auto& [at, weight] : sum)
      if (weight != 0) row.terms.push_back({at[0], at[1], weight});
    return row;
  }

  std::vector<int> nodes_around(int i, int j) const {
    std::vector<int> found{i};
    if (j != i) found.push_back(j);
    std::size_t begin = 0;
    for (int depth = 0; depth < 2 || (depth < 4 && found.size() < 8); ++depth) {
      const std::size_t end = found.size();
      for (; begin < end; ++begin)
        for (int a : t_.rings[found[begin]])
          if (a < t_.nodes && std::find(found.begin(), found.end(), a) == found.end()) found.push_back(a);
    }
    return found;
  }

  // The tangent plane at a border edge (or node, i == j), s along the border, in units of h.
  struct Plane {
    Vec3 origin, e1, e2;
    double h;
    Vec2 operator()(const Vec3& d) const { return Vec2(e1.dot(d), e2.dot(d)) / h; }
  };

  Plane plane_at(int i, int j, double h) const {
    Vec3 normal = Vec3::Zero();
    for (int v : {i, j})
      for (std::size_t k = 0; k + 1 < t_.rings[v].size(); ++k) {
        const int a = t_.rings[v][k], b = t_.rings[v][k + 1];
        if (a < t_.nodes && b < t_.nodes) normal += (x_[a] - x_[v]).cross(x_[b] - x_[v]);
      }
    normal.normalize();
    const BorderEdge& edge = t_.border[t_.border_of[i][1]];
    const Vec3 along = x_[edge.b] - x_[edge.a];
    const Vec3 e1 = (along - along.dot(normal) * normal).normalized();
    return {0.5 * (x_[i] + x_[j]), e1, normal.cross(e1), h};
  }

  // How far the control vertex of each monomial lies from the monomial at the control vertex' place.
  Quadratic stand_off(int v, const Plane& plane) const {
    const std::vector<int>& ring = t_.rings[v];
    const double l = loop_limit_weight(static_cast<int>(ring.size()));
    Vec2 mean = Vec2::Zero();
    Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
    for (int a : ring) {
      const Vec2 d = plane(vertices_[a] - vertices_[v]);
      mean += l * d;
      square += l * d * d.transpose();
    }
    square -= mean * mean.transpose();
    return (Quadratic() << 0, 0, 0, square(0, 0), square(0, 1), square(1, 1)).finished();
  }

  // Weights of the nodes for the control vertex of a quadratic function at a place near nodes i and j.
  std::vector<std::pair<int, double>> weights_at(const Vec3& place, int i, int j, double h) const {
    const Plane plane = plane_at(i, j, h);
    std::vector<int> around = nodes_around(i, j);
    const auto distance2 = [&](int a) { return (x_[a] - place).squaredNorm() / (h * h); };
    std::stable_sort(around.begin(), around.end(), [&](int a, int b) { return distance2(a) < distance2(b); });
    Eigen::Matrix<double, 6, Eigen::Dynamic> data(6, around.size());
    for (std::size_t k = 0; k < around.size(); ++k) {
      data.col(k) = monomials(plane(x_[around[k]] - plane.origin));
      if (!t_.supported(around[k])) data.col(k) -= stand_off(around[k], plane);
    }
    const Quadratic target =
        monomials(plane(place - plane.origin)) - 0.5 * (stand_off(i, plane) + stand_off(j, plane));
    // The smallest neighbourhood that determines a full quadratic; else a smaller basis on the largest.
    for (const auto& [size, nearest] :
         {std::pair{6, 9}, {6, 13}, {6, 1000}, {5, 1000}, {3, 1000}, {1, 1000}}) {
      int count = std::min<int>(nearest, around.size());
      while (count < static_cast<int>(around.size()) &&
             distance2(around[count]) < distance2(around[count - 1]) * (1 + 1e-6))
        ++count;  // all at the same distance, so that the choice is as symmetric as the mesh
      const Eigen::MatrixXd p = data.topLeftCorner(size, count);
      if (size > 1 && !determines(p)) continue;
      Eigen::VectorXd trust(count);
      for (int k = 0; k < count; ++k) trust[k] = 1 / (distance2(around[k]) + 1e-3);
      const Eigen::VectorXd w = trust.asDiagonal() * (p * trust.asDiagonal())
                                                         .bdcSvd(Eigen::ComputeThinU | Eigen::ComputeThinV)
                                                         .solve(target.head(size).eval());
      std::vector<std::pair<int, double>> weights;
      for (int k = 0; k < count; ++k) weights.emplace_back(around[k], w[k] / w.sum());
      return weights;
    }
    return {};
  }

  static bool determines(const Eigen::MatrixXd& p) {
    if (p.cols() < p.rows()) return false;
    const Eigen::VectorXd unit = p.rowwise().norm().cwiseInverse();
    const Eigen::MatrixXd scaled = unit.asDiagonal() * p;
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled * scaled.transpose()).eigenvalues()[0] >
           1e-4;
  }

  const SubdivisionTopology& t_;
  const Points& x_;
  const Points& vertices_;
  bool clamps_;
  VertexRows out_;
};

}  // namespace

VertexRows vertex_rows(const SubdivisionTopology& topology, const Points& nodes, const Points& vertices,
                       bool clamps) {
  return GhostRule(topology, nodes, vertices, clamps).build();
}

}  // namespace valsalva::structure
