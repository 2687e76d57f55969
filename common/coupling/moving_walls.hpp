// What walls of the box that move along themselves add to the interpolated velocity of bodies that reach up
// to them: beyond a wall with the velocity U the velocity goes on as its image 2 U - u (along the wall),
//
//   (J u)_a,d = what Transfer gives + sum over samples beyond moving walls of +-W 2 U_d
//
// with the signs of the further images where a sample lies beyond other sides too (transfer.hpp).
#pragma once

#include "coupling/transfer.hpp"

namespace valsalva::coupling {

class MovingWalls {
 public:
  using Velocities = std::array<std::array<Vec3, 2>, 3>;  ///< of the low and the high side in x, y and z

  MovingWalls(const fluid::Grid& grid, Kernel kernel, const std::array<bool, 3>& periodic,
              Surroundings beyond);
  /// out: J velocity at the points x, to which the walls' part is added; the same on all ranks.
  void add(const Points& x, const Velocities& walls, Points& out) const;

 private:
  /// Sum of the weights along d with the signs of images: of the component along d, or of one across.
  double signed_sum(const Weights& w, int d, bool normal) const;

  fluid::Grid grid_;
  Kernel kernel_;
  Surroundings beyond_;  // nothing along periodic directions
};

}  // namespace valsalva::coupling
