// The projection on the fluid's cells alone, and the openings of the vessel.
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "fluid/flow.hpp"

namespace valsalva::fluid {

int Flow::add_opening(const OpeningPlane& plane) {
  if (!krylov_)
    throw InputError("fluid: the opening '{}' needs the pressure solver of the fluid's cells (krylov)",
                     plane.name);
  cells_of_version_ = -1;
  return openings_->add(plane);
}

void Flow::fill_ghosts() {
  if (openings_if_any() && cells_of_version_ >= 0) {
    for (Field& u : velocity_.component) exchange_planes(slab_, u, ghosts);
    openings_->extend(velocity_);
  }
  fill_velocity_ghosts(slab_, boundaries_, velocity_);
}

void Flow::prepare_cells() {
  if (!mpi::any(slab_.comm, cells_of_version_ != solids_.version())) return;
  const Grid& grid = slab_.grid;
  const bool any = openings_if_any() != nullptr;
  if (any) openings_->build(solids_);
  FaceField conductance(slab_);
  Field known(slab_);
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < (d == 2 ? slab_.w_planes() : slab_.planes); ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          if (solids_.owner(d, i, j, k) != 0) continue;
          const int at = d == 0 ? i : d == 1 ? j : k + slab_.first;
          const bool on_side = !boundaries_.periodic(d) && (at == 0 || at == grid.cells[d]);
          if (!on_side) {
            conductance[d](i, j, k) = 1;
          } else if (d == 2 && boundaries_.side[2][at == 0 ? 0 : 1] == Side::open) {
            known(i, j, at == 0 ? 0 : k - 1) += 2;
          }
        }
      }
    }
  }
  openings_->apply(conductance, known);
  krylov_->build(conductance, known, any);
  if (any) {
    const auto solves = [this](int i, int j, int k) { return krylov_->solves(i, j, k); };
    openings_->keep_joined(solves, solids_);
    // What no opening reaches stands still.
    for (int d = 0; d < 4; ++d) {
      for (int k = 0; k < (d == 2 ? slab_.w_planes() : slab_.planes); ++k) {
        for (int j = 0; j < grid.cells[1]; ++j) {
          for (int i = 0; i < grid.cells[0]; ++i) {
            const bool reached = solves(i, j, k) || solves(i - (d == 0), j - (d == 1), k - (d == 2));
            if (solids_.owner(d, i, j, k) == 0 && !reached) openings_->shut(solids_, d, i, j, k);
          }
        }
      }
    }
  }
  list_cells();
  unit_pressure_.clear();
  cells_of_version_ = solids_.version();
}

void Flow::list_cells() {
  const Grid& grid = slab_.grid;
  FaceField fluid(slab_);
  Field unused(slab_);
  for (int d = 0; d < 3; ++d) {
    for (int k = 0; k < (d == 2 ? slab_.w_planes() : slab_.planes); ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          const bool joins =
              krylov_->solves(i, j, k) || krylov_->solves(i - (d == 0), j - (d == 1), k - (d == 2));
          fluid[d](i, j, k) = solids_.owner(d, i, j, k) == 0 && joins ? 1 : 0;
        }
      }
    }
  }
  openings_->apply(fluid, unused);
  const auto runs_of = [&](int planes, const auto& counts) {
    std::vector<Run> runs;
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        bool open = false;
        for (int i = 0; i < grid.cells[0]; ++i) {
          const bool now = counts(i, j, k);
          if (now && !open) runs.push_back({pressure_.index(i, j, k), 0});
          if (now) ++runs.back().count;
          open = now;
        }
      }
    }
    return runs;
  };
  for (int d = 0; d < 3; ++d)
    fluid_faces_[d] = runs_of(d == 2 ? slab_.w_planes() : slab_.planes,
                              [&](int i, int j, int k) { return fluid[d](i, j, k) > 0; });
  fluid_cells_ = runs_of(slab_.planes, [&](int i, int j, int k) { return krylov_->solves(i, j, k); });

  shell_.clear();
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        if (krylov_->solves(i, j, k)) continue;
        Shell shell{pressure_.index(i, j, k), {}};
        for (int reach = 1; reach <= 3 && shell.from.empty(); ++reach) {
          for (int near = 0; near < 27; ++near) {
            const std::array<int, 3> by{near % 3 - 1, near / 3 % 3 - 1, near / 9 - 1};
            if (std::abs(by[0]) + std::abs(by[1]) + std::abs(by[2]) != reach) continue;
            const int p = i + by[0], q = j + by[1], r = k + by[2], z = r + slab_.first;
            if (p < 0 || p >= grid.cells[0] || q < 0 || q >= grid.cells[1] || z < 0 || z >= grid.cells[2])
              continue;
            if (krylov_->solves(p, q, r)) shell.from.push_back(pressure_.index(p, q, r));
          }
        }
        if (!shell.from.empty()) shell_.push_back(std::move(shell));
      }
    }
  }
}

// Also the test that the prediction is finite.
double Flow::largest_predicted() const {
  double speed = 0, energy = 0;
  for (int d = 0; d < 3; ++d) {
    const double* u = velocity_[d].data().data();
    for (const Run& run : fluid_faces_[d]) {
      for (std::ptrdiff_t i = run.first; i < run.first + run.count; ++i) {
        speed = std::max(speed, std::abs(u[i]));
        energy += u[i] * u[i];
      }
    }
  }
  speed = std::max(speed, openings_->largest_speed(velocity_));
  if (!std::isfinite(mpi::sum(slab_.comm, energy))) report_not_finite();
  return mpi::max(slab_.comm, speed);
}

StepReport Flow::project_cells(double dt) {
  exchange_planes(slab_, velocity_[2], 1);
  krylov_->set_floor(krylov_->tolerance() * largest_predicted() * parameters_.density / (dt * slab_.grid.h));
  krylov_->solve(
      [&](int k, const CellRows& b) {
        fill_source(k, 1 / dt, Given::velocity, b);
        if (!keep_pressure_) openings_->add_known_pressure(k, openings_->pressures(), b);
      },
      correction_);
  fill_phi_ghosts(correction_, keep_pressure_ ? std::array<double, 2>{0, 0} : end_pressure_);
  StepReport report = correct_cells(dt);
  if (!std::isfinite(report.kinetic_energy)) report_not_finite();
  if (after_projection_) report = after_projection_(dt, report);
  extend_pressure();
  fill_ghosts();
  return report;
}

StepReport Flow::correct_cells(double dt) {
  const double factor = dt / (parameters_.density * slab_.grid.h), keep = keep_pressure_ ? 1 : 0;
  const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
  double* phi = correction_.data().data();
  RowMotion motion{.speed = openings_->largest_speed(velocity_)};
  for (int d = 0; d < 3; ++d) {
    double* u = velocity_[d].data().data();
    for (const Run& run : fluid_faces_[d]) {
#pragma omp simd
      for (std::ptrdiff_t i = run.first; i < run.first + run.count; ++i)
        u[i] -= factor * (phi[i] - phi[i - stride[d]]);
      motion.add_squares(u + run.first, run.count);
    }
  }
  const std::vector<double> unchanged(openings_->count(), 0.0);
  openings_->correct(factor, keep_pressure_ ? unchanged : openings_->pressures(), correction_, velocity_);
  motion.speed = std::max(motion.speed, openings_->largest_speed(velocity_));
  const double *u = velocity_[0].data().data(), *v = velocity_[1].data().data(),
               *w = velocity_[2].data().data();
  const double* p = pressure_.data().data();
  for (const Run& run : fluid_cells_) {
    motion.add_speed(u + run.first, v + run.first, w + run.first, run.count);
#pragma omp simd
    for (std::ptrdiff_t i = run.first; i < run.first + run.count; ++i) phi[i] += keep * p[i];
  }
  pressure_.swap(correction_);
  return report_of(dt, motion);
}

// Beside the fluid, so that it can be read between cells up to the wall.
void Flow::extend_pressure() {
  exchange_planes(slab_, pressure_, 1);
  double* p = pressure_.data().data();
  for (const Shell& shell : shell_) {
    double sum = 0;
    for (const std::ptrdiff_t from : shell.from) sum += p[from];
    p[shell.cell] = sum / static_cast<double>(shell.from.size());
  }
}

}  // namespace valsalva::fluid
