#include "coupling/volume_keeper.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/errors.hpp"

namespace valsalva::coupling {

namespace {

// Of the mean diagonal: parts whose pressures no motion tells apart (checkerboards) and parts that are held.
constexpr double regular = 1e-10;

Eigen::Map<Eigen::VectorXd> flat(Points& points, Eigen::Index size) {
  return {points.front().data(), size};
}

}  // namespace

VolumeKeeper::VolumeKeeper(std::span<const Cell> cells, const Points& start, const std::vector<Mat3>& held,
                           int most_direct)
    : held_(held) {
  for (const auto& point : structure::quadrature(structure::Shape::hex8, structure::Rule::stiffness)) {
    slope_.emplace_back(structure::evaluate(structure::Shape::hex8, point.at).gradient);
    weight_.push_back(point.weight);
  }
  std::vector<int> around(start.size(), -1);  // the part of the tetrahedra around a node
  int parts = 0;
  for (const Cell& cell : cells) {
    if (cell.count != 4 && cell.count != 8) continue;
    cells_.push_back(cell);
    std::vector<int>& mine = parts_of_.emplace_back();
    if (cell.count == 8) {
      mine.push_back(parts++);
      continue;
    }
    for (int i = 0; i < 4; ++i) {
      int& part = around[cell.nodes[i]];
      if (part < 0) part = parts++;
      mine.push_back(part);
    }
  }
  start_.setZero(parts);
  gradient_.resize(parts, 3 * static_cast<Eigen::Index>(start.size()));
  free_gradient_.resize(gradient_.rows(), gradient_.cols());
  start_ = now_ = volumes(start);
  measure_ = nodal_measures(cells_, start);
  const double mean =
      std::accumulate(measure_.begin(), measure_.end(), 0.0) / static_cast<double>(start.size());
  for (double& m : measure_) m = m > 0 ? m / mean : 1;
  direct_ = parts <= most_direct;
  iterations_.setTolerance(1e-10);
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

Eigen::VectorXd VolumeKeeper::volumes(const Points& x) const {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(start_.size());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const double each = volume(cells_[c], x, nullptr);
    for (int part : parts_of_[c]) sum[part] += each;
  }
  return sum;
}

void VolumeKeeper::update(const Points& x) {
  std::vector<Eigen::Triplet<double>> all, free;
  std::array<Vec3, 8> gradient;
  now_.setZero(start_.size());
  for (std::size_t c = 0; c < cells_.size(); ++c) {
    const Cell& cell = cells_[c];
    const double each = volume(cell, x, &gradient);
    for (int part : parts_of_[c]) now_[part] += each;
    for (int i = 0; i < cell.count; ++i) {
      const int a = cell.nodes[i];
      const Vec3 of_free = held_.empty() ? gradient[i] : Vec3(gradient[i] - held_[a] * gradient[i]);
      for (int d = 0; d < 3; ++d)
        for (int part : parts_of_[c]) {
          all.emplace_back(part, 3 * a + d, gradient[i][d]);
          free.emplace_back(part, 3 * a + d, of_free[d] / measure_[a]);
        }
    }
  }
  gradient_.setFromTriplets(all.begin(), all.end());
  free_gradient_.setFromTriplets(free.begin(), free.end());
  product_ = free_gradient_ * Sparse(gradient_.transpose());
  const double add = regular * product_.diagonal().mean();
  product_.diagonal().array() += add;
  if (!direct_) {
    iterations_.compute(product_);
    return;
  }
  if (product_.nonZeros() != analysed_) factors_.analyzePattern(product_);
  analysed_ = product_.nonZeros();
  factors_.factorize(product_);
  if (factors_.info() != Eigen::Success || !factors_.vectorD().allFinite())
    throw NumericalFailure(
        "coupling: the volumes of solids' elements cannot be kept, some have collapsed (the largest change "
        "of a volume is by {:.3g} times)",
        largest_change(x));
}

Eigen::VectorXd VolumeKeeper::pressures(const Eigen::VectorXd& growth) const {
  if (direct_) return factors_.solve(growth);
  Eigen::VectorXd found = iterations_.solve(growth);
  if (iterations_.info() != Eigen::Success || !found.allFinite())
    throw NumericalFailure(
        "coupling: the pressures that keep the volumes of solids' elements were not found in {} iterations "
        "(error {:.2g})",
        iterations_.iterations(), iterations_.error());
  return found;
}

void VolumeKeeper::constrain_force(Points& force) const {
  auto f = flat(force, gradient_.cols());
  f -= gradient_.transpose() * pressures(free_gradient_ * f);
}

void VolumeKeeper::constrain_velocity(Points& velocity, const Eigen::VectorXd& growth) const {
  auto u = flat(velocity, gradient_.cols());
  u -= free_gradient_.transpose() * pressures(gradient_ * u - growth);
}

void VolumeKeeper::constrain_velocity(Points& velocity) const {
  constrain_velocity(velocity, Eigen::VectorXd::Zero(start_.size()));
}

void VolumeKeeper::constrain_velocity(Points& velocity, double dt_s) const {
  constrain_velocity(velocity, Eigen::VectorXd((start_ - now_) / dt_s));
}

double VolumeKeeper::largest_change(const Points& x) const {
  if (empty()) return 0;
  return (volumes(x).array() / start_.array() - 1).abs().maxCoeff();
}

}  // namespace valsalva::coupling
