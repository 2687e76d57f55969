// First-order upwinding beside walls, on top of the convection scheme.
//
//   the flux of q through a side between two faces gets   F_x = |a| / 2 (q-1 - q0)   more,
//   where one of the two stands beside a wall: the lumen's, a body's, or a side of the box that is one
//
// a as in momentum.hpp. It acts along the flow alone: a flow that does not change along its own direction
// does not feel it, and where it does the error is of first order in a layer of one cell, so that the whole
// stays of second order. Without it coarse grids carry on motions beside walls that viscosity should end:
// from a velocity times cell size over viscosity of about 80 on (docs/verification/fda-nozzle.md).
//
// Stable up to a CFL number of 0.5 there (AB2). Faces with a prescribed velocity do not feel it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fluid/boundary.hpp"
#include "fluid/grid.hpp"
#include "fluid/solids.hpp"

namespace valsalva::fluid {

class WallUpwind {
 public:
  WallUpwind(const Slab& slab, const Boundaries& boundaries) : slab_(slab), boundaries_(boundaries) {}

  /// Lists the faces anew where the solids have changed (collective).
  void update(const Solids& solids);
  /// rate -= div F_x, next -= weight div F_x. velocity: with valid ghosts.
  void add(const FaceField& velocity, double weight, FaceField& rate, FaceField& next) const;
  std::size_t faces() const { return faces_[0].size() + faces_[1].size() + faces_[2].size(); }

 private:
  enum class Kind : std::uint8_t { fluid, solid, prescribed, beyond, beyond_wall };
  struct Face {
    std::ptrdiff_t at;
    std::uint8_t sides;  ///< bit 2 e: through the low side along e; 2 e + 1: through the high one
  };
  Kind kind(const Field& solid, int d, std::array<int, 3> face) const;
  bool beside_wall(const Field& solid, int d, const std::array<int, 3>& face) const;

  const Slab& slab_;
  const Boundaries& boundaries_;
  long version_ = -1;
  std::array<std::vector<Face>, 3> faces_;
};

}  // namespace valsalva::fluid
