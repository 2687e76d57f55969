// Viscosity of tissue: dashpots along the edges of its triangles and across its hinges,
//   f_i = -c ((v_i - v_j) . e) e,   c = beta min(m_i, m_j),   e the unit vector from j to i.
// Linear and angular momentum are conserved and rigid motion is free; what dies out, at a rate of the order
// of 10 beta, is the ringing from node to node that the explicit step resolves barely and the law's
// exponential would feed. Masses are the physical ones. beta in 1/s (assumed; small against 1/step).
#pragma once

#include "structure/force_term.hpp"
#include "structure/shell.hpp"

namespace valsalva::crimp {

class TissueDamping : public structure::ForceTerm {
 public:
  TissueDamping(std::string name, const std::vector<Triangle>& triangles, const std::vector<double>& mass,
                int offset, double beta_per_s);
  std::string name() const override { return name_; }
  double add_forces(const structure::Configuration& now, structure::Forces& out) const override;
  /// Dashpots have no stiffness.
  void add_stiffness_bound(const structure::Configuration&, structure::StiffnessBound&) const override {}

 private:
  struct Dashpot {
    int i, j;
    double c;
  };
  std::string name_;
  std::vector<Dashpot> dashpots_;
};

}  // namespace valsalva::crimp
