#include "fibres.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::mesher {
namespace {

/// Gradients of the three linear shape functions.
std::array<Vec3, 3> shape_gradients(const geometry::TriMesh& mesh, const Triangle& t) {
  const Vec3 &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
  const Vec3 normal = (b - a).cross(c - a);
  const double squared = normal.squaredNorm();
  return {normal.cross(c - b) / squared, normal.cross(a - c) / squared, normal.cross(b - a) / squared};
}

double area_of(const geometry::TriMesh& mesh, const Triangle& t) {
  return 0.5 * (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]).norm();
}

Vec3 unit_normal(const geometry::TriMesh& mesh, const Triangle& t) {
  return (mesh.points[t[1]] - mesh.points[t[0]]).cross(mesh.points[t[2]] - mesh.points[t[0]]).normalized();
}

}  // namespace

std::vector<double> harmonic(const geometry::TriMesh& mesh, const std::vector<double>& known) {
  std::vector<int> unknown(known.size(), -1);
  int count = 0;
  for (std::size_t i = 0; i < known.size(); ++i)
    if (known[i] < 0) unknown[i] = count++;
  std::vector<double> potential = known;
  if (count == 0) return potential;

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd load = Eigen::VectorXd::Zero(count);
  for (const Triangle& t : mesh.triangles) {
    const auto gradients = shape_gradients(mesh, t);
    const double area = area_of(mesh, t);
    for (int i = 0; i < 3; ++i) {
      if (unknown[t[i]] < 0) continue;
      for (int j = 0; j < 3; ++j) {
        const double k = area * gradients[i].dot(gradients[j]);
        if (unknown[t[j]] >= 0)
          entries.emplace_back(unknown[t[i]], unknown[t[j]], k);
        else
          load[unknown[t[i]]] -= k * known[t[j]];
      }
    }
  }
  Eigen::SparseMatrix<double> stiffness(count, count);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(stiffness);
  if (solver.info() != Eigen::Success)
    throw NumericalFailure("fibre potential: the leaflet mesh has parts without a commissure");
  const Eigen::VectorXd solution = solver.solve(load);
  for (std::size_t i = 0; i < known.size(); ++i)
    if (unknown[i] >= 0) potential[i] = solution[unknown[i]];
  return potential;
}

FibreField fibre_families(const geometry::TriMesh& mesh, const std::vector<double>& potential,
                          double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180;
  FibreField fibres;
  for (const Triangle& t : mesh.triangles) {
    const auto gradients = shape_gradients(mesh, t);
    Vec3 mean = Vec3::Zero();
    for (int k = 0; k < 3; ++k) mean += potential[t[k]] * gradients[k];
    const Vec3 normal = unit_normal(mesh, t);
    // A triangle whose corners all lie on one commissure has no gradient: it takes its first edge.
    if (mean.norm() < 1e-12) mean = mesh.points[t[1]] - mesh.points[t[0]];
    mean = (mean - mean.dot(normal) * normal).normalized();
    fibres.first.push_back(Eigen::AngleAxisd(angle, normal) * mean);
    fibres.second.push_back(Eigen::AngleAxisd(-angle, normal) * mean);
  }
  return fibres;
}

double fibre_unit_error(const geometry::TriMesh& mesh, const FibreField& fibres) {
  double worst = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Vec3 normal = unit_normal(mesh, mesh.triangles[i]);
    for (const Vec3& f : {fibres.first[i], fibres.second[i]})
      worst = std::max({worst, std::abs(f.norm() - 1), std::abs(f.dot(normal))});
  }
  return worst;
}

}  // namespace valsalva::mesher
