// Distance between the two kinds of feature pair of which surface contact consists.
//
// The distance is d = |sum_i w_i x_i|, with weights w that belong to the nearest points: positive on the
// first feature (sum 1), negative on the second (sum -1). Its gradient is w_i n, n = (sum w_i x_i) / d,
// exactly, since the nearest points are stationary (envelope theorem). d is continuous everywhere and
// differentiable except where the nearest points are not unique: features that meet (d = 0) and exactly
// parallel edges, where the value of d still is continuous and only the point of attack jumps. Closest points
// after Ericson 2005, Real-Time Collision Detection, sections 5.1.5 and 5.1.9. Lengths in mm.
#pragma once

#include <array>

#include "core/types.hpp"

namespace valsalva::contact {

struct Nearest {
  double distance = 0;
  Vec3 direction = Vec3::Zero();   ///< n: unit vector from the second feature to the first
  std::array<double, 4> weight{};  ///< w, in the order of the arguments
};

Nearest point_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
/// x[point] belongs to the first feature, x[a] x[b] is an edge of the second, or the other way round; a = b:
/// two points. The weights are those of the whole pair.
Nearest point_segment(const std::array<Vec3, 4>& x, int point, int a, int b, bool point_first);
Nearest edge_edge(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1);

}  // namespace valsalva::contact
