// The stiffness -d(force)/d(position) of a System: a sparse sum of element matrices in blocks of 3x3.
//
// A block row is a slot: node a is slot a, rotation r is slot nodes + r. The increment of a rotation is a
// spin w in space, R <- exp(w) R, and its row is that of the moment in space. The pattern grows as blocks are
// added and stays from one assembly to the next; sums have the order of the calls.
//
// Beside the blocks stand rank-one terms, factor v v^T (the volume constraint of a patch of tetrahedra, which
// couples a hundred nodes): K = blocks + sum_k c_k v_k v_k^T. The linear solver gives each an unknown of its
// own, q = c v.u, instead of filling the matrix.
// Units: uN/mm, uN/rad, uN mm/mm, uN mm/rad.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <map>
#include <span>
#include <vector>

#include "core/types.hpp"
#include "structure/threads.hpp"

namespace valsalva::structure {

class BlockMatrix {
 public:
  struct Row {
    std::vector<int> columns;  ///< ascending slots
    std::vector<Mat3> blocks;
  };

  /// An element's matrix and its slots.
  struct Piece {
    std::vector<int> slots;
    Eigen::MatrixXd k;
  };
  struct RankOne {
    std::vector<int> slots;
    Eigen::VectorXd vector;  ///< 3 a slot
    double factor;
  };

  BlockMatrix(std::size_t nodes, std::size_t rotations) : nodes_(nodes), rows_(nodes + rotations) {}
  int slots() const { return static_cast<int>(rows_.size()); }
  int nodes() const { return static_cast<int>(nodes_); }
  int slot_of_rotation(int rotation) const { return nodes() + rotation; }
  const Row& row(int slot) const { return rows_[slot]; }

  /// Values to zero; the pattern stays.
  void set_zero();
  /// Adds the 3n x 3n matrix k of the n given slots.
  void add(std::span<const int> slots, const Eigen::Ref<const Eigen::MatrixXd>& k);
  void add(int row, int column, const Mat3& k);
  /// The same for several elements, the rows shared among the threads; sums keep the order of the pieces.
  void add(std::span<const Piece> pieces);
  void add_rank_one(std::span<const int> slots, const Eigen::VectorXd& v, double factor);
  std::span<const RankOne> rank_ones() const { return {rank_ones_.data(), rank_ones_used_}; }
  /// Changes whenever the pattern grows.
  long pattern_version() const { return version_; }
  /// K_ij <- Q_i^T K_ij Q_j, Q the given frames (columns: axes) of some slots, the identity elsewhere.
  void turn(const std::map<int, Mat3>& frames);
  /// All values times a factor.
  void scale(double factor);
  /// out = K u, both 3 a slot.
  Eigen::VectorXd times(const Eigen::VectorXd& u) const;

 private:
  // Adds to one block; true when it is new.
  static bool add_to(Row& row, int column, const Mat3& k);
  std::size_t nodes_;
  std::vector<Row> rows_;
  std::vector<RankOne> rank_ones_;
  std::size_t rank_ones_used_ = 0;
  long version_ = 0;
};

/// Adds count element matrices: fill(i, piece) for each on the threads, batch by batch, which bounds the
/// memory; sums keep the order of i. Failures as for_all's.
template <class Fill>
void add_in_batches(int count, BlockMatrix& out, const Fill& fill, const char* what = "") {
  constexpr int batch = 256;
  std::vector<BlockMatrix::Piece> pieces(batch);
  for (int first = 0; first < count; first += batch) {
    const int now = std::min(batch, count - first);
    for_all(now, what, first, [&](int i) { fill(first + i, pieces[i]); });
    out.add({pieces.data(), static_cast<std::size_t>(now)});
  }
}

/// [v]x, so that [v]x w = v x w.
inline Mat3 cross_matrix(const Vec3& v) {
  return (Mat3() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}

}  // namespace valsalva::structure
