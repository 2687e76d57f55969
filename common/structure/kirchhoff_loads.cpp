#include "structure/kirchhoff_loads.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {

EdgeMomentTerm::EdgeMomentTerm(std::string name, std::shared_ptr<const KirchhoffShell> shell,
                               const Body& body, std::span<const Edge> edges,
                               std::function<double(double)> moment_uN)
    : name_(std::move(name)), shell_(std::move(shell)), body_(body), moment_(std::move(moment_uN)) {
  std::map<Edge, int> border;
  for (int i = 0; i < shell_->edges().count(); ++i) {
    const ShellEdge& e = shell_->edges().edge(i);
    if (e.triangles[1] < 0) border[{std::min(e.nodes[0], e.nodes[1]), std::max(e.nodes[0], e.nodes[1])}] = i;
  }
  for (const Edge& edge : edges) {
    const auto found = border.find(edge);
    if (found == border.end())
      throw InputError("{}: edge {}-{} is not on the border of the shell", name_, edge[0], edge[1]);
    const auto [a, b] = shell_->edges().edge(found->second).nodes;
    const Points& x = shell_->mesh().reference;
    edges_.push_back({{a, b, shell_->edges().vertex(found->second)}, (x[b] - x[a]).norm()});
  }
}

double EdgeMomentTerm::add_forces(const Configuration& now, Forces& out) const {
  const double moment = moment_(now.time_s);
  if (moment == 0) return 0;
  Points vertices;
  shell_->edges().gather(now.x, body_.offset, vertices);
  Points forces(vertices.size(), Vec3::Zero());
  for (const Loaded& edge : edges_) {
    const auto [a, b, v] = edge.vertices;
    const Vec3 n = vertices[v].cross(vertices[b] - vertices[a]).normalized();
    forces[v] += moment * edge.length / vertices[v].norm() * n;
  }
  shell_->edges().scatter(forces, out.force, body_.offset);
  return 0;
}

void EdgeMomentTerm::add_stiffness_bound(const Configuration& now, StiffnessBound& out) const {
  // The edge vector is a difference over about its length, and its force of the order m.
  const double moment = std::abs(moment_(now.time_s));
  std::vector<double> rows(shell_->edges().vertices(), 0.0), bound(shell_->nodes(), 0.0);
  for (const Loaded& edge : edges_) rows[edge.vertices[2]] += 4 * moment / edge.length;
  shell_->edges().scatter_bound(rows, bound, 0);
  for (int a = 0; a < shell_->nodes(); ++a) out.translation[body_.offset + a] += bound[a];
}

void EdgeMomentTerm::add_tangent(const Configuration& now, BlockMatrix& out) const {
  const double moment = moment_(now.time_s);
  if (moment == 0) return;
  Points vertices;
  shell_->edges().gather(now.x, body_.offset, vertices);
  for (const Loaded& edge : edges_) {
    const auto [a, b, v] = edge.vertices;
    const Vec3 d = vertices[v], along = vertices[b] - vertices[a], c = d.cross(along), n = c.normalized();
    const double load = moment * edge.length, size = d.norm();
    const Mat3 normal = load / (size * c.norm()) * (Mat3::Identity() - n * n.transpose());
    Eigen::Matrix<double, 9, 9> k = Eigen::Matrix<double, 9, 9>::Zero();
    const Mat3 by_along = -normal * cross_matrix(d);
    k.block<3, 3>(6, 0) = -by_along;
    k.block<3, 3>(6, 3) = by_along;
    k.block<3, 3>(6, 6) = normal * cross_matrix(along) + load / (size * size * size) * n * d.transpose();
    shell_->edges().add_matrix(edge.vertices, k, out, body_.offset);
  }
}

}  // namespace valsalva::structure
