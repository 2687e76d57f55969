// A moment along border edges of a Kirchhoff-Love shell. (Follower pressure, dead loads and gravity on its
// nodes: structure/pressure.hpp and dead_load.hpp, as on every triangle mesh.)
//
// m (uN mm per mm of the reference edge) turns about the present edge, which runs with the surface on its
// left: virtual work m L d(phi), d(phi) = dd . n/|d|, d the edge vector (kirchhoff_edges.hpp), n the unit
// normal along d x edge: m > 0 turns the outer side towards the normal.
#pragma once

#include <functional>
#include <string>

#include "structure/kirchhoff_shell.hpp"

namespace valsalva::structure {

class EdgeMomentTerm : public ForceTerm {
 public:
  /// edges: ascending nodes. InputError for an edge that is not on the border.
  EdgeMomentTerm(std::string name, std::shared_ptr<const KirchhoffShell> shell, const Body& body,
                 std::span<const Edge> edges, std::function<double(double)> moment_uN);
  std::string name() const override { return name_; }
  double add_forces(const Configuration& now, Forces& out) const override;
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override;
  /// Exact.
  void add_tangent(const Configuration& now, BlockMatrix& out) const override;

 private:
  struct Loaded {
    std::array<int, 3> vertices;  // the two nodes, the edge vector
    double length;                // of the reference
  };
  std::string name_;
  std::shared_ptr<const KirchhoffShell> shell_;
  Body body_;
  std::function<double(double)> moment_;
  std::vector<Loaded> edges_;
};

}  // namespace valsalva::structure
