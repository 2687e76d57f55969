// How a step's pressure and velocity answer to the pressures that are known at ends and openings: linearly,
//   p += sum_j r_j psi_j,   u -= dt/rho sum_j r_j grad psi_j,   lap psi_j = 0, psi_j = 1 at place j, 0 at
//   others
// where r_j is the rise. In the whole box (direct solver) psi_j is linear from end to end.
#include <algorithm>
#include <cmath>

#include "core/mpi.hpp"
#include "fluid/flow.hpp"

namespace valsalva::fluid {

double Flow::known_pressure(const PressurePlace& place) const {
  const End* end = std::get_if<End>(&place);
  return end ? end_pressure(*end) : openings_->pressure(std::get<int>(place));
}

const Field& Flow::unit_pressure(const PressurePlace& place) {
  const auto found = unit_pressure_.find(place);
  if (found != unit_pressure_.end()) return found->second;
  Field& unit = unit_pressure_.emplace(place, slab_).first->second;
  const End* end = std::get_if<End>(&place);
  std::vector<double> known(openings_->count(), 0.0);
  if (!end) known[std::get<int>(place)] = 1;
  const int nx = slab_.grid.cells[0], ny = slab_.grid.cells[1];
  const double h = slab_.grid.h;
  Field start(slab_), zero(slab_);
  krylov_->store_start(start);
  krylov_->load_start(zero);
  krylov_->set_floor(0);
  krylov_->solve(
      [&](int k, const CellRows& b) {
        for (int j = 0; j < ny; ++j) std::fill_n(b.row(j), nx, 0.0);
        openings_->add_known_pressure(k, known, b);
        if (!end) return;
        const bool low = *end == End::low;
        if (low ? !(slab_.is_lowest() && k == 0) : !(slab_.is_highest() && k == slab_.planes - 1)) return;
        const std::uint8_t* owner = solids_.owner_row(2, 0, low ? 0 : slab_.planes);
        for (int j = 0; j < ny; ++j) {
          for (int i = 0; i < nx; ++i) b(i, j) -= *owner++ == 0 ? 2 / (h * h) : 0;
        }
      },
      unit);
  krylov_->load_start(start);
  return unit;
}

void Flow::gather_rises(const std::vector<PressureRise>& rises) {
  raised_end_ = {0, 0};
  raised_opening_.assign(openings_ ? openings_->count() : 0, 0.0);
  for (const auto& [place, by] : rises) {
    if (const End* end = std::get_if<End>(&place)) {
      raised_end_[static_cast<int>(*end)] += by;
    } else {
      raised_opening_[std::get<int>(place)] += by;
    }
  }
  if (!krylov_) return;
  if (!raised_) raised_.emplace(slab_);
  raised_->fill(0);
  for (const auto& [place, by] : rises) {
    const Field::Data& unit = unit_pressure(place).data();
    Field::Data& sum = raised_->data();
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += by * unit[i];
  }
  fill_phi_ghosts(*raised_, raised_end_);
}

/// Without krylov: of the cells of a local plane.
double Flow::raised_at(int k) const {
  const bool low = boundaries_.end(End::low) == Side::open, high = boundaries_.end(End::high) == Side::open;
  if (!low || !high) return low ? raised_end_[0] : raised_end_[1];
  const double share = (k + slab_.first + 0.5) / slab_.grid.cells[2];
  return raised_end_[0] + share * (raised_end_[1] - raised_end_[0]);
}

void Flow::add_response(const std::vector<PressureRise>& rises, double dt, FaceField& velocity) {
  gather_rises(rises);
  const double factor = dt / (parameters_.density * slab_.grid.h);
  if (krylov_) {
    const std::array<std::ptrdiff_t, 3> stride{1, slab_.stride_y, slab_.stride_z};
    const double* phi = raised_->data().data();
    for (int d = 0; d < 3; ++d) {
      double* u = velocity[d].data().data();
      for (const Run& run : fluid_faces_[d]) {
        for (std::ptrdiff_t i = run.first; i < run.first + run.count; ++i)
          u[i] -= factor * (phi[i] - phi[i - stride[d]]);
      }
    }
    openings_->correct(factor, raised_opening_, *raised_, velocity);
    return;
  }
  const double by = factor * (raised_at(1) - raised_at(0));
  if (by == 0) return;
  for (int k = 0; k < slab_.w_planes(); ++k) {
    for (int j = 0; j < slab_.grid.cells[1]; ++j) {
      double* w = velocity[2].row(j, k);
      for (int i = 0; i < slab_.grid.cells[0]; ++i) w[i] -= by;
    }
  }
}

StepReport Flow::raise(const std::vector<PressureRise>& rises, double dt) {
  add_response(rises, dt, velocity_);
  for (int end = 0; end < 2; ++end) end_pressure_[end] += raised_end_[end];
  for (std::size_t o = 0; o < raised_opening_.size(); ++o)
    openings_->set_pressure(static_cast<int>(o),
                            openings_->pressure(static_cast<int>(o)) + raised_opening_[o]);
  if (krylov_) {
    double* p = pressure_.data().data();
    for (const Run& run : fluid_cells_) {
      for (std::ptrdiff_t i = run.first; i < run.first + run.count; ++i) p[i] += raised_->data()[i];
    }
  } else {
    for (int k = 0; k < slab_.planes; ++k) {
      const double by = raised_at(k);
      for (int j = 0; j < slab_.grid.cells[1]; ++j) {
        double* p = pressure_.row(j, k);
        for (int i = 0; i < slab_.grid.cells[0]; ++i) p[i] += by;
      }
    }
  }
  return measure(dt);
}

StepReport Flow::measure(double dt) const {
  RowMotion motion;
  if (krylov_) {
    const double *u = velocity_[0].data().data(), *v = velocity_[1].data().data(),
                 *w = velocity_[2].data().data();
    for (int d = 0; d < 3; ++d) {
      for (const Run& run : fluid_faces_[d])
        motion.add_squares(velocity_[d].data().data() + run.first, run.count);
    }
    for (const Run& run : fluid_cells_)
      motion.add_speed(u + run.first, v + run.first, w + run.first, run.count);
    motion.speed = std::max(motion.speed, openings_->largest_speed(velocity_));
    return report_of(dt, motion);
  }
  const int nx = slab_.grid.cells[0];
  for (int k = 0; k < slab_.w_planes(); ++k) {
    for (int j = 0; j < slab_.grid.cells[1]; ++j) {
      const double* w = velocity_[2].row(j, k);
      k < slab_.planes ? motion.add(velocity_[0].row(j, k), velocity_[1].row(j, k), w, nx)
                       : motion.add(w, nx);
    }
  }
  return report_of(dt, motion);
}

}  // namespace valsalva::fluid
