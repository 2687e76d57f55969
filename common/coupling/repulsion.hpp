// Repulsion between the nodes of different leaflets, two cones of force about every node:
//
//   F_a = sum over cones of 3 p/(pi r^2) A_a A_b (1 - d/r) (x_a - x_b)/d    for d = |x_a - x_b| < r,  -F_a on
//   b
//
// A: lumped areas, so that two parallel sheets at a distance D push each other with the pressure
// 3 p (D/r) (1 - D/r)^2 on any mesh, 0.44 p at most (at D = r/3).
//
// Contact (p 200 kPa, r 0.6 h): insurance for whole cycles, not contact mechanics. The fluid between
// leaflets, carried by the common kernel, keeps them about 0.1 mm apart over tens of milliseconds; over a
// beat they may creep into each other. Parting (p 10 kPa, r 1.5 h): leaflets much nearer than a cell would
// stay together in systole, because on the grid the opposite forces that part them cancel. Its push of some 4
// kPa parts them, and yields to the pressure that closes them (docs/decisions/parting.md).
//
// r shrinks to the pair's distance in the rest shape where that is less, so that neighbours at a commissure
// do not push. A run may start with leaflets nearer than that, as a crimp leaves them: r then begins at the
// distance of the start and grows with `set_growth`. Pairs are found by a cell list and summed in a fixed
// order.
#pragma once

#include <vector>

#include "core/types.hpp"

namespace valsalva::coupling {

struct RepulsionParameters {
  struct Cone {
    double pressure_Pa = 0;  ///< p
    double range_mm = 1;     ///< r > 0
  };
  Cone contact{2e5, 0.6}, parting;
};

class Repulsion {
 public:
  /// group: nodes of the same group do not see each other; negative: the node takes no part.
  Repulsion(const RepulsionParameters& parameters, Points rest, Points start, std::vector<int> group,
            std::vector<double> area);
  /// From 0, ranges as at the start, to 1, full ranges (also the initial value).
  void set_growth(double growth) { growth_ = growth; }
  /// force += F; returns the energy, nJ.
  double add_forces(const Points& x, Points& force);
  /// out += K y, the tangent at the last add_forces without its negative part across the pair's direction.
  void add_tangent_product(const Points& y, Points& out) const;
  /// The smallest distance between nodes of different groups met by the last call; the larger range when none
  /// is nearer.
  double nearest() const { return nearest_; }

 private:
  struct Pair {
    int a, b;
    double stiffness;  // uN/mm
    Vec3 direction;
  };
  RepulsionParameters parameters_;
  Points rest_x_, start_x_;
  double growth_ = 1;
  std::vector<int> group_;
  std::vector<double> area_;
  std::vector<int> order_, start_;  // nodes sorted by cell
  std::vector<Pair> pairs_;
  double range_, nearest_;
};

}  // namespace valsalva::coupling
