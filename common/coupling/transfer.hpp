// Spreading of nodal forces to the staggered grid and interpolation of its velocity to the nodes.
//
//   (S F)(face of component d) = 1/h^3 sum_a F_a,d  W_d(x_a, face)      micronewton/mm3 from micronewton
//   (J u)_a,d                  =       sum_faces u(face) W_d(x_a, face)
//   W_d = product of phi in the three directions (kernel.hpp)
//
// S and J are adjoint: h^3 sum_faces (S F) u = sum_a F_a . (J u)_a, to round-off. Each rank spreads to the
// faces it owns and interpolates from them; the partial sums are added over ranks, in rank order.
//
// Along a periodic direction a node may be anywhere and acts on the images of the box alike. Beyond a slip
// side or a wall at rest the velocity can go on as its image, so that nodes may lie up to the side:
//   slip   tangential even, normal odd        wall   tangential odd, normal even (it grows with the square)
// both free of divergence where the velocity is; S stays adjoint to J. Elsewhere nodes have to stay two cells
// away from the sides of the box: NumericalFailure names the one that does not.
#pragma once

#include <array>
#include <vector>

#include "core/types.hpp"
#include "coupling/kernel.hpp"
#include "fluid/grid.hpp"
#include "fluid/pressure_solver.hpp"

namespace valsalva::coupling {

/// How the velocity goes on beyond a side that is not periodic.
enum class Beyond { nothing, slip, wall };
/// Of the low and the high side in x, y and z.
using Surroundings = std::array<std::array<Beyond, 2>, 3>;

class Transfer {
 public:
  /// periodic: in x, y and z, as the sides of the box are.
  Transfer(const fluid::Slab& slab, Kernel kernel, std::array<bool, 3> periodic = {},
           const Surroundings& beyond = {});

  /// Takes the nodes' positions: every spread and interpolation until the next call uses them.
  void locate(const Points& x);
  /// density += S force on the owned faces; of a longer list the first entries count.
  void spread(const Points& force, fluid::FaceField& density) const;
  /// out = J velocity, the same on all ranks (collective). Ghosts are not read.
  void interpolate(const fluid::FaceField& velocity, Points& out) const;
  std::size_t nodes() const { return nodes_; }
  /// Those that hold all faces which nodes act on, of all ranks (local numbers, here or not).
  fluid::Planes planes() const { return planes_; }

 private:
  struct Stencil {
    std::size_t node = 0;
    bool within = false;                  // the box, with every sample: no images
    std::array<Weights, 3> face, centre;  // in each direction, of samples at faces and at cell centres
    const Weights& along(int direction, int component) const {
      return direction == component ? face[direction] : centre[direction];
    }
  };
  /// Calls row(first face of the stencil along x, weight across) for every owned row of faces in a stencil
  /// within the box.
  template <class Value, class Row>
  void each_row(const Stencil& stencil, int component, Value* field, Row&& row) const;
  /// Calls row(face index j, local k, weight across) for every owned row of any stencil.
  template <class Row>
  void each_image(const Stencil& stencil, int component, Row&& row) const;
  /// Has the box a single cell along d, with periodic sides (a plane flow)?
  bool lone(int d) const { return periodic_[d] && slab_.grid.cells[d] == 1; }
  /// Samples along d that a component reads.
  int used(int d, int component) const {
    return lone(d) ? 1 : support(d == component ? kernel_.along : kernel_.across);
  }
  /// Does the stencil reach beyond the box along d, or to its sides?
  bool wraps(int d, const Weights& w) const;
  struct Image {
    int index = 0;
    double sign = 1;  // 0: on a wall, where nothing acts
  };
  /// The sample i of faces or centres along d as one of the box; normal: of the component along d.
  Image image(int i, int d, bool normal) const;

  const fluid::Slab& slab_;
  Kernel kernel_;
  std::array<bool, 3> periodic_;
  Surroundings beyond_;
  std::size_t nodes_ = 0;
  fluid::Planes planes_;
  std::vector<Stencil> stencils_;  // of the nodes that touch the rank's own faces
};

}  // namespace valsalva::coupling
