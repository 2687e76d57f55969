// The stress-free shape of bodies whose given shape is the loaded one (an image under pressure): backward
// displacement.
//
//   X_0 = x*,   X_{k+1} = X_k - r (x(X_k) - x*),
// x* the given shape, x(X) the equilibrium from the stress-free shape X: at the end of a run of the static
// solvers; of the dynamic ones at their start, under the loads of time 0, from where they go on. It is a
// fixed point with contraction where displacements are small against the body's size; r starts at 1, is
// halved when the error grows, and the step is taken back. Sources: Sellier 2011 (An iterative method for the
// inverse elasto-static problem, J. Fluids Struct. 27:1461); Bols et al. 2013, J. Comput. Appl. Math. 246:10.
#pragma once

#include "assembly/scene.hpp"

namespace valsalva::assembly {

struct Prestress {
  References reference;  ///< stress-free shapes of the deformable bodies
  int iterations = 0;    ///< equilibria that were computed
  double error_mm = 0;   ///< largest distance of a node from its place in the given shape
  /// Dynamic solvers: the loaded shape, for March::start_from; else empty.
  structure::Snapshot equilibrium;
  double stored_nJ = 0;
};

/// Does the scene ask for it? InputError where bodies move freely, so that there is no equilibrium.
bool wants_prestress(const Case& scene);

/// Is the equilibrium that of the end of the run (static solvers), not of its start?
bool loaded_at_the_end(const Case& scene);

/// NumericalFailure when the tolerance is not reached. `say` is told the error of every iteration.
Prestress find_stress_free(const Case& scene, const std::function<void(int, double)>& say);

/// Largest distance of a node of a deformable body from its place in the given shape.
double distance_from_given(const Scene& scene);

}  // namespace valsalva::assembly
