#include "fluid/viscosity.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::fluid {

ExtraViscosity::ExtraViscosity(const Slab& slab, const Boundaries& boundaries,
                               const ExtraViscosityParameters& parameters, double constant, double density)
    : slab_(slab),
      boundaries_(boundaries),
      parameters_(parameters),
      constant_(constant),
      density_(density),
      nu_(slab) {
  if (parameters.carreau_yasuda && parameters.carreau_yasuda->zero_shear < constant) {
    throw InputError(
        "fluid: the viscosity at zero shear, {} Pa s, is below that at high shear, {} Pa s; expected a fluid "
        "that thins with shear",
        parameters.carreau_yasuda->zero_shear, constant);
  }
}

void ExtraViscosity::update(const FaceField& velocity) {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  const double per_h = 1 / slab_.grid.h;
  const auto& law = parameters_.carreau_yasuda;
  largest_ = 0;
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < ny; ++j) {
      double* nu = nu_.row(j, k);
      std::fill_n(nu, nx, 0.0);
      for (int i = 0; i < nx; ++i) {
        double a[3][3];     // a[e][d] = h d u_d / d x_e, means over edges
        double shear2 = 0;  // (h gamma)^2
        const double* u[3] = {velocity[0].row(j, k) + i, velocity[1].row(j, k) + i,
                              velocity[2].row(j, k) + i};
        for (int d = 0; d < 3; ++d) {
          a[d][d] = u[d][stride[d]] - u[d][0];
          shear2 += 2 * a[d][d] * a[d][d];
          for (int e = d + 1; e < 3; ++e) {
            const std::ptrdiff_t sd = stride[d], se = stride[e];
            double ed = 0, de = 0;
            for (const std::ptrdiff_t at : {std::ptrdiff_t{0}, sd, se, sd + se}) {
              const double across = u[d][at] - u[d][at - se], along = u[e][at] - u[e][at - sd];
              ed += 0.25 * across;
              de += 0.25 * along;
              shear2 += 0.25 * (across + along) * (across + along);
            }
            a[e][d] = ed;
            a[d][e] = de;
          }
        }
        if (law) {
          const double gamma = per_h * std::sqrt(shear2);
          nu[i] += (law->zero_shear - constant_) / density_ *
                   std::pow(1 + std::pow(law->time_s * gamma, law->transition),
                            (law->exponent - 1) / law->transition);
        }
        if (parameters_.vreman > 0) {
          double beta[3][3], size = 0;
          for (int p = 0; p < 3; ++p) {
            for (int q = 0; q < 3; ++q) {
              beta[p][q] = a[0][p] * a[0][q] + a[1][p] * a[1][q] + a[2][p] * a[2][q];
              size += a[p][q] * a[p][q];
            }
          }
          const double minors = beta[0][0] * beta[1][1] - beta[0][1] * beta[0][1] + beta[0][0] * beta[2][2] -
                                beta[0][2] * beta[0][2] + beta[1][1] * beta[2][2] - beta[1][2] * beta[1][2];
          // With differences over h instead of derivatives: h times sqrt(B / alpha:alpha). Differences of
          // round-off are no eddies.
          if (minors > 1e-14 * size * size)
            nu[i] += parameters_.vreman * slab_.grid.h * std::sqrt(minors / size);
        }
        largest_ = std::max(largest_, nu[i]);
      }
    }
  }
  largest_ = mpi::max(slab_.comm, largest_);
  fill_ghosts();
}

void ExtraViscosity::fill_ghosts() {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < ny; ++j) {
      double* row = nu_.row(j, k);
      row[-1] = row[boundaries_.periodic(0) ? nx - 1 : 0];
      row[nx] = row[boundaries_.periodic(0) ? 0 : nx - 1];
    }
    std::copy_n(nu_.row(boundaries_.periodic(1) ? ny - 1 : 0, k) - 1, nx + 2, nu_.row(-1, k) - 1);
    std::copy_n(nu_.row(boundaries_.periodic(1) ? 0 : ny - 1, k) - 1, nx + 2, nu_.row(ny, k) - 1);
  }
  exchange_planes(slab_, nu_, 1);
  if (slab_.periodic_z) return;
  for (int side = 0; side < 2; ++side) {
    if (side == 0 ? !slab_.is_lowest() : !slab_.is_highest()) continue;
    const int inner = side == 0 ? 0 : slab_.planes - 1, ghost = side == 0 ? -1 : slab_.planes;
    for (int j = -1; j <= ny; ++j) std::copy_n(nu_.row(j, inner) - 1, nx + 2, nu_.row(j, ghost) - 1);
  }
}

void ExtraViscosity::add(const FaceField& velocity, double weight, FaceField& rate, FaceField& next) const {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  const double per_h2 = 1 / (slab_.grid.h * slab_.grid.h);
  const bool low_end = !slab_.periodic_z && slab_.is_lowest();
  for (int d = 0; d < 3; ++d) {
    const std::ptrdiff_t sd = stride[d];
    const int from_i = d == 0 && !boundaries_.periodic(0) ? 1 : 0;
    const int from_j = d == 1 && !boundaries_.periodic(1) ? 1 : 0;
    const int from_k = d == 2 && low_end ? 1 : 0;  // the highest face w(nz) lies beyond the planes
    for (int k = from_k; k < slab_.planes; ++k) {
      for (int j = from_j; j < ny; ++j) {
        const double* q = velocity[d].row(j, k);
        const double* nu = nu_.row(j, k);
        double* __restrict n = rate[d].row(j, k);
        double* __restrict out = next[d].row(j, k);
        const std::array<const double*, 3> u{velocity[0].row(j, k), velocity[1].row(j, k),
                                             velocity[2].row(j, k)};
#pragma omp simd
        for (int i = from_i; i < nx; ++i) {
          double sum = 2 * (nu[i] * (q[i + sd] - q[i]) - nu[i - sd] * (q[i] - q[i - sd]));
          for (int e = 0; e < 3; ++e) {
            if (e == d) continue;
            const std::ptrdiff_t s = stride[e];
            const double* c = u[e] + i;
            const double* at = nu + i;
            const double below = 0.25 * (at[0] + at[-sd] + at[-s] + at[-sd - s]);
            const double above = 0.25 * (at[0] + at[-sd] + at[s] + at[s - sd]);
            sum += above * (q[i + s] - q[i] + c[s] - c[s - sd]) - below * (q[i] - q[i - s] + c[0] - c[-sd]);
          }
          n[i] += per_h2 * sum;
          out[i] += weight * per_h2 * sum;
        }
      }
    }
  }
}

}  // namespace valsalva::fluid
