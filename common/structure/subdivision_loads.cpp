#include "structure/subdivision_loads.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::structure {
namespace {

struct EdgePoint {
  std::vector<int> vertices;
  BasisTable basis;
  Eigen::Vector2d along;
  double weight;  // of the edge's parameter, 0 to 1
};

// Three Gauss points on each border edge, along its direction.
std::vector<EdgePoint> edge_points(const SubdivisionSurface& surface, std::span<const Edge> edges) {
  static constexpr std::array<Eigen::Vector2d (*)(), 3> corners{[] { return Eigen::Vector2d(0, 0); },
                                                                [] { return Eigen::Vector2d(1, 0); },
                                                                [] { return Eigen::Vector2d(0, 1); }};
  const SubdivisionTopology& t = surface.topology();
  std::vector<EdgePoint> points;
  for (const Edge& edge : edges) {
    const auto found = std::find_if(t.border.begin(), t.border.end(), [&](const BorderEdge& b) {
      return std::min(b.a, b.b) == edge[0] && std::max(b.a, b.b) == edge[1];
    });
    if (found == t.border.end())
      throw InputError("load on edge {}-{}: it is not on the border of the shell", edge[0], edge[1]);
    const Triangle& triangle = t.triangles[found->triangle];
    const int k = static_cast<int>(std::find(triangle.begin(), triangle.end(), found->a) - triangle.begin());
    const Eigen::Vector2d from = corners[k](), to = corners[(k + 1) % 3]();
    const TrianglePatch patch = surface.patch(found->triangle);
    const double a = 0.5 * std::sqrt(0.6);
    for (const auto& [at, weight] : {std::pair{0.5 - a, 5. / 18}, {0.5, 8. / 18}, {0.5 + a, 5. / 18}}) {
      const Eigen::Vector2d place = from + at * (to - from);
      points.push_back({patch.vertices, loop_basis(patch.rings, place[0], place[1]), to - from, weight});
    }
  }
  return points;
}

Eigen::Matrix<double, 3, 3> place_and_tangents(const Points& x, const std::vector<int>& vertices,
                                               const BasisTable& basis) {
  Eigen::Matrix<double, 3, 3> j = Eigen::Matrix3d::Zero();
  for (std::size_t a = 0; a < vertices.size(); ++a)
    j += x[vertices[a]] * basis.col(static_cast<int>(a)).head<3>().transpose();
  return j;
}

Points reference_vertices(const SubdivisionSurface& surface) {
  Points vertices;
  surface.gather(surface.reference(), 0, vertices);
  return vertices;
}

}  // namespace

void add_point_force(const SubdivisionSurface& surface, int node, const Vec3& force_uN, Points& out,
                     int offset) {
  Points forces(surface.vertices(), Vec3::Zero());
  for (const auto& [vertex, weight] : surface.limit_weights(node)) forces[vertex] += weight * force_uN;
  surface.scatter(forces, out, offset);
}

void add_area_load(const SubdivisionShell& shell, const std::function<Vec3(const Vec3&)>& traction_Pa,
                   Points& out, int offset) {
  const Points vertices = reference_vertices(shell.surface());
  Points forces(vertices.size(), Vec3::Zero());
  for (int q = 0; q < shell.quadrature_points(); ++q) {
    const SubdivisionShell::Quadrature p = shell.quadrature_point(q);
    Vec3 place = Vec3::Zero();
    for (std::size_t a = 0; a < p.vertices.size(); ++a) place += p.basis[6 * a] * vertices[p.vertices[a]];
    const Vec3 force = p.area * traction_Pa(place);
    for (std::size_t a = 0; a < p.vertices.size(); ++a) forces[p.vertices[a]] += p.basis[6 * a] * force;
  }
  shell.surface().scatter(forces, out, offset);
}

void add_edge_load(const SubdivisionSurface& surface, std::span<const Edge> edges,
                   const std::function<Vec3(const Vec3&)>& force_uN_per_mm, Points& out, int offset) {
  const Points vertices = reference_vertices(surface);
  Points forces(vertices.size(), Vec3::Zero());
  for (const EdgePoint& p : edge_points(surface, edges)) {
    const auto j = place_and_tangents(vertices, p.vertices, p.basis);
    const double length = p.weight * (j.rightCols<2>() * p.along).norm();
    const Vec3 force = length * force_uN_per_mm(j.col(0));
    for (std::size_t a = 0; a < p.vertices.size(); ++a)
      forces[p.vertices[a]] += p.basis(0, static_cast<int>(a)) * force;
  }
  surface.scatter(forces, out, offset);
}

SubdivisionPressureTerm::SubdivisionPressureTerm(std::string name,
                                                 std::shared_ptr<const SubdivisionShell> shell,
                                                 const Body& body, std::function<double(double)> pressure_Pa)
    : name_(std::move(name)), shell_(std::move(shell)), body_(body), pressure_(std::move(pressure_Pa)) {}

double SubdivisionPressureTerm::add_forces(const Configuration& now, Forces& out) const {
  const double pressure = pressure_(now.time_s);
  if (pressure == 0) return 0;
  Points vertices;
  shell_->surface().gather(now.x, body_.offset, vertices);
  Points forces(vertices.size(), Vec3::Zero());
  for (int q = 0; q < shell_->quadrature_points(); ++q) {
    const SubdivisionShell::Quadrature p = shell_->quadrature_point(q);
    Vec3 a1 = Vec3::Zero(), a2 = Vec3::Zero();
    for (std::size_t a = 0; a < p.vertices.size(); ++a) {
      a1 += p.basis[6 * a + 1] * vertices[p.vertices[a]];
      a2 += p.basis[6 * a + 2] * vertices[p.vertices[a]];
    }
    const Vec3 force = pressure * p.parameter * a1.cross(a2);
    for (std::size_t a = 0; a < p.vertices.size(); ++a) forces[p.vertices[a]] += p.basis[6 * a] * force;
  }
  shell_->surface().scatter(forces, out.force, body_.offset);
  return 0;
}

void SubdivisionPressureTerm::add_stiffness_bound(const Configuration& now, StiffnessBound& out) const {
  // As for flat triangles (structure/pressure.cpp); the smooth surface spreads the same load wider.
  const double pressure = std::abs(pressure_(now.time_s));
  for (const Triangle& t : shell_->mesh().triangles) {
    double around = 0;
    for (int k = 0; k < 3; ++k)
      around += (now.x[body_.offset + t[k]] - now.x[body_.offset + t[(k + 1) % 3]]).norm();
    for (int a : t) out.translation[body_.offset + a] += pressure / 6 * around;
  }
}

void SubdivisionPressureTerm::add_tangent(const Configuration& now, BlockMatrix& out) const {
  const double pressure = pressure_(now.time_s);
  if (pressure == 0) return;
  Points vertices;
  shell_->surface().gather(now.x, body_.offset, vertices);
  Eigen::MatrixXd k;
  for (int e = 0; e < shell_->elements(); ++e) {
    const auto [first, last] = shell_->points_of(e);
    std::span<const int> v;
    for (int q = first; q < last; ++q) {
      const SubdivisionShell::Quadrature p = shell_->quadrature_point(q);
      const int n = static_cast<int>(p.vertices.size());
      v = p.vertices;
      if (q == first) k.setZero(3 * n, 3 * n);
      Vec3 a1 = Vec3::Zero(), a2 = Vec3::Zero();
      for (int a = 0; a < n; ++a) {
        a1 += p.basis[6 * a + 1] * vertices[v[a]];
        a2 += p.basis[6 * a + 2] * vertices[v[a]];
      }
      const Mat3 x1 = pressure * p.parameter * cross_matrix(a1),
                 x2 = pressure * p.parameter * cross_matrix(a2);
      for (int b = 0; b < n; ++b) {
        const Mat3 change = p.basis[6 * b + 1] * x2 - p.basis[6 * b + 2] * x1;
        for (int a = 0; a < n; ++a) k.block<3, 3>(3 * a, 3 * b) += p.basis[6 * a] * change;
      }
    }
    shell_->surface().add_matrix(v, k, out, body_.offset);
  }
}

SubdivisionEdgeMomentTerm::SubdivisionEdgeMomentTerm(std::string name,
                                                     std::shared_ptr<const SubdivisionShell> shell,
                                                     const Body& body, std::span<const Edge> edges,
                                                     std::function<double(double)> moment_uN)
    : name_(std::move(name)), shell_(std::move(shell)), body_(body), moment_(std::move(moment_uN)) {
  const Points vertices = reference_vertices(shell_->surface());
  for (const EdgePoint& p : edge_points(shell_->surface(), edges)) {
    const auto j = place_and_tangents(vertices, p.vertices, p.basis);
    points_.push_back({p.vertices, p.basis, p.along, p.weight * (j.rightCols<2>() * p.along).norm()});
  }
}

void SubdivisionEdgeMomentTerm::forces_at(const Points& x, const Point& p, double moment, Points& f) const {
  const auto j = place_and_tangents(x, p.vertices, p.basis);
  const Vec3 a1 = j.col(1), a2 = j.col(2);
  const Vec3 n = a1.cross(a2).normalized();
  const Vec3 across = (p.along[0] * a1 + p.along[1] * a2).normalized().cross(n);  // tau x n
  Eigen::Matrix2d metric;
  metric << a1.dot(a1), a1.dot(a2), a1.dot(a2), a2.dot(a2);
  const Eigen::Vector2d turn = metric.inverse() * Eigen::Vector2d(across.dot(a1), across.dot(a2));
  for (std::size_t a = 0; a < p.vertices.size(); ++a) {
    const int c = static_cast<int>(a);
    f[p.vertices[a]] -= moment * p.length * (turn[0] * p.basis(1, c) + turn[1] * p.basis(2, c)) * n;
  }
}

double SubdivisionEdgeMomentTerm::add_forces(const Configuration& now, Forces& out) const {
  const double moment = moment_(now.time_s);
  if (moment == 0) return 0;
  Points vertices;
  shell_->surface().gather(now.x, body_.offset, vertices);
  Points forces(vertices.size(), Vec3::Zero());
  for (const Point& p : points_) forces_at(vertices, p, moment, forces);
  shell_->surface().scatter(forces, out.force, body_.offset);
  return 0;
}

void SubdivisionEdgeMomentTerm::add_stiffness_bound(const Configuration& now, StiffnessBound& out) const {
  // The force changes by about m / h for a displacement of h, over the length of an edge.
  const double moment = std::abs(moment_(now.time_s));
  for (const Point& p : points_)
    for (int v : p.vertices)
      if (v < shell_->nodes()) out.translation[body_.offset + v] += moment;
}

void SubdivisionEdgeMomentTerm::add_tangent(const Configuration& now, BlockMatrix& out) const {
  const double moment = moment_(now.time_s);
  if (moment == 0) return;
  Points vertices;
  shell_->surface().gather(now.x, body_.offset, vertices);
  Points ahead(vertices.size(), Vec3::Zero()), behind = ahead;
  for (const Point& p : points_) {
    const int n = static_cast<int>(p.vertices.size());
    Eigen::MatrixXd k(3 * n, 3 * n);
    const double step = 1e-6 * (vertices[p.vertices[1]] - vertices[p.vertices[0]]).norm();
    for (int column = 0; column < 3 * n; ++column) {
      for (int v : p.vertices) ahead[v] = behind[v] = Vec3::Zero();
      double& at = vertices[p.vertices[column / 3]][column % 3];
      const double here = at;
      at = here + step;
      forces_at(vertices, p, moment, ahead);
      at = here - step;
      forces_at(vertices, p, moment, behind);
      at = here;
      for (int a = 0; a < n; ++a)
        k.block<3, 1>(3 * a, column) = (behind[p.vertices[a]] - ahead[p.vertices[a]]) / (2 * step);
    }
    shell_->surface().add_matrix(p.vertices, k, out, body_.offset);
  }
}

}  // namespace valsalva::structure
