#include "coupling/transfer.hpp"

#include <algorithm>

#include "core/errors.hpp"
#include "core/mpi.hpp"

namespace valsalva::coupling {

namespace {

using Quad = Eigen::Array<double, 4, 1>;

constexpr double margin_cells = 2;

}  // namespace

Transfer::Transfer(const fluid::Slab& slab, Kernel kernel) : slab_(slab), kernel_(kernel) {}

void Transfer::locate(const Points& x) {
  const fluid::Grid& grid = slab_.grid;
  const double per_mm = 1 / grid.h;
  stencils_.resize(x.size());
  for (std::size_t a = 0; a < x.size(); ++a) {
    const Vec3 cell = per_mm * (x[a] - grid.origin);
    for (int d = 0; d < 3; ++d) {
      if (!(cell[d] >= margin_cells && cell[d] <= grid.cells[d] - margin_cells))
        throw NumericalFailure(
            "coupling: node {} is at ({:.4g}, {:.4g}, {:.4g}) mm, less than {} cells from a side of the "
            "fluid's "
            "box or outside it; the time step was too large or the box does not hold the body",
            a, x[a].x(), x[a].y(), x[a].z(), margin_cells);
      stencils_[a].face[d] = weights(kernel_.along, cell[d]);
      stencils_[a].centre[d] = weights(kernel_.across, cell[d] - 0.5);
    }
  }
}

// Calls row(first face index i, j, local k, weight across) for every owned row of faces in the stencil.
template <class Row>
void Transfer::visit(const Stencil& stencil, int component, Row&& row) const {
  const Weights& y = component == 1 ? stencil.face[1] : stencil.centre[1];
  const Weights& z = component == 2 ? stencil.face[2] : stencil.centre[2];
  const int planes = component == 2 ? slab_.w_planes() : slab_.planes;
  const int used_y = support(component == 1 ? kernel_.along : kernel_.across);
  const int used_z = support(component == 2 ? kernel_.along : kernel_.across);
  const int first = z.start - slab_.first;
  const int low = std::max(0, -first), high = std::min(used_z, planes - first);
  for (int c = low; c < high; ++c)
    for (int b = 0; b < used_y; ++b) row(y.start + b, first + c, z.value[c] * y.value[b]);
}

void Transfer::spread(const Points& force, fluid::FaceField& density) const {
  VALSALVA_ASSERT(force.size() == stencils_.size());
  const double per_volume = 1 / (slab_.grid.h * slab_.grid.h * slab_.grid.h);
  for (int d = 0; d < 3; ++d) {
    fluid::Field& field = density[d];
    for (std::size_t a = 0; a < force.size(); ++a) {
      if (force[a][d] == 0) continue;
      const Weights& x = d == 0 ? stencils_[a].face[0] : stencils_[a].centre[0];
      const Quad along = per_volume * force[a][d] * Eigen::Map<const Quad>(x.value.data());
      visit(stencils_[a], d, [&](int j, int k, double across) {
        Eigen::Map<Quad>(field.row(j, k) + x.start) += across * along;
      });
    }
  }
}

void Transfer::interpolate(const fluid::FaceField& velocity, Points& out) const {
  out.resize(stencils_.size());
  for (int d = 0; d < 3; ++d) {
    const fluid::Field& field = velocity[d];
    for (std::size_t a = 0; a < stencils_.size(); ++a) {
      const Weights& x = d == 0 ? stencils_[a].face[0] : stencils_[a].centre[0];
      Quad sum = Quad::Zero();
      visit(stencils_[a], d, [&](int j, int k, double across) {
        sum += across * Eigen::Map<const Quad>(field.row(j, k) + x.start);
      });
      const Quad part = sum * Eigen::Map<const Quad>(x.value.data());
      out[a][d] = (part[0] + part[1]) + (part[2] + part[3]);
    }
  }
  if (slab_.ranks > 1 && !out.empty()) mpi::sum_in_place(slab_.comm, out[0].data(), 3 * out.size());
}

}  // namespace valsalva::coupling
