// Continuous detection: how far features may move before they come too near each other.
//
// Nodes move on straight lines from x0 (share 0) to x1 (share 1). Conservative advancement: in a share s no
// point of a pair moves by more than s l against the other feature, l the sum of the largest motions of both
// features (their mean motion taken out), so that the pair may advance by (d - stop)/l at once; repeated
// until the end or until what is left of the approach is small. Never past the first moment at which the
// distance is `stop`. Source: Li, Kaufman and Jiang 2021, Codimensional Incremental Potential Contact,
// section 5 (additive CCD). mm.
#pragma once

#include <array>

#include "contact/distance.hpp"

namespace valsalva::contact {

enum class PairKind { point_triangle, edge_edge };

inline Nearest nearest(PairKind kind, const std::array<Vec3, 4>& x) {
  return kind == PairKind::point_triangle ? point_triangle(x[0], x[1], x[2], x[3])
                                          : edge_edge(x[0], x[1], x[2], x[3]);
}

/// The share of the motion, 0 to 1, up to which the distance stays above `stop_mm`; stop_mm is less than the
/// distance at the start.
double allowed_share(PairKind kind, const std::array<Vec3, 4>& x0, const std::array<Vec3, 4>& x1,
                     double stop_mm);

}  // namespace valsalva::contact
