#include "fluid/grid.hpp"

#include <algorithm>

#include "core/errors.hpp"

namespace valsalva::fluid {

Slab::Slab(MPI_Comm communicator, const Grid& whole, bool periodic)
    : comm(communicator),
      rank(mpi::rank(communicator)),
      ranks(mpi::size(communicator)),
      grid(whole),
      periodic_z(periodic) {
  for (int d = 0; d < 3; ++d) {
    if (grid.cells[d] < 1) {
      throw InputError("fluid grid: {} cells along {}; at least one is needed", grid.cells[d], "xyz"[d]);
    }
  }
  if (!(grid.h > 0)) throw InputError("fluid grid: cell size {} mm; it must be positive", grid.h);
  if (ranks > 1 && grid.cells[2] / ranks < ghosts) {
    throw InputError(
        "fluid grid: {} planes of cells on {} ranks; each rank needs at least {}: use at most {} ranks",
        grid.cells[2], ranks, ghosts, std::max(1, grid.cells[2] / ghosts));
  }
  first = first_of(rank);
  planes = first_of(rank + 1) - first;
  constexpr std::ptrdiff_t lanes = 8;  // rows begin at the same place of a cache line
  stride_y = (grid.cells[0] + 2 * ghosts + lanes - 1) / lanes * lanes;
  stride_z = stride_y * (grid.cells[1] + 2 * ghosts);
}

int Slab::first_of(int of_rank) const {
  return static_cast<int>(static_cast<long>(grid.cells[2]) * of_rank / ranks);
}

Field::Field(const Slab& slab)
    : stride_y_(slab.stride_y), stride_z_(slab.stride_z), data_(slab.size(), 0.0) {}

}  // namespace valsalva::fluid
