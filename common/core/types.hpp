// The few vocabulary types that every module shares.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace valsalva {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Points = std::vector<Vec3>;  ///< node positions, velocities or forces of a body
using Triangle = std::array<int, 3>;
using Tetrahedron = std::array<int, 4>;
using Edge = std::array<int, 2>;

}  // namespace valsalva
