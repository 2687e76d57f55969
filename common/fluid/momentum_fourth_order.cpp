#include <array>

#include "fluid/fourth_order.hpp"
#include "fluid/momentum.hpp"

namespace valsalva::fluid {

namespace {

// Fluxes of q, which lies at 0, along e through the sides at 1/2 (near) and 3/2 (far) above it, and the same
// below when q and a are shifted by one and three cells; a stands on the face of component e on that side.
struct Interpolated {
  static double near(const double* q, std::ptrdiff_t e, const double* a, std::ptrdiff_t d) {
    return fourth_order::interpolate_sixth(a, d) * fourth_order::interpolate_sixth(q + e, e);
  }
  static double far(const double* q, std::ptrdiff_t e, const double* a, std::ptrdiff_t d) {
    return fourth_order::interpolate(a, d) * fourth_order::interpolate(q + 2 * e, e);
  }
};

struct Conserving {
  static double near(const double* q, std::ptrdiff_t e, const double* a, std::ptrdiff_t d) {
    return fourth_order::interpolate(a, d) * 0.5 * (q[0] + q[e]);
  }
  static double far(const double* q, std::ptrdiff_t e, const double* a, std::ptrdiff_t d) {
    return fourth_order::interpolate(a, d) * 0.5 * (q[0] + q[3 * e]);
  }
};

}  // namespace

template <class Flux>
void Momentum::advance_fourth_order(const FaceField& velocity, const Advance& step, FaceField& rate,
                                    FaceField& next) const {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  const double per_h = 1 / slab_.grid.h, diffusion = nu_ * per_h * per_h;
  const double near = per_h * 9 / 8, far = per_h / 24;
  const double new_weight = step.dt * step.weight_new, old_weight = step.dt * step.weight_old;
  const double dt_rho = step.dt / step.density;
  for (int d = 0; d < 3; ++d) {
    const std::ptrdiff_t sd = stride[d];
    for (int k = 0; k < slab_.planes; ++k) {
      for (int j = 0; j < ny; ++j) {
        const double* q = velocity[d].row(j, k);
        const std::array<const double*, 3> a{velocity[0].row(j, k), velocity[1].row(j, k),
                                             velocity[2].row(j, k)};
        const double* p = step.pressure ? step.pressure->row(j, k) : nullptr;
        const double* f = step.force ? (*step.force)[d].row(j, k) : nullptr;
        double* __restrict n = rate[d].row(j, k);
        double* __restrict out = next[d].row(j, k);
#pragma omp simd
        for (int i = 0; i < nx; ++i) {
          double now = 0;
          for (int e = 0; e < 3; ++e) {
            const std::ptrdiff_t s = stride[e];
            const double* c = a[e] + i;
            const double* at = q + i;
            now -= near * (Flux::near(at, s, c + s, sd) - Flux::near(at - s, s, c, sd));
            now += far * (Flux::far(at, s, c + 2 * s, sd) - Flux::far(at - 3 * s, s, c - s, sd));
            now += diffusion * fourth_order::second_difference(at, s);
          }
          out[i] = q[i] + (new_weight * now + old_weight * n[i]);
          n[i] = now;
        }
        if (p) {
#pragma omp simd
          for (int i = 0; i < nx; ++i) out[i] -= dt_rho * per_h * fourth_order::difference(p + i, sd);
        }
        if (f) {
#pragma omp simd
          for (int i = 0; i < nx; ++i) out[i] += dt_rho * f[i];
        }
      }
    }
  }
}

void Momentum::advance_fourth_order(const FaceField& velocity, const Advance& step, FaceField& rate,
                                    FaceField& next) const {
  if (convection_ == Convection::conserving4) {
    advance_fourth_order<Conserving>(velocity, step, rate, next);
  } else {
    advance_fourth_order<Interpolated>(velocity, step, rate, next);
  }
}

}  // namespace valsalva::fluid
