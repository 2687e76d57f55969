// A tube through a box, cut open at both ends normal to its axis.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>

#include "fluid/flow.hpp"

namespace valsalva::test {

struct Tube {
  Vec3 axis = Vec3(0.35, 0.2, 1).normalized();
  double radius = 3, length = 12, h = 0.6, widening = 0, bulge = 0;
  fluid::Wall wall = fluid::Wall::interpolated;
  double tolerance = 1e-10, density = 1e-3, viscosity = 3.5e-3;
  bool flow_at_low = false;

  double along(const Vec3& x) const { return x.dot(axis); }
  double from_axis(const Vec3& x) const { return (x - along(x) * axis).norm(); }
  double profile(const Vec3& x) const { return std::max(0.0, 1 - std::pow(from_axis(x) / radius, 2)); }

  /// Openings: 0 low, 1 high.
  std::unique_ptr<fluid::Flow> flow(MPI_Comm comm = MPI_COMM_SELF) const {
    fluid::Grid grid;
    grid.h = h;
    for (int d = 0; d < 3; ++d) {
      const double extent =
          length * std::abs(axis[d]) + 2 * radius * std::sqrt(1 - axis[d] * axis[d]) + 2 * bulge;
      grid.cells[d] = static_cast<int>(std::ceil(extent / h)) + 4;
      grid.origin[d] = -0.5 * h * grid.cells[d] + 0.13 * h * (d + 1);
    }
    fluid::Boundaries boundaries;
    boundaries.side[2] = {fluid::Side::slip, fluid::Side::slip};
    fluid::FlowParameters parameters;
    parameters.density = density;
    parameters.viscosity = viscosity;
    parameters.wall = wall;
    parameters.krylov = fluid::KrylovSettings{.tolerance = tolerance};
    auto out = std::make_unique<fluid::Flow>(comm, grid, boundaries, parameters);
    out->solids().set_lumen([tube = *this](const Vec3& x) {
      const double s = tube.along(x);
      return tube.from_axis(x) - tube.radius - tube.widening * s - tube.bulge * std::exp(-s * s / 12);
    });
    for (const int side : {-1, 1}) {
      fluid::OpeningPlane plane{
          side < 0 ? "low" : "high", 0.5 * side * length * axis, side * axis, 2 * radius, {}};
      if (side < 0 && flow_at_low) plane.profile = [tube = *this](const Vec3& x) { return tube.profile(x); };
      out->add_opening(plane);
    }
    return out;
  }
};

}  // namespace valsalva::test
