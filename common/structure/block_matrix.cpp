#include "structure/block_matrix.hpp"

#include <omp.h>

#include <algorithm>

namespace valsalva::structure {

void BlockMatrix::set_zero() {
  for (Row& row : rows_) std::fill(row.blocks.begin(), row.blocks.end(), Mat3::Zero());
  rank_ones_used_ = 0;
}

bool BlockMatrix::add_to(Row& r, int column, const Mat3& k) {
  const auto at = std::lower_bound(r.columns.begin(), r.columns.end(), column);
  const auto index = at - r.columns.begin();
  if (at != r.columns.end() && *at == column) {
    r.blocks[index] += k;
    return false;
  }
  r.columns.insert(at, column);
  r.blocks.insert(r.blocks.begin() + index, k);
  return true;
}

void BlockMatrix::add(int row, int column, const Mat3& k) {
  if (add_to(rows_[row], column, k)) ++version_;
}

void BlockMatrix::add(std::span<const int> slots, const Eigen::Ref<const Eigen::MatrixXd>& k) {
  const int n = static_cast<int>(slots.size());
  for (int a = 0; a < n; ++a)
    for (int b = 0; b < n; ++b) add(slots[a], slots[b], k.block<3, 3>(3 * a, 3 * b));
}

void BlockMatrix::add(std::span<const Piece> pieces) {
  long grown = 0;
#pragma omp parallel reduction(+ : grown)
  {
    const int threads = omp_get_num_threads(), own = omp_get_thread_num();
    for (const Piece& piece : pieces) {
      const int n = static_cast<int>(piece.slots.size());
      for (int a = 0; a < n; ++a) {
        if (piece.slots[a] % threads != own) continue;
        Row& row = rows_[piece.slots[a]];
        for (int b = 0; b < n; ++b) grown += add_to(row, piece.slots[b], piece.k.block<3, 3>(3 * a, 3 * b));
      }
    }
  }
  version_ += grown;
}

void BlockMatrix::add_rank_one(std::span<const int> slots, const Eigen::VectorXd& v, double factor) {
  if (rank_ones_used_ == rank_ones_.size()) {
    rank_ones_.emplace_back();
    ++version_;
  }
  RankOne& term = rank_ones_[rank_ones_used_++];
  if (!std::equal(slots.begin(), slots.end(), term.slots.begin(), term.slots.end())) {
    term.slots.assign(slots.begin(), slots.end());
    ++version_;
  }
  term.vector = v;
  term.factor = factor;
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
  for (std::size_t t = 0; t < rank_ones_used_; ++t)
    for (std::size_t k = 0; k < rank_ones_[t].slots.size(); ++k)
      if (const auto own = frames.find(rank_ones_[t].slots[k]); own != frames.end()) {
        auto part = rank_ones_[t].vector.segment<3>(3 * static_cast<Eigen::Index>(k));
        part = (own->second.transpose() * part).eval();
      }
}

void BlockMatrix::scale(double factor) {
  for (Row& row : rows_)
    for (Mat3& k : row.blocks) k *= factor;
  for (std::size_t t = 0; t < rank_ones_used_; ++t) rank_ones_[t].factor *= factor;
}

Eigen::VectorXd BlockMatrix::times(const Eigen::VectorXd& u) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(3 * slots());
  for (int i = 0; i < slots(); ++i)
    for (std::size_t k = 0; k < rows_[i].columns.size(); ++k)
      out.segment<3>(3 * i) += rows_[i].blocks[k] * u.segment<3>(3 * rows_[i].columns[k]);
  for (const RankOne& term : rank_ones()) {
    const Eigen::Index n = static_cast<Eigen::Index>(term.slots.size());
    double along = 0;
    for (Eigen::Index k = 0; k < n; ++k)
      along += term.vector.segment<3>(3 * k).dot(u.segment<3>(3 * term.slots[k]));
    for (Eigen::Index k = 0; k < n; ++k)
      out.segment<3>(3 * term.slots[k]) += term.factor * along * term.vector.segment<3>(3 * k);
  }
  return out;
}

}  // namespace valsalva::structure
