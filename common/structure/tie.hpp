// Sewing: a tissue node follows a point that is fixed to a frame node and turns with it.
//
//   d = x_t - x_f - R_f o,   E = k/2 |d|^2,   force -k d on the tissue, +k d on the frame, moment (R_f o) x k
//   d.
// Linear and angular momentum are conserved. Without a rotation at the frame node, R_f = 1.
// Lengths mm, k uN/mm, energy nJ.
#pragma once

#include <vector>

#include "structure/force_term.hpp"

namespace valsalva::structure {

struct Tie {
  int tissue = 0;              ///< global node
  int frame = 0;               ///< global node
  Vec3 offset = Vec3::Zero();  ///< in the frame node's reference directions
  double stiffness_uN_per_mm = 0;
};

class TieTerm : public ForceTerm {
 public:
  /// InputError when a tie refers to a node that does not exist or its stiffness is not positive.
  TieTerm(std::string name, std::vector<Tie> ties, const System& system);
  std::string name() const override { return name_; }
  double add_forces(const Configuration& now, Forces& out) const override;
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override;
  /// Exact.
  void add_tangent(const Configuration& now, BlockMatrix& out) const override;
  /// The largest |d|, mm.
  double max_gap(const Configuration& now) const;
  const std::vector<Tie>& ties() const { return ties_; }

 private:
  Vec3 arm(const Configuration& now, std::size_t i) const;
  std::string name_;
  std::vector<Tie> ties_;
  std::vector<int> rotation_;  // of the frame node, or -1
};

/// Ties between the nodes as they lie in their reference shapes: offset = X_t - X_f.
std::vector<Tie> ties_in_reference(const Points& tissue_reference, const Points& frame_reference,
                                   const std::vector<Edge>& tissue_and_frame, const Body& tissue,
                                   const Body& frame, double stiffness_uN_per_mm);

}  // namespace valsalva::structure
