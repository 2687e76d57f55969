#include "coupling/transfer.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/mpi.hpp"

namespace valsalva::coupling {

namespace {

using Quad = Eigen::Array<double, 4, 1>;

constexpr double margin_cells = 2;

int wrapped(int i, int n) {
  return (i % n + n) % n;
}

}  // namespace

Transfer::Transfer(const fluid::Slab& slab, Kernel kernel, std::array<bool, 3> periodic,
                   const Surroundings& beyond)
    : slab_(slab), kernel_(kernel), periodic_(periodic), beyond_(beyond) {
  VALSALVA_ASSERT(periodic_[2] == slab.periodic_z);
}

void Transfer::locate(const Points& x) {
  const fluid::Grid& grid = slab_.grid;
  const double per_mm = 1 / grid.h;
  constexpr double round_off = 1e-9;
  Vec3 lowest, highest;
  for (int d = 0; d < 3; ++d) {
    lowest[d] = beyond_[d][0] == Beyond::nothing ? margin_cells : -round_off;
    highest[d] = grid.cells[d] - (beyond_[d][1] == Beyond::nothing ? margin_cells : -round_off);
  }
  stencils_.resize(x.size());
  for (std::size_t a = 0; a < x.size(); ++a) {
    Vec3 cell = per_mm * (x[a] - grid.origin);
    for (int d = 0; d < 3; ++d) {
      if (periodic_[d] && std::isfinite(cell[d])) {
        cell[d] -= grid.cells[d] * std::floor(cell[d] / grid.cells[d]);
      } else if (!(cell[d] >= lowest[d] && cell[d] <= highest[d]))
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

Transfer::Image Transfer::image(int i, int d, bool normal) const {
  const int n = slab_.grid.cells[d];
  if (periodic_[d]) return {wrapped(i, n), 1};
  const bool below = normal ? i <= 0 : i < 0, above = i >= n;
  if (!below && !above) return {i, 1};
  const Beyond kind = beyond_[d][above ? 1 : 0];
  if (kind == Beyond::nothing) return {i, 1};
  if (normal && (i == 0 || i == n)) return {i, 0};
  const int mirrored = (below ? 0 : 2 * n) - i - (normal ? 0 : 1);
  return {mirrored, normal == (kind == Beyond::wall) ? 1.0 : -1.0};
}

// Calls row(face index j, local k, weight across) for every owned row of faces in the stencil.
template <class Row>
void Transfer::visit(const Stencil& stencil, int component, Row&& row) const {
  const Weights& y = component == 1 ? stencil.face[1] : stencil.centre[1];
  const Weights& z = component == 2 ? stencil.face[2] : stencil.centre[2];
  const int planes = component == 2 ? slab_.w_planes() : slab_.planes;
  const int used_y = support(component == 1 ? kernel_.along : kernel_.across);
  const int used_z = support(component == 2 ? kernel_.along : kernel_.across);
  for (int c = 0; c < used_z; ++c) {
    const Image plane = image(z.start + c, 2, component == 2);
    const int k = plane.index - slab_.first;
    if (plane.sign == 0 || k < 0 || k >= planes) continue;
    for (int b = 0; b < used_y; ++b) {
      const Image j = image(y.start + b, 1, component == 1);
      if (j.sign != 0) row(j.index, k, plane.sign * j.sign * z.value[c] * y.value[b]);
    }
  }
}

// Does the stencil reach beyond the box along x, or to its sides?
bool Transfer::wraps(const Weights& x) const {
  const int n = slab_.grid.cells[0];
  if (periodic_[0]) return x.start < 0 || x.start + 4 > n;
  return (beyond_[0][0] != Beyond::nothing && x.start <= 0) ||
         (beyond_[0][1] != Beyond::nothing && x.start + 4 > n);
}

void Transfer::spread(const Points& force, fluid::FaceField& density) const {
  VALSALVA_ASSERT(force.size() >= stencils_.size());
  const double per_volume = 1 / (slab_.grid.h * slab_.grid.h * slab_.grid.h);
  for (int d = 0; d < 3; ++d) {
    fluid::Field& field = density[d];
    for (std::size_t a = 0; a < stencils_.size(); ++a) {
      if (force[a][d] == 0) continue;
      const Weights& x = d == 0 ? stencils_[a].face[0] : stencils_[a].centre[0];
      const Quad along = per_volume * force[a][d] * Eigen::Map<const Quad>(x.value.data());
      if (wraps(x)) {
        visit(stencils_[a], d, [&](int j, int k, double across) {
          for (int i = 0; i < 4; ++i) {
            const Image at = image(x.start + i, 0, d == 0);
            if (at.sign != 0) field(at.index, j, k) += at.sign * across * along[i];
          }
        });
      } else {
        visit(stencils_[a], d, [&](int j, int k, double across) {
          Eigen::Map<Quad>(field.row(j, k) + x.start) += across * along;
        });
      }
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
      if (wraps(x)) {
        visit(stencils_[a], d, [&](int j, int k, double across) {
          for (int i = 0; i < 4; ++i) {
            const Image at = image(x.start + i, 0, d == 0);
            if (at.sign != 0) sum[i] += at.sign * across * field(at.index, j, k);
          }
        });
      } else {
        visit(stencils_[a], d, [&](int j, int k, double across) {
          sum += across * Eigen::Map<const Quad>(field.row(j, k) + x.start);
        });
      }
      const Quad part = sum * Eigen::Map<const Quad>(x.value.data());
      out[a][d] = (part[0] + part[1]) + (part[2] + part[3]);
    }
  }
  if (slab_.ranks > 1 && !out.empty()) mpi::sum_in_place(slab_.comm, out[0].data(), 3 * out.size());
}

}  // namespace valsalva::coupling
