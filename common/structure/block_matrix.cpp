#include "structure/block_matrix.hpp"

#include <algorithm>

namespace valsalva::structure {

void BlockMatrix::set_zero() {
  for (Row& row : rows_) std::fill(row.blocks.begin(), row.blocks.end(), Mat3::Zero());
}

Mat3& BlockMatrix::block(int row, int column) {
  Row& r = rows_[row];
  const auto at = std::lower_bound(r.columns.begin(), r.columns.end(), column);
  const auto index = at - r.columns.begin();
  if (at == r.columns.end() || *at != column) {
    r.columns.insert(at, column);
    r.blocks.insert(r.blocks.begin() + index, Mat3::Zero());
    ++version_;
  }
  return r.blocks[index];
}

void BlockMatrix::add(std::span<const int> slots, const Eigen::Ref<const Eigen::MatrixXd>& k) {
  const int n = static_cast<int>(slots.size());
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) block(slots[a], slots[b]) += k.block<3, 3>(3 * a, 3 * b);
}

void BlockMatrix::turn(const std::map<int, Mat3>& frames) {
  if (frames.empty()) return;
  for (int i = 0; i < slots(); ++i) {
    Row& row = rows_[i];
    const auto own = frames.find(i);
    for (std::size_t k = 0; k < row.columns.size(); ++k) {
      if (own != frames.end()) row.blocks[k] = (own->second.transpose() * row.blocks[k]).eval();
      const auto other = frames.find(row.columns[k]);
      if (other != frames.end()) row.blocks[k] = (row.blocks[k] * other->second).eval();
    }
  }
}

void BlockMatrix::scale(double factor) {
  for (Row& row : rows_)
    for (Mat3& k : row.blocks) k *= factor;
}

Eigen::VectorXd BlockMatrix::times(const Eigen::VectorXd& u) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(3 * slots());
  for (int i = 0; i < slots(); ++i)
    for (std::size_t k = 0; k < rows_[i].columns.size(); ++k)
      out.segment<3>(3 * i) += rows_[i].blocks[k] * u.segment<3>(3 * rows_[i].columns[k]);
  return out;
}

}  // namespace valsalva::structure
