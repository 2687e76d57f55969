// The pressure that keeps an enclosed volume, as a fluid that is pumped in: it goes beyond the limit points
// of a prescribed pressure.
//
//   V = sum over triangles of det(x_a - o, x_b - o, x_c - o)/6,   E = K/2 (V - V*)^2/V0,   p = K (V* - V)/V0,
//   V* = V0 (1 + (ratio - 1) factor(t)),   f = p dV/dx,   tangent K/V0 g g^T - p d2V/dx2, exact.
// o: any point for a closed surface; a point of all symmetry planes that close it, which then bear no part of
// the sum. Pa, mm3, nJ.
#pragma once

#include <string>
#include <vector>

#include "assembly/time_table.hpp"
#include "structure/force_term.hpp"

namespace valsalva::assembly {

class VolumeLoad : public structure::ForceTerm {
 public:
  /// Triangles with nodes of the system, outwards. InputError when the reference volume is not positive.
  VolumeLoad(std::string name, std::vector<Triangle> triangles, const Vec3& apex, const Points& reference,
             double ratio, double bulk_Pa, TimeTable factor);
  std::string name() const override { return name_; }
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  void add_stiffness_bound(const structure::Configuration& now,
                           structure::StiffnessBound& out) const override;
  void add_tangent(const structure::Configuration& now, structure::BlockMatrix& out) const override;

  double volume_mm3(const Points& x) const;
  double pressure_Pa(const structure::Configuration& now) const;

 private:
  Points gradient(const Points& x) const;  // one entry of nodes_

  std::string name_;
  std::vector<Triangle> triangles_;
  Vec3 apex_;
  double ratio_, bulk_;
  TimeTable factor_;
  std::vector<int> nodes_;       // that the triangles use, ascending
  std::vector<Triangle> local_;  // the triangles in their numbering
  double reference_volume_ = 0;
};

}  // namespace valsalva::assembly
