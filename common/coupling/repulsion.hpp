// A repulsion between the nodes of different leaflets: insurance for whole cycles, not contact mechanics. The
// fluid between them, carried by the common kernel, keeps leaflets about 0.1 mm apart over tens of
// milliseconds; over a beat they may creep into each other.
//
//   F_a = 3 p/(pi r^2) A_a A_b (1 - d/r) (x_a - x_b)/d     for d = |x_a - x_b| < r,  and -F_a on b
//
// A: lumped areas, so that two parallel sheets at a distance D push each other with the pressure
// 3 p (D/r) (1 - D/r)^2 on any mesh, 0.44 p at most (at D = r/3).
//
// r shrinks to the pair's distance in the rest shape where that is less, so that neighbours at a commissure
// do not push. A run may start with leaflets nearer than that, as a crimp leaves them: r then begins at the
// distance of the start and grows with `set_growth`.
#pragma once

#include "coupling/near_pairs.hpp"

namespace valsalva::coupling {

struct RepulsionParameters {
  double pressure_Pa = 2e5;  ///< p
  double range_mm = 0.6;     ///< r > 0; about 0.6 h
};

class Repulsion {
 public:
  Repulsion(const RepulsionParameters& parameters, std::vector<double> area);
  /// From 0, ranges as at the start, to 1, full ranges (also the initial value).
  void set_growth(double growth) { growth_ = growth; }
  /// force += F by the pairs near at x; returns the energy, nJ.
  double add_forces(const Points& x, const std::vector<NearPair>& near, Points& force);
  /// out += K y, the tangent at the last add_forces without its negative part across the pair's direction.
  void add_tangent_product(const Points& y, Points& out) const;
  /// The smallest distance between nodes that repelled each other at the last call; the range when none did.
  double nearest() const { return nearest_; }

 private:
  struct Pair {
    int a, b;
    double stiffness;  // uN/mm
    Vec3 direction;
  };
  RepulsionParameters parameters_;
  double growth_ = 1;
  std::vector<double> area_;
  std::vector<Pair> pairs_;
  double nearest_;
};

}  // namespace valsalva::coupling
