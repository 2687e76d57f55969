#include "assembly/shell_edge.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

namespace valsalva::assembly {
namespace {

std::array<Vec3, 3> corners(const Points& x, const std::array<int, 3>& nodes) {
  return {x[nodes[0]], x[nodes[1]], x[nodes[2]]};
}

double flexural_rigidity(const BuiltBody& body, int triangle) {
  const double t = body.shell->thickness(triangle), nu = body.bending_poisson;
  const double factor = body.shell->mesh().stiffness_factor[triangle];
  return factor * body.bending_Pa * t * t * t / (12 * (1 - nu * nu));
}

/// Is the rotation about this direction held?
bool holds_rotation(const Support& support, const Vec3& along) {
  Vec3 turning = along.normalized();
  for (int d = 0; d < 3; ++d)
    if (!support.rotation[d]) turning[d] = 0;
  return turning.norm() > 0.99;
}

}  // namespace

structure::EdgeConditions edge_conditions(const BuiltBody& body, const std::vector<Support>& supports) {
  using structure::EdgeSupport;
  structure::EdgeConditions conditions;
  const Points& x = body.mesh.points;
  for (std::size_t k = 0; k < supports.size(); ++k) {
    const Support& s = supports[k];
    if (!s.holds_nodes()) continue;
    const std::set<int> held(s.nodes.begin(), s.nodes.end());
    for (const Edge& e : body.border()) {
      if (!held.contains(e[0] + body.at.offset) || !held.contains(e[1] + body.at.offset)) continue;
      structure::EdgeCondition wanted;
      if (s.symmetry)
        wanted = {EdgeSupport::symmetry, s.normal, 0};
      else if (holds_rotation(s, x[e[1]] - x[e[0]]))
        wanted = {EdgeSupport::clamped, Vec3::Zero(), static_cast<int>(k)};
      else
        continue;
      structure::EdgeCondition& now = conditions[{std::min(e[0], e[1]), std::max(e[0], e[1])}];
      if (now.support != EdgeSupport::clamped) now = wanted;
    }
  }
  return conditions;
}

ShellEdgeTerm::ShellEdgeTerm(const BuiltBody& body, const Support& support)
    : name_("edge of " + body.name + " at " + support.name), motion_(support.motion) {
  const std::set<int> held(support.nodes.begin(), support.nodes.end());
  const Points& x = body.mesh.points;
  for (const auto& [element, place] : border_edges(body.mesh.triangles)) {
    const Triangle& t = body.mesh.triangles[element];
    const int a = t[place], b = t[(place + 1) % 3], c = t[(place + 2) % 3], o = body.at.offset;
    if (!held.contains(a + o) || !held.contains(b + o)) continue;
    const Vec3 along = x[b] - x[a], normal = along.cross(x[c] - x[a]);
    Edge edge{{a + o, b + o, c + o}, support.normal, 0, 0};
    if (!support.symmetry) {
      if (!holds_rotation(support, along)) continue;
      edge.mirror = along.cross(normal).normalized();
    }
    edge.stiffness = flexural_rigidity(body, element) * along.squaredNorm() / (0.5 * normal.norm());
    edge.rest = std::asin(std::clamp(normal.normalized().dot(edge.mirror), -1.0, 1.0));
    if (edge.stiffness > 0 && std::abs(edge.rest) < 1.2) edges_.push_back(edge);
  }
}

Vec3 ShellEdgeTerm::mirror_of(const Edge& edge, double time_s) const {
  return motion_.turn_rad == 0 ? edge.mirror : Vec3(motion_.turn(time_s) * edge.mirror);
}

ShellEdgeTerm::Bent ShellEdgeTerm::bent(const Edge& edge, const std::array<Vec3, 3>& x,
                                        const Vec3& mirror) const {
  const Vec3 area = (x[1] - x[0]).cross(x[2] - x[0]), n = area.normalized();
  // Beyond 80 degrees the angle's derivative grows without bound; it is continued with that of 80 degrees.
  const double sine = std::clamp(n.dot(mirror), -1.0, 1.0), phi = std::asin(sine);
  const Vec3 g = (mirror - sine * n) / area.norm() / std::max(std::cos(phi), 0.17);
  Bent b;
  b.torque = edge.stiffness * (phi - edge.rest);
  b.energy = 0.5 * b.torque * (phi - edge.rest);
  for (int k = 0; k < 3; ++k) b.gradient[k] = (x[(k + 1) % 3] - x[(k + 2) % 3]).cross(g);
  return b;
}

double ShellEdgeTerm::add_forces(const structure::Configuration& now, structure::Forces& out) const {
  double energy = 0;
  for (const Edge& edge : edges_) {
    const Bent b = bent(edge, corners(now.x, edge.nodes), mirror_of(edge, now.time_s));
    energy += b.energy;
    for (int k = 0; k < 3; ++k) out.force[edge.nodes[k]] -= b.torque * b.gradient[k];
  }
  return energy;
}

void ShellEdgeTerm::add_stiffness_bound(const structure::Configuration& now,
                                        structure::StiffnessBound& out) const {
  for (const Edge& edge : edges_) {
    const Bent b = bent(edge, corners(now.x, edge.nodes), mirror_of(edge, now.time_s));
    double sum = 0;
    for (const Vec3& g : b.gradient) sum += g.lpNorm<1>();
    for (int k = 0; k < 3; ++k)
      out.translation[edge.nodes[k]] += edge.stiffness * b.gradient[k].lpNorm<Eigen::Infinity>() * sum;
  }
}

void ShellEdgeTerm::add_tangent(const structure::Configuration& now, structure::BlockMatrix& out) const {
  for (const Edge& edge : edges_) {
    const Vec3 mirror = mirror_of(edge, now.time_s);
    std::array<Vec3, 3> x = corners(now.x, edge.nodes);
    const double h = 1e-6 * (x[1] - x[0]).norm();
    Eigen::MatrixXd k(9, 9);
    for (int j = 0; j < 9; ++j) {
      double& moved = x[j / 3][j % 3];
      const double at = moved;
      moved = at + h;
      const Bent plus = bent(edge, x, mirror);
      moved = at - h;
      const Bent minus = bent(edge, x, mirror);
      moved = at;
      for (int i = 0; i < 3; ++i)
        k.block<3, 1>(3 * i, j) =
            (plus.torque * plus.gradient[i] - minus.torque * minus.gradient[i]) / (2 * h);
    }
    out.add(edge.nodes, k);
  }
}

}  // namespace valsalva::assembly
