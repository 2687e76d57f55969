#include "structure/solid_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

namespace valsalva::structure {
namespace {

int corners_of(Shape face) {
  return face == Shape::triangle3 || face == Shape::triangle6 ? 3 : 4;
}

}  // namespace

std::vector<SolidFace> boundary_faces(const SolidMesh& mesh) {
  std::map<std::vector<int>, int> uses;
  std::vector<SolidFace> all;
  std::vector<std::vector<int>> keys;
  for (int e = 0; e < mesh.elements(); ++e) {
    const auto nodes = mesh.nodes_of(e);
    for (const LocalFace& local : faces_of(mesh.shapes[e])) {
      SolidFace face{local.shape, {}, e};
      for (int a : local.nodes) face.nodes.push_back(nodes[a]);
      std::vector<int> key(face.nodes.begin(), face.nodes.begin() + corners_of(local.shape));
      std::sort(key.begin(), key.end());
      ++uses[key];
      keys.push_back(std::move(key));
      all.push_back(std::move(face));
    }
  }
  std::vector<SolidFace> boundary;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (uses[keys[i]] == 1) boundary.push_back(all[i]);
  return boundary;
}

std::vector<SolidFace> faces_where(const SolidMesh& mesh, const std::function<bool(const Vec3&)>& inside) {
  std::vector<SolidFace> chosen;
  for (SolidFace& face : boundary_faces(mesh)) {
    const auto end = face.nodes.begin() + corners_of(face.shape);
    if (std::all_of(face.nodes.begin(), end, [&](int a) { return inside(mesh.reference[a]); }))
      chosen.push_back(std::move(face));
  }
  return chosen;
}

Points traction_forces(const SolidMesh& mesh, const std::vector<SolidFace>& faces,
                       const std::function<Vec3(const Vec3&)>& traction_Pa) {
  Points force(mesh.reference.size(), Vec3::Zero());
  for (const SolidFace& face : faces)
    for (const QuadraturePoint& q : quadrature(face.shape, Rule::stiffness)) {
      const ShapeValues s = evaluate(face.shape, q.at);
      Vec3 at = Vec3::Zero(), along_r = Vec3::Zero(), along_s = Vec3::Zero();
      for (std::size_t a = 0; a < face.nodes.size(); ++a) {
        const Vec3& x = mesh.reference[face.nodes[a]];
        at += s.value[a] * x;
        along_r += s.gradient(0, a) * x;
        along_s += s.gradient(1, a) * x;
      }
      const Vec3 load = q.weight * along_r.cross(along_s).norm() * traction_Pa(at);
      for (std::size_t a = 0; a < face.nodes.size(); ++a) force[face.nodes[a]] += s.value[a] * load;
    }
  return force;
}

SolidPressureTerm::SolidPressureTerm(std::string name, std::vector<SolidFace> faces, const Body& body,
                                     std::function<double(double)> pressure_Pa)
    : name_(std::move(name)), pressure_(std::move(pressure_Pa)) {
  std::map<Shape, std::size_t> index;
  for (const SolidFace& face : faces) {
    const auto [at, fresh] = index.try_emplace(face.shape, rules_.size());
    if (fresh) {
      rules_.emplace_back();
      for (const QuadraturePoint& q : quadrature(face.shape, Rule::stiffness))
        rules_.back().push_back({q.weight, evaluate(face.shape, q.at)});
    }
    faces_.push_back({face.nodes, at->second});
    for (int& a : faces_.back().nodes) a += body.offset;
  }
}

std::array<Vec3, 2> SolidPressureTerm::tangents(const Points& x, const Face& face, const Point& point) {
  std::array<Vec3, 2> t{Vec3::Zero(), Vec3::Zero()};
  for (std::size_t a = 0; a < face.nodes.size(); ++a)
    for (int d = 0; d < 2; ++d) t[d] += point.shape.gradient(d, a) * x[face.nodes[a]];
  return t;
}

double SolidPressureTerm::add_forces(const Configuration& now, Forces& out) const {
  const double p = pressure_(now.time_s);
  if (p == 0) return 0;
  for (const Face& face : faces_)
    for (const Point& point : rules_[face.rule]) {
      const auto [r, s] = tangents(now.x, face, point);
      const Vec3 push = -p * point.weight * r.cross(s);
      for (std::size_t a = 0; a < face.nodes.size(); ++a)
        out.force[face.nodes[a]] += point.shape.value[a] * push;
    }
  return 0;
}

void SolidPressureTerm::add_tangent(const Configuration& now, BlockMatrix& out) const {
  const double p = pressure_(now.time_s);
  if (p == 0) return;
  for (const Face& face : faces_) {
    const int n = static_cast<int>(face.nodes.size());
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(3 * n, 3 * n);
    for (const Point& point : rules_[face.rule]) {
      const auto [r, s] = tangents(now.x, face, point);
      const Mat3 across_r = p * point.weight * cross_matrix(r), across_s = p * point.weight * cross_matrix(s);
      for (int b = 0; b < n; ++b) {
        const Mat3 change = point.shape.gradient(1, b) * across_r - point.shape.gradient(0, b) * across_s;
        for (int a = 0; a < n; ++a) k.block<3, 3>(3 * a, 3 * b) += point.shape.value[a] * change;
      }
    }
    out.add(face.nodes, k);
  }
}

void SolidPressureTerm::add_stiffness_bound(const Configuration& now, StiffnessBound& out) const {
  const double p = std::abs(pressure_(now.time_s));
  for (const Face& face : faces_)
    for (const Point& point : rules_[face.rule]) {
      const auto [r, s] = tangents(now.x, face, point);
      const double reach = p * point.weight * (r.norm() + s.norm());
      const double slopes = point.shape.gradient.topRows(2).cwiseAbs().sum();
      for (std::size_t a = 0; a < face.nodes.size(); ++a)
        out.translation[face.nodes[a]] += 2 * reach * slopes * std::abs(point.shape.value[a]);
    }
}

}  // namespace valsalva::structure
