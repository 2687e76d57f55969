#include "coupling/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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
  nodes_ = x.size();
  planes_ = {std::numeric_limits<int>::max(), std::numeric_limits<int>::min()};
  stencils_.clear();
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
    }
    Stencil& stencil = stencils_.emplace_back();
    stencil.node = a;
    const auto take = [&](int d) {
      if (lone(d)) {  // all samples are the same one
        stencil.face[d] = stencil.centre[d] = {.start = 0, .value = {1, 0, 0, 0}};
        return true;
      }
      stencil.face[d] = weights(kernel_.along, cell[d]);
      stencil.centre[d] = weights(kernel_.across, cell[d] - 0.5);
      return !wraps(d, stencil.face[d]) && !wraps(d, stencil.centre[d]);
    };
    stencil.within = take(2);
    const int low = std::min(stencil.face[2].start, stencil.centre[2].start) - slab_.first;
    const int high = std::max(stencil.face[2].start, stencil.centre[2].start) + 4 - slab_.first;
    if (!stencil.within) {
      planes_ = {};
    } else {
      planes_ = {std::min(planes_.from, low), std::max(planes_.to, high)};
      if (high <= 0 || low >= slab_.w_planes()) {
        stencils_.pop_back();
        continue;
      }
    }
    for (int d = 0; d < 2; ++d) stencil.within = take(d) && stencil.within;
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

template <class Value, class Row>
void Transfer::each_row(const Stencil& stencil, int component, Value* field, Row&& row) const {
  const Weights& y = stencil.along(1, component);
  const Weights& z = stencil.along(2, component);
  const int used_y = used(1, component), used_z = used(2, component);
  const int planes = component == 2 ? slab_.w_planes() : slab_.planes, below = slab_.first - z.start;
  const int from = std::max(0, below), to = std::min(used_z, below + planes);
  Value* plane =
      field + y.start * slab_.stride_y + (from - below) * slab_.stride_z + stencil.along(0, component).start;
  for (int c = from; c < to; ++c, plane += slab_.stride_z) {
    Value* at = plane;
    for (int b = 0; b < used_y; ++b, at += slab_.stride_y) row(at, z.value[c] * y.value[b]);
  }
}

template <class Row>
void Transfer::each_image(const Stencil& stencil, int component, Row&& row) const {
  const Weights& y = stencil.along(1, component);
  const Weights& z = stencil.along(2, component);
  const int planes = component == 2 ? slab_.w_planes() : slab_.planes;
  const int used_y = used(1, component), used_z = used(2, component);
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

bool Transfer::wraps(int d, const Weights& w) const {
  const int n = slab_.grid.cells[d];
  if (periodic_[d]) return w.start < 0 || w.start + 4 > n;
  return (beyond_[d][0] != Beyond::nothing && w.start <= 0) ||
         (beyond_[d][1] != Beyond::nothing && w.start + 4 > n);
}

void Transfer::spread(const Points& force, fluid::FaceField& density) const {
  VALSALVA_ASSERT(force.size() >= nodes_);
  const double per_volume = 1 / (slab_.grid.h * slab_.grid.h * slab_.grid.h);
  for (int d = 0; d < 3; ++d) {
    fluid::Field& field = density[d];
    double* origin = field.row(0, 0);
    for (const Stencil& stencil : stencils_) {
      const double f = force[stencil.node][d];
      if (f == 0) continue;
      const Weights& x = stencil.along(0, d);
      const Quad along = per_volume * f * Eigen::Map<const Quad>(x.value.data());
      if (stencil.within) {
        each_row(stencil, d, origin,
                 [&](double* at, double across) { Eigen::Map<Quad>(at) += across * along; });
      } else {
        each_image(stencil, d, [&](int j, int k, double across) {
          for (int i = 0; i < 4; ++i) {
            const Image at = image(x.start + i, 0, d == 0);
            if (at.sign != 0) field(at.index, j, k) += at.sign * across * along[i];
          }
        });
      }
    }
  }
}

void Transfer::interpolate(const fluid::FaceField& velocity, Points& out) const {
  out.assign(nodes_, Vec3::Zero());
  for (int d = 0; d < 3; ++d) {
    const fluid::Field& field = velocity[d];
    const double* origin = field.row(0, 0);
    for (const Stencil& stencil : stencils_) {
      const Weights& x = stencil.along(0, d);
      Quad sum = Quad::Zero();
      if (stencil.within) {
        each_row(stencil, d, origin,
                 [&](const double* at, double across) { sum += across * Eigen::Map<const Quad>(at); });
      } else {
        each_image(stencil, d, [&](int j, int k, double across) {
          for (int i = 0; i < 4; ++i) {
            const Image at = image(x.start + i, 0, d == 0);
            if (at.sign != 0) sum[i] += at.sign * across * field(at.index, j, k);
          }
        });
      }
      const Quad part = sum * Eigen::Map<const Quad>(x.value.data());
      out[stencil.node][d] = (part[0] + part[1]) + (part[2] + part[3]);
    }
  }
  if (slab_.ranks > 1 && !out.empty()) mpi::sum_in_place(slab_.comm, out[0].data(), 3 * out.size());
}

}  // namespace valsalva::coupling
