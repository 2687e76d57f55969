// The plane within space: C with C13 = C23 = 0, fibres with no third component, and the blocks of a 6x6
// tangent that the plane-stress reductions need.
#pragma once

#include "materials/elastic_law.hpp"

namespace valsalva::materials {

inline Mat3 in_space(const Eigen::Matrix2d& c, double c33) {
  Mat3 m = Mat3::Zero();
  m.topLeftCorner<2, 2>() = c;
  m(2, 2) = c33;
  return m;
}

inline Fibres in_space(const PlaneFibres& plane) {
  Fibres fibres;
  fibres.count = plane.count;
  for (int i = 0; i < plane.count; ++i)
    fibres.direction[i] = {plane.direction[i][0], plane.direction[i][1], 0};
  return fibres;
}

struct PlaneBlocks {
  Eigen::Matrix3d plane;     ///< rows and columns 11, 22, 12
  Eigen::Vector3d coupling;  ///< with 33
  double thickness;          ///< 33, 33
};

inline PlaneBlocks plane_blocks(const Tangent6& d) {
  constexpr std::array<int, 3> in{0, 1, 3};
  PlaneBlocks b;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) b.plane(i, j) = d(in[i], in[j]);
    b.coupling[i] = d(in[i], 2);
  }
  b.thickness = d(2, 2);
  return b;
}

}  // namespace valsalva::materials
