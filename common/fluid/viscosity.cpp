#include "fluid/viscosity.hpp"

#include <Eigen/Core>
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
  largest_ = 0;
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < ny; ++j) {
      const Rows u{velocity[0].row(j, k), velocity[1].row(j, k), velocity[2].row(j, k)};
      double* nu = nu_.row(j, k);
      std::fill_n(nu, nx, 0.0);
      if (parameters_.carreau_yasuda) add_thinning(*parameters_.carreau_yasuda, u, nu);
      if (parameters_.vreman > 0) add_eddies(u, nu);
      largest_ = std::max(largest_, Eigen::Map<const Eigen::ArrayXd>(nu, nx).maxCoeff());
    }
  }
  largest_ = mpi::max(slab_.comm, largest_);
  fill_ghosts();
}

void ExtraViscosity::add_thinning(const CarreauYasuda& law, const Rows& u, double* nu) const {
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  const double per_h = 1 / slab_.grid.h, range = (law.zero_shear - constant_) / density_;
  for (int i = 0; i < slab_.grid.cells[0]; ++i) {
    double shear2 = 0;  // (h gamma)^2
    for (int d = 0; d < 3; ++d) {
      const double *q = u[d] + i, along_d = q[stride[d]] - q[0];
      shear2 += 2 * along_d * along_d;
      for (int e = d + 1; e < 3; ++e) {
        const double* r = u[e] + i;
        const std::ptrdiff_t sd = stride[d], se = stride[e];
        for (const std::ptrdiff_t at : {std::ptrdiff_t{0}, sd, se, sd + se}) {
          const double sum = (q[at] - q[at - se]) + (r[at] - r[at - sd]);
          shear2 += 0.25 * sum * sum;
        }
      }
    }
    const double gamma = per_h * std::sqrt(shear2);
    nu[i] += range *
             std::pow(1 + std::pow(law.time_s * gamma, law.transition), (law.exponent - 1) / law.transition);
  }
}

void ExtraViscosity::add_eddies(const Rows& u, double* nu) const {
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  const double factor = parameters_.vreman * slab_.grid.h;
  // h d u_d / d x_e in cell i; across the faces of d the mean over four edges.
  const auto slope = [=](int e, int d, int i) {
    const double* q = u[d] + i;
    const std::ptrdiff_t s = stride[e], t = stride[d];
    return e == d ? q[s] - q[0] : 0.25 * ((q[s] - q[-s]) + (q[s + t] - q[t - s]));
  };
#pragma omp simd
  for (int i = 0; i < slab_.grid.cells[0]; ++i) {
    const double xx = slope(0, 0, i), xy = slope(0, 1, i), xz = slope(0, 2, i);
    const double yx = slope(1, 0, i), yy = slope(1, 1, i), yz = slope(1, 2, i);
    const double zx = slope(2, 0, i), zy = slope(2, 1, i), zz = slope(2, 2, i);
    const double b11 = xx * xx + yx * yx + zx * zx, b22 = xy * xy + yy * yy + zy * zy,
                 b33 = xz * xz + yz * yz + zz * zz, b12 = xx * xy + yx * yy + zx * zy,
                 b13 = xx * xz + yx * yz + zx * zz, b23 = xy * xz + yy * yz + zy * zz;
    const double size = b11 + b22 + b33;
    const double minors = b11 * b22 - b12 * b12 + b11 * b33 - b13 * b13 + b22 * b33 - b23 * b23;
    // With differences over h instead of derivatives: h times sqrt(B / alpha:alpha). Differences of
    // round-off are no eddies.
    const double ratio = minors > 1e-14 * size * size ? minors / size : 0;
    nu[i] += factor * std::sqrt(ratio);
  }
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
  const bool low_end = !slab_.periodic_z && slab_.is_lowest();
  for (int d = 0; d < 3; ++d) {
    const int from_i = d == 0 && !boundaries_.periodic(0) ? 1 : 0;
    const int from_j = d == 1 && !boundaries_.periodic(1) ? 1 : 0;
    const int from_k = d == 2 && low_end ? 1 : 0;  // the highest face w(nz) lies beyond the planes
    for (int k = from_k; k < slab_.planes; ++k) {
      for (int j = from_j; j < slab_.grid.cells[1]; ++j)
        add_row(d, {from_i, j, k}, velocity, weight, rate[d].row(j, k), next[d].row(j, k));
    }
  }
}

// With d the component, e and f the other two directions.
void ExtraViscosity::add_row(int d, const std::array<int, 3>& from, const FaceField& velocity, double weight,
                             double* __restrict rate, double* __restrict next) const {
  const int j = from[1], k = from[2];
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  const int e = (d + 1) % 3, f = (d + 2) % 3;
  const std::ptrdiff_t sd = stride[d], se = stride[e], sf = stride[f];
  const double *q = velocity[d].row(j, k), *r = velocity[e].row(j, k), *s = velocity[f].row(j, k),
               *nu = nu_.row(j, k);
  const double per_h2 = 1 / (slab_.grid.h * slab_.grid.h);
  // Shear stress over the two edges along t of the face of d, c the component across: above less below.
  const auto shear = [=](const double* c, std::ptrdiff_t t, int i) {
    const double below = 0.25 * (nu[i] + nu[i - sd] + nu[i - t] + nu[i - sd - t]);
    const double above = 0.25 * (nu[i] + nu[i - sd] + nu[i + t] + nu[i + t - sd]);
    return above * (q[i + t] - q[i] + c[i + t] - c[i + t - sd]) -
           below * (q[i] - q[i - t] + c[i] - c[i - sd]);
  };
#pragma omp simd
  for (int i = from[0]; i < slab_.grid.cells[0]; ++i) {
    const double along = 2 * (nu[i] * (q[i + sd] - q[i]) - nu[i - sd] * (q[i] - q[i - sd]));
    const double sum = along + shear(r, se, i) + shear(s, sf, i);
    rate[i] += per_h2 * sum;
    next[i] += weight * per_h2 * sum;
  }
}

}  // namespace valsalva::fluid
