// Force and moment of the fluid on a body from the tractions along its wall:
//
//   F = sum over the wall of (-p n + tau) dA,     M = sum (x - x0) x (-p n + tau) dA
//
// n points into the fluid, tau is Flow::wall_shear_stress. The pressure is continued to the wall linearly
// from 1.25 and 2.5 h along n: cells that the wall cuts hold a pressure that serves their mass balance, not
// the wall. The wall is that of a signed distance d < 0 in the body; the sum over it is one over points of
// half the grid's spacing within a band of one cell, each moved along the gradient of d to the wall, with the
// weight
//   (1 + cos(pi d / h)) / (2 h) |grad d| dV,
// whose error is of second order (a sphere of radius R: 0.13 (h/R)^2 of the area too much).
//
// For interpolated walls (solids.hpp), where the momentum that held faces take out of the fluid is not the
// body's alone: flow that is carried on through the wall takes its part. With staircases, Solids::force_on.
#pragma once

#include "fluid/flow.hpp"

namespace valsalva::fluid {

class WallForce {
 public:
  /// Finds the wall within the box. body: negative in the solid.
  WallForce(const Grid& grid, const Distance& body);

  struct Sum {
    Vec3 force = Vec3::Zero();    ///< micronewton
    Vec3 moment = Vec3::Zero();   ///< micronewton mm, about x0
    Vec3 viscous = Vec3::Zero();  ///< the part of the force by shear
  };
  /// Collective.
  Sum of(Flow& flow, const Vec3& x0) const;
  double area() const;  ///< mm2
  std::size_t points() const { return points_.size(); }

 private:
  struct Point {
    Vec3 x, normal;
    double area;
  };
  double h_;
  std::vector<Point> points_;
};

}  // namespace valsalva::fluid
