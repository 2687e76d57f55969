#include "fluid/implicit_viscosity.hpp"

#include <cmath>

#include "core/errors.hpp"

namespace valsalva::fluid {

ImplicitViscosity::ImplicitViscosity(const Slab& slab, const Boundaries& boundaries,
                                     double kinematic_viscosity)
    : slab_(slab),
      boundaries_(boundaries),
      nu_(kinematic_viscosity),
      delta_(slab),
      residual_(slab),
      direction_(slab),
      image_(slab),
      mass_(slab) {}

// Rows of the unknowns, without the faces that a side prescribes.
template <class Body>
void ImplicitViscosity::each_row(int d, const Body& body) const {
  const int from_i = d == 0 && !boundaries_.periodic(0) ? 1 : 0;
  const int from_j = d == 1 && !boundaries_.periodic(1) ? 1 : 0;
  const auto prescribed = [&](End end) { return d == 2 && boundaries_.end(end) != Side::open; };
  const int from_k = !slab_.periodic_z && slab_.is_lowest() && prescribed(End::low) ? 1 : 0;
  int to_k = d == 2 ? slab_.w_planes() : slab_.planes;
  if (!slab_.periodic_z && slab_.is_highest() && prescribed(End::high)) --to_k;
  for (int k = from_k; k < to_k; ++k) {
    for (int j = from_j; j < slab_.grid.cells[1]; ++j) body(from_i, slab_.grid.cells[0], j, k);
  }
}

// One layer: periodic; 0 on the low and high faces of closed sides (values there are prescribed); odd for
// tangential components at walls and inflow, even at slip sides and open ends.
void ImplicitViscosity::fill_ghosts(int d, Field& field) const {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const auto sign = [](Side kind) { return kind == Side::wall || kind == Side::inflow ? -1.0 : 1.0; };
  const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
  for (int k = 0; k < planes; ++k) {
    for (int j = 0; j < ny; ++j) {
      double* row = field.row(j, k);
      if (boundaries_.periodic(0)) {
        row[-1] = row[nx - 1];
        row[nx] = row[0];
      } else if (d == 0) {
        row[nx] = 0;
      } else {
        row[-1] = sign(boundaries_.side[0][0]) * row[0];
        row[nx] = sign(boundaries_.side[0][1]) * row[nx - 1];
      }
    }
    const bool wrap = boundaries_.periodic(1);
    const double low = wrap ? 1 : sign(boundaries_.side[1][0]),
                 high = wrap ? 1 : sign(boundaries_.side[1][1]);
    for (int i = 0; i < nx; ++i) {
      if (d == 1 && !wrap) {
        field(i, ny, k) = 0;
      } else {
        field(i, -1, k) = low * field(i, wrap ? ny - 1 : 0, k);
        field(i, ny, k) = high * field(i, wrap ? 0 : ny - 1, k);
      }
    }
  }
  exchange_planes(slab_, field, 1);
  if (slab_.periodic_z) return;
  for (int side = 0; side < 2; ++side) {
    if (side == 0 ? !slab_.is_lowest() : !slab_.is_highest()) continue;
    const int inner = side == 0 ? 0 : planes - 1, ghost = side == 0 ? -1 : planes;
    const double factor = d == 2 ? 1 : sign(boundaries_.side[2][side]);
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) field(i, j, ghost) = factor * field(i, j, inner);
    }
  }
}

double ImplicitViscosity::dot(int d, const Field& a, const Field& b) const {
  double sum = 0;
  each_row(d, [&](int from, int to, int j, int k) {
    const double *p = a.row(j, k), *q = b.row(j, k);
    double of_row = 0;
#pragma omp simd reduction(+ : of_row)
    for (int i = from; i < to; ++i) of_row += p[i] * q[i];
    sum += of_row;
  });
  return mpi::sum(slab_.comm, sum);
}

// out = (mass - half lap h^2) x, half = dt nu / (2 h^2)
void ImplicitViscosity::apply(int d, double half, Field& x, Field& out) const {
  fill_ghosts(d, x);
  const std::ptrdiff_t sy = slab_.stride_y, sz = slab_.stride_z;
  each_row(d, [&](int from, int to, int j, int k) {
    const double *q = x.row(j, k), *mass = mass_.row(j, k);
    double* __restrict to_row = out.row(j, k);
#pragma omp simd
    for (int i = from; i < to; ++i) {
      const double laplacian =
          (q[i + 1] + q[i - 1]) + (q[i + sy] + q[i - sy]) + (q[i + sz] + q[i - sz]) - 6 * q[i];
      to_row[i] = mass[i] * q[i] - half * laplacian;
    }
  });
}

void ImplicitViscosity::solve(double dt, double ratio, const FaceField& velocity, const Solids& solids,
                              FaceField& next) {
  const double full = dt * nu_ / (slab_.grid.h * slab_.grid.h), half = 0.5 * full;
  const std::ptrdiff_t sy = slab_.stride_y, sz = slab_.stride_z;
  iterations_ = 0;
  for (int d = 0; d < 3; ++d) {
    const Field& u = velocity[d];
    // Prescribed faces: their known change, which the unknowns' rows see through the first image.
    for (int k = 0; k < (d == 2 ? slab_.w_planes() : slab_.planes); ++k) {
      for (int j = 0; j < slab_.grid.cells[1]; ++j) {
        for (int i = 0; i < slab_.grid.cells[0]; ++i) delta_(i, j, k) = next[d](i, j, k) - u(i, j, k);
      }
    }
    mass_.fill(1);
    each_row(d, [&](int from, int to, int j, int k) {
      const double* q = u.row(j, k);
      const double* explicit_part = delta_.row(j, k);
      double* b = residual_.row(j, k);
      const bool end =
          d == 2 && !slab_.periodic_z && (k + slab_.first == 0 || k + slab_.first == slab_.grid.cells[2]);
      const double outward = k == 0 ? -1 : 1;
#pragma omp simd
      for (int i = from; i < to; ++i) {
        const double laplacian =
            (q[i + 1] + q[i - 1]) + (q[i + sy] + q[i - sy]) + (q[i + sz] + q[i - sz]) - 6 * q[i];
        b[i] = explicit_part[i] + (end && outward * q[i] < 0 ? 0.0 : full) * laplacian;
      }
    });
    if (ratio > 0) {
      solids.each_face(d, velocity, [&](std::ptrdiff_t at, double target) {
        mass_.data()[at] += ratio;
        residual_.data()[at] -= ratio * (u.data()[at] - target);
      });
    }
    // Faces that are held start from their exact value, others from the explicit change.
    each_row(d, [&](int from, int to, int j, int k) {
      const double *mass = mass_.row(j, k), *b = residual_.row(j, k);
      double* x = delta_.row(j, k);
      for (int i = from; i < to; ++i) x[i] = b[i] / mass[i];
    });
    const auto precondition = [&](double factor) {  // direction = M^-1 residual + factor direction
      double sum = 0;
      each_row(d, [&](int from, int to, int j, int k) {
        const double *r = residual_.row(j, k), *mass = mass_.row(j, k);
        double* p = direction_.row(j, k);
        double of_row = 0;
#pragma omp simd reduction(+ : of_row)
        for (int i = from; i < to; ++i) {
          const double z = r[i] / (mass[i] + 6 * half);
          of_row += z * r[i];
          p[i] = z + factor * p[i];
        }
        sum += of_row;
      });
      return mpi::sum(slab_.comm, sum);
    };
    const auto size_of_residual = [&] {  // r M^-1 r
      double sum = 0;
      each_row(d, [&](int from, int to, int j, int k) {
        const double *r = residual_.row(j, k), *mass = mass_.row(j, k);
        double of_row = 0;
#pragma omp simd reduction(+ : of_row)
        for (int i = from; i < to; ++i) of_row += r[i] * r[i] / (mass[i] + 6 * half);
        sum += of_row;
      });
      return mpi::sum(slab_.comm, sum);
    };
    const double start = size_of_residual();
    apply(d, half, delta_, image_);
    const auto subtract = [&](double factor) {
      each_row(d, [&](int from, int to, int j, int k) {
        double* r = residual_.row(j, k);
        const double* ax = image_.row(j, k);
        for (int i = from; i < to; ++i) r[i] -= factor * ax[i];
      });
    };
    subtract(1);
    direction_.fill(0);
    double rho = precondition(0);
    int iteration = 0;
    for (; rho > 1e-20 * start && rho > 0; ++iteration) {
      if (iteration == 1000)
        throw NumericalFailure(
            "fluid: implicit viscosity left {:.1e} of the residual of component {} after 1000 iterations; "
            "use "
            "a smaller time step",
            std::sqrt(rho / start), "xyz"[d]);
      apply(d, half, direction_, image_);
      const double alpha = rho / dot(d, direction_, image_);
      each_row(d, [&](int from, int to, int j, int k) {
        double* x = delta_.row(j, k);
        const double* p = direction_.row(j, k);
        for (int i = from; i < to; ++i) x[i] += alpha * p[i];
      });
      subtract(alpha);
      const double before = rho;
      rho = size_of_residual();
      precondition(rho / before);
    }
    iterations_ = std::max(iterations_, iteration);
    each_row(d, [&](int from, int to, int j, int k) {
      const double *q = u.row(j, k), *x = delta_.row(j, k);
      double* out = next[d].row(j, k);
      for (int i = from; i < to; ++i) out[i] = q[i] + x[i];
    });
  }
}

}  // namespace valsalva::fluid
