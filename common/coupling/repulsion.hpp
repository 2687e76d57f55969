// A light repulsion between the nodes of different leaflets: insurance for whole cycles, not contact
// mechanics. The fluid between them, carried by the common kernel, keeps leaflets about 0.1 mm apart over
// tens of milliseconds; over a beat they may creep into each other.
//
//   F_a = p (1 - d/r) sqrt(A_a A_b) (x_a - x_b)/d     for d = |x_a - x_b| < r,  and -F_a on b
//
// p: pressure at touch, Pa; A: lumped areas, mm2; r: range, mm, or the pair's distance in the rest shape
// where that is less, so that neighbours at a commissure do not push. A run may start with leaflets nearer
// than that, as a crimp leaves them: r then begins at the distance of the start and grows with `set_growth`.
// Without it they would stay together: on the grid the forces of two sheets much nearer than a cell cancel,
// and the flow does not part them. Pairs are found by a cell list and summed in a fixed order.
#pragma once

#include <vector>

#include "core/types.hpp"

namespace valsalva::coupling {

struct RepulsionParameters {
  double pressure_Pa = 1e5;
  double range_mm = 0.6;  ///< > 0; about 0.6 h
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
  /// The smallest distance between nodes of different groups met by the last call; the range when none is
  /// nearer.
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
  double nearest_;
};

}  // namespace valsalva::coupling
