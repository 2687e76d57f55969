// A layer at each open end in which entering blood is made to enter evenly: what comes out of a 0D model is
// plug flow, and nothing else in the equations says so. With a pressure prescribed on the side and no
// convection through it, a thin stream that enters faster than its neighbours keeps its speed at no cost of
// pressure, draws them in and grows without bound.
//
//   f = -rho sigma (u - W e_z),   W = Q / A of the face plane,   sigma = sigma_0 (1 - d/L) min(1, W_in / W_0)
//
// d: distance from the end, L: the layer's depth; W_in: mean entering velocity at the end (no force where
// blood leaves); W_0 = 20 mm/s. The force on w adds up to zero over each plane, so that no pressure is lost
// in it.
#pragma once

#include "fluid/flow.hpp"

namespace valsalva::coupling {

struct SpongeParameters {
  double rate_per_s = 1000;  ///< sigma_0, < 1/dt
  double depth_mm = 5;       ///< L
};

class EndSponge {
 public:
  EndSponge(const fluid::Flow& flow, const SpongeParameters& parameters);
  /// Adds the force density of the layers at both open ends (collective).
  void add_force(const fluid::Flow& flow, fluid::FaceField& force) const;

 private:
  struct Plane {
    int plane, cells;  // of faces w, and of the cells inside of it, in the whole grid
    double share;      // 1 - d/L
    double area;       // open faces w, mm2
  };
  void add_layer(const fluid::Flow& flow, const std::vector<Plane>& layer, double entering,
                 fluid::FaceField& force) const;

  SpongeParameters parameters_;
  std::vector<Plane> low_, high_;
};

}  // namespace valsalva::coupling
