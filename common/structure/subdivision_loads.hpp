// Loads on a subdivision shell, consistent with its surface: virtual work of forces on points of the surface.
//
// Dead loads are added to nodal forces for a DeadLoadTerm (structure/dead_load.hpp), out[offset + a] on node
// a of the body. Follower pressure p: f_a = p integral N_a x,1 x x,2, along the normal for p > 0. An edge
// moment m (uN, per reference length) turns about the present edge, which runs with the surface on its left:
// f_a = -m integral N_a,c ((tau x n) . a^c) n dL, with d(phi) = dn . (tau x n) the rotation that works with
// it; m > 0 lifts the side of the surface towards the normal. Pa, uN, uN/mm, mm.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "structure/subdivision_shell.hpp"

namespace valsalva::structure {

/// A force on the point of the surface at a node.
void add_point_force(const SubdivisionSurface& surface, int node, const Vec3& force_uN, Points& out,
                     int offset = 0);
/// A traction on the reference area, of the reference place.
void add_area_load(const SubdivisionShell& shell, const std::function<Vec3(const Vec3&)>& traction_Pa,
                   Points& out, int offset = 0);
/// A force per reference length on border edges (ascending nodes). InputError for an edge that is none.
void add_edge_load(const SubdivisionSurface& surface, std::span<const Edge> edges,
                   const std::function<Vec3(const Vec3&)>& force_uN_per_mm, Points& out, int offset = 0);

class SubdivisionPressureTerm : public ForceTerm {
 public:
  /// pressure_Pa: of the time in s.
  SubdivisionPressureTerm(std::string name, std::shared_ptr<const SubdivisionShell> shell, const Body& body,
                          std::function<double(double)> pressure_Pa);
  std::string name() const override { return name_; }
  double add_forces(const Configuration& now, Forces& out) const override;
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override;
  /// Exact; not symmetric at the rim.
  void add_tangent(const Configuration& now, BlockMatrix& out) const override;

 private:
  std::string name_;
  std::shared_ptr<const SubdivisionShell> shell_;
  Body body_;
  std::function<double(double)> pressure_;
};

class SubdivisionEdgeMomentTerm : public ForceTerm {
 public:
  /// moment: uN mm per mm of the edges, of the time in s.
  SubdivisionEdgeMomentTerm(std::string name, std::shared_ptr<const SubdivisionShell> shell, const Body& body,
                            std::span<const Edge> edges, std::function<double(double)> moment_uN);
  std::string name() const override { return name_; }
  double add_forces(const Configuration& now, Forces& out) const override;
  void add_stiffness_bound(const Configuration& now, StiffnessBound& out) const override;
  /// By central differences of the forces (1e-6 of the edge).
  void add_tangent(const Configuration& now, BlockMatrix& out) const override;

 private:
  struct Point {
    std::vector<int> vertices;
    BasisTable basis;
    Eigen::Vector2d along;  // the edge's direction in the parameters
    double length;          // its share of the reference length
  };
  void forces_at(const Points& x, const Point& p, double moment, Points& f) const;

  std::string name_;
  std::shared_ptr<const SubdivisionShell> shell_;
  Body body_;
  std::function<double(double)> moment_;
  std::vector<Point> points_;
};

}  // namespace valsalva::structure
