// Flow's projection: the pressure that takes the velocity's divergence away, and what is left of it.
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/mpi.hpp"
#include "fluid/flow.hpp"
#include "fluid/fourth_order.hpp"

namespace valsalva::fluid {

std::array<const double*, 3> Flow::faces_of(int place, int k) const {
  const int nx = slab_.grid.cells[0], i = place % nx, j = place / nx;
  return {velocity_[0].row(j, k) + i, velocity_[1].row(j, k) + i, velocity_[2].row(j, k) + i};
}

void Flow::constrain(FaceField& velocity, Planes within) {
  VALSALVA_ASSERT(parameters_.order == 2);
  solids_.still(velocity, within);
  if (krylov_) return;
  // A cell beneath a plane of faces w has them for its upper ones.
  const Planes of_cells{std::max(within.from, 1) - 1, within.to};
  velocity_.swap(velocity);
  exchange_planes(slab_, velocity_[2], 1);
  poisson_->solve([&](int k, const CellRows& b) { fill_source(k, 1, Given::nothing, b); }, correction_,
                  of_cells);
  fill_phi_ghosts(correction_, {0, 0});
  const double factor = 1 / (parameters_.density * slab_.grid.h);
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  for (int d = 0; d < 3; ++d) {
    const int planes = std::min(within.to, d == 2 ? slab_.w_planes() : slab_.planes);
    for (int k = std::max(within.from, 0); k < planes; ++k)
      for (int j = 0; j < slab_.grid.cells[1]; ++j) {
        double* u = velocity_[d].row(j, k);
        const double* phi = correction_.row(j, k);
#pragma omp simd
        for (int i = 0; i < slab_.grid.cells[0]; ++i) u[i] -= factor * (phi[i] - phi[i - stride[d]]);
      }
  }
  velocity_.swap(velocity);
}

void Flow::fill_source(int k, double per_dt, Given through, const CellRows& source) {
  const double given = through == Given::velocity ? 1 : 0;
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const double factor = parameters_.density * per_dt / slab_.grid.h;
  const std::ptrdiff_t sy = slab_.stride_y, sz = slab_.stride_z;
  const double* first_v = velocity_[1].row(0, k);
  double* end_v = velocity_[1].row(ny, k);
  if (boundaries_.periodic(1)) {
    std::copy_n(first_v, nx, end_v);
  } else {
    for (int i = 0; i < nx; ++i) end_v[i] = given * boundaries_.inflow[1][1].at(1, i, k);
  }
  for (int j = 0; j < ny; ++j) {
    double* u = velocity_[0].row(j, k);
    u[nx] = boundaries_.periodic(0) ? u[0] : given * boundaries_.inflow[0][1].at(0, j, k);
    const double* v = velocity_[1].row(j, k);
    const double* w = velocity_[2].row(j, k);
    double* b = source.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i)
      b[i] = factor * ((u[i + 1] - u[i]) + (v[i + sy] - v[i]) + (w[i + sz] - w[i]));
  }
  for (const Solids::CutCell& cell : solids_.cut_cells(k))
    source(cell.place % nx, cell.place / nx) = factor * cell.difference(faces_of(cell.place, k), {1, sy, sz});
}

StepReport Flow::project(double dt) {
  if (krylov_) return project_cells(dt);
  const bool fourth = parameters_.order == 4;
  // The exchange does not reach the highest face of a closed box, which belongs to its own slab.
  if (fourth) {
    fill_ghosts();
  } else {
    exchange_planes(slab_, velocity_[2], 1);
  }
  poisson_->solve(
      [&](int k, const CellRows& b) {
        fourth ? fill_source_fourth_order(k, 1 / dt, b) : fill_source(k, 1 / dt, Given::velocity, b);
      },
      correction_);
  const std::array<double, 2> ends = keep_pressure_ ? std::array<double, 2>{0, 0} : end_pressure_;
  fill_phi_ghosts(correction_, ends);
  StepReport report = fourth ? correct_fourth_order(dt) : correct(dt);
  if (!std::isfinite(report.kinetic_energy)) report_not_finite();
  if (after_projection_) report = after_projection_(dt, report);
  fill_ghosts();
  return report;
}

void Flow::fill_source_fourth_order(int k, double per_dt, const CellRows& source) const {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const double factor = parameters_.density * per_dt / slab_.grid.h;
  const std::ptrdiff_t sy = slab_.stride_y, sz = slab_.stride_z;
  for (int j = 0; j < ny; ++j) {
    const double* u = velocity_[0].row(j, k) + 1;
    const double* v = velocity_[1].row(j, k) + sy;
    const double* w = velocity_[2].row(j, k) + sz;
    double* b = source.row(j);
#pragma omp simd
    for (int i = 0; i < nx; ++i)
      b[i] = factor * (fourth_order::difference(u + i, 1) + fourth_order::difference(v + i, sy) +
                       fourth_order::difference(w + i, sz));
  }
}

StepReport Flow::correct_fourth_order(double dt) {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const std::ptrdiff_t sy = slab_.stride_y, sz = slab_.stride_z;
  const double factor = dt / (parameters_.density * slab_.grid.h);
  const double keep = keep_pressure_ ? 1 : 0;
  RowMotion motion;
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < ny; ++j) {
      const double* phi = correction_.row(j, k);
      double* u = velocity_[0].row(j, k);
      double* v = velocity_[1].row(j, k);
      double* w = velocity_[2].row(j, k);
#pragma omp simd
      for (int i = 0; i < nx; ++i) {
        u[i] -= factor * fourth_order::difference(phi + i, 1);
        v[i] -= factor * fourth_order::difference(phi + i, sy);
        w[i] -= factor * fourth_order::difference(phi + i, sz);
      }
      motion.add(u, v, w, nx);
    }
  }
  for (std::size_t i = 0; i < correction_.data().size(); ++i)
    correction_.data()[i] += keep * pressure_.data()[i];
  pressure_.swap(correction_);
  return report_of(dt, motion);
}

// The new pressure takes the place of phi where no face needs it any more, a plane behind the velocity: the
// old pressure stays for undo().
StepReport Flow::correct(double dt) {
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const std::ptrdiff_t sy = slab_.stride_y, sz = slab_.stride_z;
  const double factor = dt / (parameters_.density * slab_.grid.h);
  const double keep = keep_pressure_ ? 1 : 0;
  RowMotion motion;
  const auto add_old_pressure = [&](int k) {
    for (int j = 0; j < ny; ++j) {
      double* phi = correction_.row(j, k);
      const double* p = pressure_.row(j, k);
#pragma omp simd
      for (int i = 0; i < nx; ++i) phi[i] += keep * p[i];
    }
  };
  for (int k = 0; k < slab_.w_planes(); ++k) {
    for (int j = 0; j < ny; ++j) {
      const double* phi = correction_.row(j, k);
      double* w = velocity_[2].row(j, k);
      if (k == slab_.planes) {
        for (int i = 0; i < nx; ++i) w[i] -= factor * (phi[i] - phi[i - sz]);
        motion.add(w, nx);
        continue;
      }
      double* u = velocity_[0].row(j, k);
      double* v = velocity_[1].row(j, k);
#pragma omp simd
      for (int i = 0; i < nx; ++i) {
        u[i] -= factor * (phi[i] - phi[i - 1]);
        v[i] -= factor * (phi[i] - phi[i - sy]);
        w[i] -= factor * (phi[i] - phi[i - sz]);
      }
      motion.add(u, v, w, nx);
    }
    if (k > 0) add_old_pressure(k - 1);
  }
  if (slab_.w_planes() == slab_.planes) add_old_pressure(slab_.planes - 1);
  pressure_.swap(correction_);
  return report_of(dt, motion);
}

StepReport Flow::report_of(double dt, const RowMotion& motion) const {
  StepReport report;
  report.kinetic_energy =
      mpi::sum(slab_.comm, 0.5 * parameters_.density * std::pow(slab_.grid.h, 3) * motion.squares);
  report.max_speed = mpi::max(slab_.comm, motion.speed);
  report.cfl = dt * report.max_speed / slab_.grid.h;
  return report;
}

}  // namespace valsalva::fluid
