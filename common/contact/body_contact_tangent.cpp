// The tangent of contact: second derivatives of the distance, and of friction.
#include <Eigen/Dense>

#include "contact/body_contact.hpp"

namespace valsalva::contact {
namespace {

using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Weights = std::array<double, 4>;

/// How the weights change with the free coordinates of the nearest points: none at a corner.
std::vector<Weights> free_coordinates(PairKind kind, const Weights& w) {
  std::vector<Weights> change;
  if (kind == PairKind::edge_edge) {
    if (w[0] != 0 && w[1] != 0) change.push_back({-1, 1, 0, 0});
    if (w[2] != 0 && w[3] != 0) change.push_back({0, 0, 1, -1});
    return change;
  }
  std::vector<int> corners;  // on which the nearest point depends
  for (int k = 1; k < 4; ++k)
    if (w[k] != 0) corners.push_back(k);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    Weights d{};
    d[corners[0]] = 1;
    d[corners[i]] = -1;
    change.push_back(d);
  }
  return change;
}

/// Of d = min over u of |r(x, u)|, r = sum w_i(u) x_i: D_xx - D_xu D_uu^-1 D_ux.
Matrix12 distance_hessian(PairKind kind, const std::array<Vec3, 4>& x, const Weights& w, const Vec3& n,
                          double d) {
  const Mat3 across = (Mat3::Identity() - n * n.transpose()) / d;
  Matrix12 h;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) h.block<3, 3>(3 * i, 3 * j) = w[i] * w[j] * across;
  const std::vector<Weights> free = free_coordinates(kind, w);
  const int count = static_cast<int>(free.size());
  if (count == 0) return h;
  Eigen::MatrixXd uu(count, count), xu(12, count);
  std::vector<Vec3> r(count, Vec3::Zero());  // dr/du
  for (int a = 0; a < count; ++a)
    for (int i = 0; i < 4; ++i) r[a] += free[a][i] * x[i];
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) uu(a, b) = r[a].dot(across * r[b]);
    for (int i = 0; i < 4; ++i) xu.block<3, 1>(3 * i, a) = free[a][i] * n + w[i] * (across * r[a]);
  }
  // Parallel edges: the nearest points are not unique, and are kept as they are.
  if (uu.determinant() <= 1e-10 * uu.diagonal().prod()) return h;
  h -= xu * uu.inverse() * xu.transpose();
  return h;
}

}  // namespace

void BodyContact::add_tangent(const structure::Configuration& now, structure::BlockMatrix& out) const {
  find_active(now.x);
  for (const auto& chunk : active_)
    for (const Active& pair : chunk) {
      if (!(pair.distance_mm > 0)) continue;
      std::array<Vec3, 4> x;
      Vector12 gradient;
      for (int k = 0; k < 4; ++k) {
        x[k] = now.x[pair.node[k]];
        gradient.segment<3>(3 * k) = pair.weight[k] * pair.direction;
      }
      Matrix12 k =
          pair.at.stiffness * gradient * gradient.transpose() -
          pair.at.pressure * distance_hessian(pair.kind, x, pair.weight, pair.direction, pair.distance_mm);
      if (const PairFriction& f = pair.friction; f.coefficient > 0 && f.known) {
        // f_i = w_i on_first; on_first = -mu N t/u with t from sum w_j x_j, cut off at u.
        Mat3 slope = Mat3::Identity() - f.normal * f.normal.transpose();
        if (f.slips()) {
          const Vec3 along = f.tether.normalized();
          slope = f.range_mm / f.way_mm * (slope - along * along.transpose());
        }
        slope *= f.coefficient * f.pressing_uN / f.range_mm;
        const double pressing = pair.at.pressure > 0 ? f.pressing_uN / pair.at.pressure : 0;
        const Vec3 per_force = f.coefficient * pressing / f.range_mm * f.tether;  // -d on_first/dN
        Vector12 pulled;
        for (int i = 0; i < 4; ++i) pulled.segment<3>(3 * i) = pair.weight[i] * per_force;
        k -= pair.at.stiffness * pulled * gradient.transpose();  // dN = -N' dd
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j) k.block<3, 3>(3 * i, 3 * j) += pair.weight[i] * pair.weight[j] * slope;
      }
      out.add(pair.node, Eigen::MatrixXd(k));
    }
}

}  // namespace valsalva::contact
