// The pressure equation lap phi = b on cell centres, plane by plane.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>

#include "fluid/grid.hpp"

namespace valsalva::fluid {

/// One plane of cells to be filled or read, a row of nx doubles for each j; the solver says where they stand.
class CellRows {
 public:
  /// order: where row j stands, in rows; none: in turn.
  CellRows(double* first, std::ptrdiff_t stride, const int* order = nullptr)
      : first_(first), stride_(stride), order_(order) {}
  double* row(int j) const { return first_ + (order_ ? order_[j] : j) * stride_; }
  double& operator()(int i, int j) const { return row(j)[i]; }
  void copy_to(Field& field, int k, int nx, int ny) const {
    for (int j = 0; j < ny; ++j) std::copy_n(row(j), nx, field.row(j, k));
  }

 private:
  double* first_;
  std::ptrdiff_t stride_;
  const int* order_;
};

class PressureSolver {
 public:
  virtual ~PressureSolver() = default;
  /// Fills the local plane k. Planes are visited once each, in an order of the solver's choice.
  using Source = std::function<void(int k, const CellRows& b)>;
  /// Collective. Fills the owned cells of phi. Where its mean is free, the mean of b is dropped and that of
  /// phi is 0. within: b is zero in all other planes, and phi is left there as it is; they may still be
  /// visited.
  virtual void solve(const Source& b, Field& phi, Planes within = {}) = 0;
};

}  // namespace valsalva::fluid
