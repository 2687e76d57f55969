// Where a leaflet couples to the grid: at its nodes, but no nearer to another leaflet than a standoff.
//
//   y_a = x_a + sign_a m_a/2 max over b of (r_ab - d_ab)+,  r_ab = min(s, distance of the pair in the rest
//   shape)
//
// m_a: normal of the leaflet at a; sign_a = clamp((m_a . n_a)/0.3, -1, 1), n_a the direction of
// sum_b (1 - d_ab/s)^2 (x_a - x_b)/d_ab: from +1 to -1 without a jump where another leaflet's edge points at
// this one.
//
// Two sheets much nearer than a cell have one velocity on the grid, and the opposite forces that should part
// them cancel: once they touch, they stay together (docs/decisions/parting.md). Spreading from y and
// interpolating at the same y lets the grid see two sheets a standoff s apart with fluid between them, as
// adjoint operators, without a force that the valve does not have. Nodes further than s from other leaflets
// couple where they are.
#pragma once

#include "coupling/near_pairs.hpp"

namespace valsalva::coupling {

/// normal: of each node, of any length. near: all pairs nearer than the standoff at x (or more).
void stand_off(double standoff_mm, const Points& x, const Points& normal, const std::vector<NearPair>& near,
               Points& out);

}  // namespace valsalva::coupling
