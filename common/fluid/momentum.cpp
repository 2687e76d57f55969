#include "fluid/momentum.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::fluid {

Convection convection_from(const std::string& name) {
  if (name == "upwind3") return Convection::upwind3;
  if (name == "centred4") return Convection::centred4;
  if (name == "centred2") return Convection::centred2;
  if (name == "weno5") return Convection::weno5;
  if (name == "conserving4") return Convection::conserving4;
  throw InputError("convection '{}'; expected upwind3, centred4, centred2, weno5 or conserving4", name);
}

Momentum::Momentum(const Slab& slab, const Boundaries& boundaries, Convection scheme,
                   double kinematic_viscosity, int order)
    : slab_(slab), boundaries_(boundaries), convection_(scheme), nu_(kinematic_viscosity), order_(order) {
  if (order == 4 ? scheme != Convection::centred4 && scheme != Convection::conserving4
                 : scheme == Convection::conserving4)
    throw InputError(
        "fluid: convection and order do not go together; order 4 has centred4 and conserving4, order 2 "
        "upwind3, centred4, centred2 and weno5");
  switch (scheme) {
    case Convection::upwind3:
    case Convection::weno5:
      linear_ = {7.0 / 12, 1.0 / 12, 1.0 / 12};
      break;
    case Convection::centred4:
      linear_ = {7.0 / 12, 1.0 / 12, 0};
      break;
    case Convection::conserving4:
    case Convection::centred2:
      linear_ = {0.5, 0, 0};
      break;
  }
  const int nx = slab.grid.cells[0];
  for (auto& plane : flux_z_) plane.resize(slab.grid.plane_cells());
  flux_x_.resize(nx + 1);
  flux_y_.resize(nx);
}

namespace {

// So many streams at once are too many for the processor's own prefetching: without it 3 of 16 ms at 128^3.
template <int write>
void prefetch(const double* row, int count) {
  for (int i = 0; i < count; i += 8) __builtin_prefetch(row + i, write);
}

}  // namespace

template <class Flux>
void Momentum::start_plane_fluxes(const Flux& flux, const FaceField& velocity) {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  for (int d = 0; d < 3; ++d) {
    for (int j = 0; j < ny; ++j) {
      const double* q = velocity[d].row(j, 0);
      const double* w = velocity[2].row(j, 0);
      double* fz = flux_z_[d].data() + static_cast<std::size_t>(j) * nx;
      for (int i = 0; i < nx; ++i) fz[i] = flux(q + i, stride[2], w + i, stride[d]);
    }
  }
}

template <bool open_end, class Flux>
void Momentum::plane(const Flux& flux, int d, int k, const FaceField& velocity, const Advance& step,
                     FaceField& rate, FaceField& next) {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const std::ptrdiff_t sy = slab_.stride_y, sz = slab_.stride_z;
  const std::ptrdiff_t sd = d == 0 ? 1 : d == 1 ? sy : sz;
  const double per_h = 1 / slab_.grid.h, diffusion = nu_ * per_h * per_h;
  const double new_weight = step.dt * step.weight_new, old_weight = step.dt * step.weight_old;
  const double dt_rho = step.dt / step.density;
  const double gradient = step.pressure ? dt_rho * per_h : 0;
  double* __restrict fx = flux_x_.data();
  double* __restrict fy = flux_y_.data();

  const bool forced = step.force && step.forced.has(k);

  const double* v0 = velocity[1].row(0, k);
  for (int i = 0; i < nx; ++i) fy[i] = flux(velocity[d].row(0, k) + i, sy, v0 + i, sd);

  for (int j = 0; j < ny; ++j) {
    const double* q = velocity[d].row(j, k);
    const double* u = velocity[0].row(j, k);
    const double* v = velocity[1].row(j + 1, k);
    const double* w = velocity[2].row(j, k + 1);
    const double* p = step.pressure ? step.pressure->row(j, k) : q;  // gradient = 0 without one
    const double* f = forced ? (*step.force)[d].row(j, k) : nullptr;
    double* __restrict fz = flux_z_[d].data() + static_cast<std::size_t>(j) * nx;
    double* __restrict n = rate[d].row(j, k);
    double* __restrict out = next[d].row(j, k);
    [[maybe_unused]] const double outward = k == 0 ? -1 : 1;
    prefetch<0>(velocity[d].row(j + 1, k) + 2 * sz, nx);
    prefetch<1>(rate[d].row(j + 1, k), nx);
    prefetch<1>(next[d].row(j + 1, k), nx);
    if (step.pressure) prefetch<0>(step.pressure->row(j + 1, k), nx);
#pragma omp simd
    for (int i = 0; i <= nx; ++i) fx[i] = flux(q + i, 1, u + i, sd);
#pragma omp simd
    for (int i = 0; i < nx; ++i) {
      const double above_y = flux(q + i + sy, sy, v + i, sd);
      const double above_z = flux(q + i + sz, sz, w + i, sd);
      const double divergence = (fx[i + 1] - fx[i]) + (above_y - fy[i]) + (above_z - fz[i]);
      const double laplacian =
          (q[i + 1] + q[i - 1]) + (q[i + sy] + q[i - sy]) + (q[i + sz] + q[i - sz]) - 6 * q[i];
      double now = diffusion * laplacian - per_h * divergence;
      if constexpr (open_end) now = outward * q[i] < 0 ? outward * per_h * q[i] * q[i] : now;
      fy[i] = above_y;
      fz[i] = above_z;
      out[i] = q[i] + (new_weight * now + old_weight * n[i]) - gradient * (p[i] - p[i - sd]);
      n[i] = now;
    }
    if (f) {
#pragma omp simd
      for (int i = 0; i < nx; ++i) out[i] += dt_rho * f[i];
    }
  }
}

void Momentum::hold_sides(int k, FaceField& rate, FaceField& next) const {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  if (!boundaries_.periodic(0)) {
    for (int j = 0; j < ny; ++j) rate[0](0, j, k) = next[0](0, j, k) = 0;
  }
  if (!boundaries_.periodic(1)) {
    std::fill_n(rate[1].row(0, k), nx, 0.0);
    std::fill_n(next[1].row(0, k), nx, 0.0);
  }
}

void Momentum::advance(const FaceField& velocity, const Advance& step, FaceField& rate, FaceField& next) {
  if (order_ == 4) {
    advance_fourth_order(velocity, step, rate, next);
  } else if (convection_ == Convection::weno5) {
    advance_second_order(WenoFlux{}, velocity, step, rate, next);
  } else {
    advance_second_order(linear_, velocity, step, rate, next);
  }
}

template <class Flux>
void Momentum::advance_second_order(const Flux& flux, const FaceField& velocity, const Advance& step,
                                    FaceField& rate, FaceField& next) {
  start_plane_fluxes(flux, velocity);
  const auto is_open = [&](int k) {
    return !slab_.periodic_z && ((k == 0 && slab_.is_lowest() && boundaries_.end(End::low) == Side::open) ||
                                 (k == slab_.planes && boundaries_.end(End::high) == Side::open));
  };
  for (int k = 0; k < slab_.w_planes(); ++k) {
    if (k < slab_.planes) {
      plane<false>(flux, 0, k, velocity, step, rate, next);
      plane<false>(flux, 1, k, velocity, step, rate, next);
      hold_sides(k, rate, next);
    }
    if (is_open(k)) {
      plane<true>(linear_, 2, k, velocity, step, rate, next);
    } else {
      plane<false>(flux, 2, k, velocity, step, rate, next);
    }
  }
  // Prescribed faces of walls, slip sides and inflow keep their velocity.
  if (slab_.periodic_z) return;
  for (int side = 0; side < 2; ++side) {
    if (side == 0 ? !slab_.is_lowest() : !slab_.is_highest()) continue;
    if (boundaries_.side[2][side] == Side::open) continue;
    const int k = side == 0 ? 0 : slab_.planes;
    for (int j = 0; j < slab_.grid.cells[1]; ++j) {
      std::copy_n(velocity[2].row(j, k), slab_.grid.cells[0], next[2].row(j, k));
      std::fill_n(rate[2].row(j, k), slab_.grid.cells[0], 0.0);
    }
  }
}

}  // namespace valsalva::fluid
