#include "flow_scene/section_profile.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/errors.hpp"

namespace valsalva::flow_scene {

std::function<double(const Vec3&)> section_profile(const Vec3& centre, const Vec3& normal, double radius,
                                                   const std::function<double(const Vec3&)>& fluid,
                                                   double spacing) {
  constexpr int most = 200;  // points along a radius
  const int half = std::clamp(static_cast<int>(std::ceil(radius / spacing)), 10, most);
  const int n = 2 * half + 1;
  const double a = radius / half;
  const Vec3 e1 = normal.unitOrthogonal(), e2 = normal.cross(e1);
  std::vector<double> level(static_cast<std::size_t>(n) * n);
  std::vector<int> number(level.size(), -1);
  int unknowns = 0;
  for (int q = 0; q < n; ++q) {
    for (int p = 0; p < n; ++p) {
      const std::size_t at = static_cast<std::size_t>(q) * n + p;
      const double x = a * (p - half), y = a * (q - half);
      level[at] = std::min(fluid(centre + x * e1 + y * e2), radius - std::hypot(x, y));
      const bool inside = p > 0 && q > 0 && p < n - 1 && q < n - 1 && level[at] > 0;
      if (inside) number[at] = unknowns++;
    }
  }
  auto value = std::make_shared<std::vector<double>>(level.size(), 0.0);
  if (unknowns > 0) {
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t at = 0; at < level.size(); ++at) {
      if (number[at] < 0) continue;
      double diagonal = 0;
      for (const std::ptrdiff_t to :
           {std::ptrdiff_t{-1}, std::ptrdiff_t{1}, -std::ptrdiff_t{n}, std::ptrdiff_t{n}}) {
        const std::size_t other = at + static_cast<std::size_t>(to);
        if (number[other] >= 0) {
          diagonal += 1;
          entries.emplace_back(number[at], number[other], -1.0);
        } else {
          const double share = level[at] / (level[at] - std::min(0.0, level[other]));
          diagonal += 1 / std::clamp(share, 0.05, 1.0);
        }
      }
      entries.emplace_back(number[at], number[at], diagonal);
    }
    Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    const Eigen::VectorXd found = solver.solve(Eigen::VectorXd::Constant(unknowns, a * a));
    if (solver.info() != Eigen::Success || !found.allFinite())
      throw NumericalFailure("fluid: the profile of developed flow at ({}, {}, {}) mm was not found",
                             centre[0], centre[1], centre[2]);
    for (std::size_t at = 0; at < level.size(); ++at)
      if (number[at] >= 0) (*value)[at] = found[number[at]];
  }
  return [=](const Vec3& x) {
    const Vec3 r = x - centre;
    const double s = r.dot(e1) / a + half, t = r.dot(e2) / a + half;
    const int p = static_cast<int>(std::floor(s)), q = static_cast<int>(std::floor(t));
    if (p < 0 || q < 0 || p >= n - 1 || q >= n - 1) return 0.0;
    const double u = s - p, v = t - q;
    const double* f = value->data() + static_cast<std::size_t>(q) * n + p;
    return (1 - v) * ((1 - u) * f[0] + u * f[1]) + v * ((1 - u) * f[n] + u * f[n + 1]);
  };
}

}  // namespace valsalva::flow_scene
