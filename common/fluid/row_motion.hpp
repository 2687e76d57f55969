// What a step's report counts, over rows of cells: the squares of the velocity and the largest |u|+|v|+|w|.
// By Eigen, since compilers leave a largest value one by one (it could be NaN, which the squares tell).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

namespace valsalva::fluid {

struct RowMotion {
  double squares = 0, speed = 0;

  using Row = Eigen::Map<const Eigen::ArrayXd>;

  void add_squares(const double* u, std::ptrdiff_t count) { squares += Row(u, count).square().sum(); }
  void add(const double* w, std::ptrdiff_t count) {  ///< where w is the only component
    squares += Row(w, count).square().sum();
    speed = std::max(speed, Row(w, count).abs().maxCoeff());
  }
  void add(const double* u, const double* v, const double* w, std::ptrdiff_t count) {
    squares += (Row(u, count).square() + Row(v, count).square() + Row(w, count).square()).sum();
    add_speed(u, v, w, count);
  }
  void add_speed(const double* u, const double* v, const double* w, std::ptrdiff_t count) {
    if (count == 0) return;
    speed = std::max(speed, (Row(u, count).abs() + Row(v, count).abs() + Row(w, count).abs()).maxCoeff());
  }
};

}  // namespace valsalva::fluid
