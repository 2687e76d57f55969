// The solver opens its box at the ends of its z-axis only (fluid/boundary.hpp). A scene whose sides of known
// pressure lie along x or y is solved in turned axes: x -> y -> z -> x, so often as it takes. All that a case
// file says and all that is written out is in the axes of the case.
#pragma once

#include <array>

#include "core/types.hpp"

namespace valsalva::flow_scene {

struct Frame {
  int shift = 0;  ///< axis e of the solver is the axis (e + shift) % 3 of the case

  static Frame with_open_axis(int axis) { return {(axis + 1) % 3}; }
  int case_axis(int solver_axis) const { return (solver_axis + shift) % 3; }
  int solver_axis(int case_axis) const { return (case_axis + 3 - shift) % 3; }
  Vec3 to_case(const Vec3& v) const {
    Vec3 out;
    for (int e = 0; e < 3; ++e) out[case_axis(e)] = v[e];
    return out;
  }
  Vec3 to_solver(const Vec3& v) const {
    Vec3 out;
    for (int e = 0; e < 3; ++e) out[e] = v[case_axis(e)];
    return out;
  }
};

}  // namespace valsalva::flow_scene
