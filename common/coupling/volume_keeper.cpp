#include "coupling/volume_keeper.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace valsalva::coupling {

VolumeKeeper::VolumeKeeper(std::span<const Cell> cells, const Points& start, const std::vector<Mat3>& held)
    : held_(held) {
  for (const auto& point : structure::quadrature(structure::Shape::hex8, structure::Rule::stiffness)) {
    slope_.emplace_back(structure::evaluate(structure::Shape::hex8, point.at).gradient);
    weight_.push_back(point.weight);
  }
  std::vector<int> at_node(start.size(), 0);
  for (const Cell& cell : cells) {
    if (cell.count != 4 && cell.count != 8) continue;
    cells_.push_back(cell);
    start_.push_back(volume(cell, start, nullptr));
    for (int i = 0; i < cell.count; ++i) most_at_node_ = std::max(most_at_node_, ++at_node[cell.nodes[i]]);
  }
}

double VolumeKeeper::volume(const Cell& cell, const Points& x, std::array<Vec3, 8>* gradient) const {
  const auto& at = cell.nodes;
  if (cell.count == 4) {
    const Vec3 a = x[at[1]] - x[at[0]], b = x[at[2]] - x[at[0]], c = x[at[3]] - x[at[0]];
    if (gradient) {
      auto& g = *gradient;
      g[1] = b.cross(c) / 6;
      g[2] = c.cross(a) / 6;
      g[3] = a.cross(b) / 6;
      g[0] = -(g[1] + g[2] + g[3]);
    }
    return a.dot(b.cross(c)) / 6;
  }
  double sum = 0;
  if (gradient) gradient->fill(Vec3::Zero());
  for (std::size_t q = 0; q < slope_.size(); ++q) {
    Mat3 jacobian = Mat3::Zero();
    for (int i = 0; i < 8; ++i) jacobian += x[at[i]] * slope_[q].col(i).transpose();
    sum += weight_[q] * jacobian.determinant();
    if (!gradient) continue;
    Mat3 cofactor;
    cofactor.col(0) = jacobian.col(1).cross(jacobian.col(2));
    cofactor.col(1) = jacobian.col(2).cross(jacobian.col(0));
    cofactor.col(2) = jacobian.col(0).cross(jacobian.col(1));
    for (int i = 0; i < 8; ++i) (*gradient)[i] += weight_[q] * (cofactor * slope_[q].col(i));
  }
  return sum;
}

void VolumeKeeper::correct(double share, Points& x) const {
  Points motion(x.size(), Vec3::Zero());
  std::array<Vec3, 8> gradient;
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    const double missing = start_[c] - volume(cell, x, &gradient);
    double square = 0;
    for (int i = 0; i < cell.count; ++i) {
      if (!held_.empty()) gradient[i] -= held_[cell.nodes[i]] * gradient[i];
      square += gradient[i].squaredNorm();
    }
    if (!(square > 0)) continue;
    const double by = share * missing / (most_at_node_ * square);
    for (int i = 0; i < cell.count; ++i) motion[cell.nodes[i]] += by * gradient[i];
  }
  for (std::size_t a = 0; a < x.size(); ++a) x[a] += motion[a];
}

double VolumeKeeper::largest_change(const Points& x) const {
  double largest = 0;
  for (std::size_t c = 0; c < cells_.size(); ++c)
    largest = std::max(largest, std::abs(volume(cells_[c], x, nullptr) / start_[c] - 1));
  return largest;
}

}  // namespace valsalva::coupling
