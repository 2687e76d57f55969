#include "fluid/flow.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "fluid/fourth_order.hpp"
#include "fluid/poisson.hpp"
#include "fluid/poisson_periodic.hpp"

namespace valsalva::fluid {

namespace {

const Boundaries& checked(const Boundaries& boundaries, const Grid& grid, const FlowParameters& parameters) {
  boundaries.check();
  for (int d = 0; d < 3; ++d) {
    const int needed = fewest_cells(boundaries.periodic(d), parameters.krylov.has_value());
    if (grid.cells[d] < needed)
      throw InputError(
          "fluid grid: {} cells along {}; expected at least {}: refine the grid or enlarge the box",
          grid.cells[d], "xyz"[d], needed);
  }
  return boundaries;
}

std::unique_ptr<PressureSolver> pressure_solver(const Slab& slab, const Boundaries& boundaries,
                                                const FlowParameters& parameters) {
  const int order = parameters.order;
  if (parameters.krylov) {
    if (order != 2 || parameters.implicit_viscosity)
      throw InputError(
          "fluid: the pressure of the fluid's cells alone (krylov) is of order 2 and goes with explicit "
          "viscosity");
    return std::make_unique<KrylovPressure>(slab, boundaries, *parameters.krylov);
  }
  if (order == 2) return std::make_unique<Poisson>(slab, boundaries);
  if (order != 4) throw InputError("fluid: order {} in space; expected 2 or 4", order);
  if (!boundaries.periodic(0) || !boundaries.periodic(1) || !boundaries.periodic(2))
    throw InputError("fluid: order 4 in space needs a box that is periodic in all directions; use order 2");
  return std::make_unique<PeriodicPoisson>(slab, fourth_order::symbol);
}

}  // namespace

Flow::Flow(MPI_Comm comm, const Grid& grid, const Boundaries& boundaries, const FlowParameters& parameters)
    : slab_(comm, grid, checked(boundaries, grid, parameters).periodic(2)),
      boundaries_(boundaries),
      parameters_(parameters),
      solids_(slab_, parameters.density, parameters.wall),
      momentum_(slab_, boundaries_, parameters.convection,
                parameters.implicit_viscosity ? 0 : parameters.viscosity / parameters.density,
                parameters.order),
      poisson_(pressure_solver(slab_, boundaries_, parameters)),
      velocity_(slab_),
      next_(slab_),
      rate_(slab_),
      pressure_(slab_),
      correction_(slab_) {
  if (parameters.implicit_viscosity) {
    if (parameters.order == 4) throw InputError("fluid: implicit viscosity is of order 2; use order 2");
    implicit_viscosity_ =
        std::make_unique<ImplicitViscosity>(slab_, boundaries_, parameters.viscosity / parameters.density);
  }
  if (parameters.extra_viscosity.any()) {
    if (parameters.order == 4)
      throw InputError("fluid: shear-thinning blood and subgrid models are of order 2; use order 2");
    extra_viscosity_ = std::make_unique<ExtraViscosity>(slab_, boundaries_, parameters.extra_viscosity,
                                                        parameters.viscosity, parameters.density);
  }
  if (parameters.wall_upwind) {
    if (parameters.order == 4) throw InputError("fluid: upwinding beside walls is of order 2; use order 2");
    wall_upwind_ = std::make_unique<WallUpwind>(slab_, boundaries_);
  }
  if (parameters.krylov) {
    krylov_ = static_cast<KrylovPressure*>(poisson_.get());
    openings_ = std::make_unique<Openings>(slab_, parameters.viscosity / parameters.density);
    parameters_.penalisation_s = 1e-30;  // exact to round-off
  }
  fill_ghosts();
}

void Flow::set_velocity(const std::function<double(int, const Vec3&)>& value) {
  const Grid& grid = slab_.grid;
  for (int d = 0; d < 3; ++d) {
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    for (int k = 0; k < planes; ++k) {
      for (int j = 0; j < grid.cells[1]; ++j) {
        for (int i = 0; i < grid.cells[0]; ++i) {
          velocity_[d](i, j, k) = value(d, grid.position(d, i, j, k + slab_.first));
        }
      }
    }
  }
  previous_dt_ = 0;
  solids_.forget();
  rate_.fill(0);
  if (krylov_) prepare_cells();
  apply_inflow(velocity_);
  fill_ghosts();
}

void Flow::set_pressure(const std::function<double(const Vec3&)>& value) {
  const Grid& grid = slab_.grid;
  for (int k = 0; k < slab_.planes; ++k) {
    for (int j = 0; j < grid.cells[1]; ++j) {
      for (int i = 0; i < grid.cells[0]; ++i) {
        pressure_(i, j, k) = value(grid.position(3, i, j, k + slab_.first));
      }
    }
  }
}

// On the high sides of x and y no face is owned: the cell before it tells.
bool Flow::solid_at_side(int axis, int side, int a, int b) const {
  const auto& cells = slab_.grid.cells;
  if (axis == 2) return solids_.owner(2, a, b, side == 0 ? 0 : slab_.planes) != 0;
  if (axis == 0) return (side == 0 ? solids_.owner(0, 0, a, b) : solids_.owner(3, cells[0] - 1, a, b)) != 0;
  return (side == 0 ? solids_.owner(1, a, 0, b) : solids_.owner(3, a, cells[1] - 1, b)) != 0;
}

void Flow::set_inflow(int axis, int side, const std::function<double(int, const Vec3&)>& velocity) {
  if (boundaries_.side[axis][side] != Side::inflow) {
    throw InputError("fluid: an inflow velocity for the {} end in {}, whose kind is not inflow",
                     side == 0 ? "low" : "high", "xyz"[axis]);
  }
  if (!has_side(axis, side)) return;
  const Grid& grid = slab_.grid;
  const int p = axis == 0 ? 1 : 0, q = axis == 2 ? 1 : 2;
  SideVelocity& given = boundaries_.inflow[axis][side];
  const std::array<int, 2> cells{grid.cells[p], q == 2 ? slab_.planes : grid.cells[q]};
  given.extent = {cells[0] + 1, cells[1] + 1};
  for (int d = 0; d < 3; ++d) {
    given.value[d].assign(static_cast<std::size_t>(given.extent[0]) * given.extent[1], 0.0);
    // Along its own axis a tangential component has one entry more than there are cells.
    const int to_a = cells[0] + (d == p ? 1 : 0), to_b = cells[1] + (d == q ? 1 : 0);
    for (int b = 0; b < given.extent[1]; ++b) {
      for (int a = 0; a < given.extent[0]; ++a) {
        const int in_a = std::min(a, to_a - 1), in_b = std::min(b, to_b - 1);
        if (d == axis && solid_at_side(axis, side, in_a, in_b)) continue;
        std::array<int, 3> at{0, 0, 0};
        at[p] = in_a;
        at[q] = in_b;
        Vec3 x = grid.position(d, at[0], at[1], at[2] + (q == 2 ? slab_.first : 0));
        x[axis] = side == 0 ? grid.low()[axis] : grid.high()[axis];
        given.value[d][static_cast<std::size_t>(b) * given.extent[0] + a] = velocity(d, x);
      }
    }
  }
}

Flow::GivenInflow Flow::given_inflow(int axis, int side) const {
  const Grid& grid = slab_.grid;
  const SideVelocity& given = boundaries_.inflow[axis][side];
  GivenInflow sum;
  if (has_side(axis, side)) {
    for (int b = 0; b + 1 < given.extent[1]; ++b) {
      for (int a = 0; a + 1 < given.extent[0]; ++a) {
        if (solid_at_side(axis, side, a, b)) continue;
        const double speed = given.at(axis, a, b);
        sum.inwards += side == 0 ? speed : -speed;
        sum.size += std::abs(speed);
        sum.area += 1;
        sum.flowing_area += speed != 0;
      }
    }
  }
  const double face = grid.h * grid.h;
  std::array<double, 4> all{sum.inwards, sum.size, sum.area, sum.flowing_area};
  mpi::sum_in_place(slab_.comm, all.data(), all.size());
  return {face * all[0], face * all[1], face * all[2], face * all[3]};
}

void Flow::shift_inflow(int axis, int side, double speed) {
  SideVelocity& given = boundaries_.inflow[axis][side];
  if (!has_side(axis, side)) return;
  for (int b = 0; b + 1 < given.extent[1]; ++b) {
    for (int a = 0; a + 1 < given.extent[0]; ++a) {
      if (!solid_at_side(axis, side, a, b))
        given.value[axis][static_cast<std::size_t>(b) * given.extent[0] + a] += side == 0 ? speed : -speed;
    }
  }
}

void Flow::set_inflow(End end, const std::function<double(const Vec3&)>& w) {
  set_inflow(2, static_cast<int>(end), [&](int d, const Vec3& x) { return d == 2 ? w(x) : 0; });
}

void Flow::set_inflow_rate(End end, const std::function<double(const Vec3&)>& shape, double rate) {
  set_inflow(end, shape);
  const int side = static_cast<int>(end);
  const double carried = (side == 0 ? 1 : -1) * given_inflow(2, side).inwards;
  if (carried == 0) {
    throw InputError(
        "fluid: the inflow profile of the {} end carries no flow through the lumen; "
        "check that the lumen reaches this end of the box",
        side == 0 ? "low" : "high");
  }
  for (double& w : boundaries_.inflow[2][side].value[2]) w *= rate / carried;
}

void Flow::apply_inflow(FaceField& velocity) const {
  const auto& cells = slab_.grid.cells;
  for (int side = 0; side < 2; ++side) {
    if (boundaries_.side[0][side] == Side::inflow) {
      for (int k = 0; k < slab_.planes; ++k) {
        for (int j = 0; j < cells[1]; ++j)
          velocity[0](side == 0 ? 0 : cells[0], j, k) = boundaries_.inflow[0][side].at(0, j, k);
      }
    }
    if (boundaries_.side[1][side] == Side::inflow) {
      for (int k = 0; k < slab_.planes; ++k) {
        for (int i = 0; i < cells[0]; ++i)
          velocity[1](i, side == 0 ? 0 : cells[1], k) = boundaries_.inflow[1][side].at(1, i, k);
      }
    }
    if (boundaries_.side[2][side] == Side::inflow && has_side(2, side)) {
      for (int j = 0; j < cells[1]; ++j) {
        for (int i = 0; i < cells[0]; ++i)
          velocity[2](i, j, side == 0 ? 0 : slab_.planes) = boundaries_.inflow[2][side].at(2, i, j);
      }
    }
  }
}

void Flow::predict(double dt, const PredictOptions& options) {
  const double half_ratio = previous_dt_ > 0 ? 0.5 * dt / previous_dt_ : 0;
  advance({.dt = dt, .weight_new = 1 + half_ratio, .weight_old = -half_ratio}, options);
  previous_dt_ = dt;
}

void Flow::advance(Advance step, const PredictOptions& options) {
  if (!(step.dt > 0)) throw NumericalFailure("fluid: a time step of {} s", step.dt);
  step.density = parameters_.density;
  if (krylov_) {
    prepare_cells();
    openings_->keep_rates(rate_);
  }
  if (force_) step.force = &*force_;
  step.forced = options.forced;
  if (options.old_pressure) {
    fill_phi_ghosts(pressure_, end_pressure_);
    step.pressure = &pressure_;
  }
  keep_pressure_ = options.old_pressure;
  momentum_.advance(velocity_, step, rate_, next_);
  if (extra_viscosity_) {
    extra_viscosity_->update(velocity_);
    extra_viscosity_->add(velocity_, step.dt * step.weight_new, rate_, next_);
  }
  if (wall_upwind_) {
    wall_upwind_->update(solids_);
    wall_upwind_->add(velocity_, step.dt * step.weight_new, rate_, next_);
  }
  if (krylov_) openings_->advance(velocity_, step, rate_, next_);
  apply_inflow(next_);
  if (implicit_viscosity_) {
    solids_.prepare();
    const double eta = parameters_.penalisation_s;
    implicit_viscosity_->solve(step.dt, options.penalise ? step.dt / eta : 0, velocity_, solids_, next_);
    if (options.penalise) solids_.record(step.dt, eta, velocity_, next_);
    velocity_.swap(next_);
    return;
  }
  velocity_.swap(next_);
  if (options.penalise) penalise(step.dt);
}

StepReport Flow::step_rk3(double dt, const std::function<void(double)>& before_stage) {
  struct Stage {
    double part, weight_new, weight_old;  // the weights over the part of the step
  };
  constexpr std::array<Stage, 3> stages{
      {{8.0 / 15, 1, 0}, {2.0 / 15, 25.0 / 8, -17.0 / 8}, {1.0 / 3, 9.0 / 4, -5.0 / 4}}};
  StepReport report;
  double done = 0;
  for (const auto& [part, weight_new, weight_old] : stages) {
    done += part;
    if (before_stage) before_stage(done);
    advance({.dt = part * dt, .weight_new = weight_new, .weight_old = weight_old}, {});
    report = project(part * dt);
  }
  previous_dt_ = 0;
  report.cfl = dt * report.max_speed / slab_.grid.h;
  return report;
}

void Flow::fill_phi_ghosts(Field& pressure, const std::array<double, 2>& end_pressure) {
  if (parameters_.order == 4) {
    fill_periodic_ghosts(slab_, pressure, 2);
  } else {
    fill_pressure_ghosts(slab_, boundaries_, pressure, end_pressure);
  }
}

void Flow::add_impulse(const FaceField& force, double dt) {
  const double factor = dt / parameters_.density;
  const Grid& grid = slab_.grid;
  for (int d = 0; d < 3; ++d) {
    const int planes = d == 2 ? slab_.w_planes() : slab_.planes;
    const int from_i = d == 0 && !boundaries_.periodic(0) ? 1 : 0,
              from_j = d == 1 && !boundaries_.periodic(1) ? 1 : 0;
    for (int k = 0; k < planes; ++k) {
      for (int j = from_j; j < grid.cells[1]; ++j) {
        double* u = velocity_[d].row(j, k);
        const double* f = force[d].row(j, k);
        for (int i = from_i; i < grid.cells[0]; ++i) u[i] += factor * f[i];
      }
    }
  }
}

void Flow::penalise(double dt) {
  solids_.penalise(dt, parameters_.penalisation_s, next_, velocity_);  // next_: before the prediction
  if (krylov_) openings_->prescribe(velocity_);
}

void Flow::undo() {
  velocity_.swap(next_);
  pressure_.swap(correction_);
  solids_.undo();
  previous_dt_ = 0;
}

void Flow::report_not_finite() const {
  const Grid& grid = slab_.grid;
  const double none = static_cast<double>(grid.all_cells());
  double found = none;
  for (int k = slab_.planes - 1; k >= 0; --k) {
    for (int j = grid.cells[1] - 1; j >= 0; --j) {
      for (int i = grid.cells[0] - 1; i >= 0; --i) {
        double sum = pressure_(i, j, k);
        for (int d = 0; d < 3; ++d) sum += std::pow(velocity_[d](i, j, k), 2);
        if (!std::isfinite(sum))
          found = (static_cast<double>(k + slab_.first) * grid.cells[1] + j) * grid.cells[0] + i;
      }
    }
  }
  const long cell = static_cast<long>(mpi::min(slab_.comm, found));
  const int i = static_cast<int>(cell % grid.cells[0]),
            j = static_cast<int>(cell / grid.cells[0] % grid.cells[1]),
            k = static_cast<int>(cell / grid.cells[0] / grid.cells[1]);
  const Vec3 x = grid.position(3, i, j, k);
  throw NumericalFailure(
      "fluid: the velocity is not finite; first in cell ({}, {}, {}) at ({:.2f}, {:.2f}, {:.2f}) mm. "
      "Use a smaller time step (CFL and viscous limits), or look for a body that moves too fast there",
      i, j, k, x[0], x[1], x[2]);
}

}  // namespace valsalva::fluid
