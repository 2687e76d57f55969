// Incompressible Navier-Stokes in a box, with walls and held bodies inside, by an incremental projection
// method.
//
//   u* = u^n + dt [ (1 + r/2) N^n - r/2 N^(n-1) ] + dt/rho (f - grad p^n),   r = dt / dt_previous (first
//   step: N^n) u* <- (u* + dt/eta U_solid) / (1 + dt/eta)                               on solid faces lap
//   phi = rho/dt div u*,   u^(n+1) = u* - dt/rho grad phi,   p^(n+1) = p^n + phi
//
//   N = -div(u u) + nu lap u      (momentum.hpp); with shear-thinning blood or a subgrid model + div(2 nu_x
//   S)
//                                 (viscosity.hpp)
//
// Second order in space and in time for the velocity (first order at staircase walls and bodies). Explicit:
// stable for dt (|u|+|v|+|w|)/h below about 0.5 to 1 and dt < h^2 / (12 nu). What open ends prescribe:
// boundary.hpp.
//
// step_rk3 instead: three stages of Wray's scheme (Spalart, Moser, Rogers 1991, J. Comput. Phys. 96,
// appendix), each an incremental projection, with alpha = 8/15, 2/15, 1/3 of the step and
//   u* = u + dt (gamma N + zeta N_before) + alpha dt/rho (f - grad p), gamma = 8/15, 5/12, 3/4,
//   zeta = 0, -17/60, -5/12
// Third order in time in periodic boxes; stable to three times the step of AB2 for three times its cost,
// without its growth of undamped waves.
//
// With FlowParameters::krylov the pressure is that of the fluid's cells alone: no gradient acts on solid
// faces, which have their body's velocity exactly (penalisation_s does not count), and `Openings` may cut the
// vessel. Only faces of the fluid are corrected; kinetic energy, speed and divergence are those of the
// fluid's cells.
//
// Order 4 in space replaces convection, viscosity, gradient and divergence (momentum.hpp, fourth_order.hpp)
// and solves for the pressure with the same operators (poisson_periodic.hpp).
//
// Order of calls in one step, forces known at its start:
//     (set flow.force(), or add to it); flow.predict(dt); flow.project(dt);
// or, for a force that depends on the predicted velocity:
//     flow.predict(dt, {.old_pressure = false, .penalise = false}); ... flow.add_impulse(...);
//     flow.penalise(dt); flow.project(dt);
// All member functions are collective over the communicator.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fluid/boundary.hpp"
#include "fluid/grid.hpp"
#include "fluid/implicit_viscosity.hpp"
#include "fluid/krylov_pressure.hpp"
#include "fluid/momentum.hpp"
#include "fluid/openings.hpp"
#include "fluid/pressure_solver.hpp"
#include "fluid/row_motion.hpp"
#include "fluid/solids.hpp"
#include "fluid/viscosity.hpp"
#include "fluid/wall_upwind.hpp"
#include "state/state.hpp"

namespace valsalva::fluid {

struct FlowParameters {
  double density = 1.0e-3;    ///< g/mm3
  double viscosity = 3.5e-3;  ///< Pa s
  Convection convection = Convection::upwind3;
  double penalisation_s = 1e-8;     ///< eta, the time constant of solid faces
  Wall wall = Wall::staircase;      ///< how the lumen's wall cuts the grid (solids.hpp)
  int order = 2;                    ///< in space; 4 only in boxes periodic in all directions
  bool implicit_viscosity = false;  ///< of the constant part (implicit_viscosity.hpp)
  ExtraViscosityParameters extra_viscosity;
  bool wall_upwind = false;  ///< first-order upwinding beside walls (wall_upwind.hpp)
  /// The pressure of the fluid's cells alone (krylov_pressure.hpp): solids are tight and carry no pressure,
  /// and the vessel may have openings. None: the direct solver, for the whole box.
  std::optional<KrylovSettings> krylov;
};

struct PredictOptions {
  Planes forced = {};        ///< outside of them force() is zero
  bool old_pressure = true;  ///< false: a non-incremental step (p^(n+1) = phi)
  bool penalise = true;
};

/// What project() learns about the new velocity at no further cost.
struct StepReport {
  double cfl = 0;             ///< dt max(|u|+|v|+|w|)/h over cells
  double max_speed = 0;       ///< mm/s, max of |u|+|v|+|w| over cells
  double kinetic_energy = 0;  ///< nanojoule, over the whole box
};

struct WallPoint {
  Vec3 x, normal;  ///< normal: towards the fluid
};

class Flow {
 public:
  Flow(MPI_Comm comm, const Grid& grid, const Boundaries& boundaries, const FlowParameters& parameters);
  Flow(const Flow&) = delete;
  Flow& operator=(const Flow&) = delete;

  const Slab& slab() const { return slab_; }
  const Grid& grid() const { return slab_.grid; }
  const Boundaries& boundaries() const { return boundaries_; }
  const FlowParameters& parameters() const { return parameters_; }
  Solids& solids() { return solids_; }
  const Solids& solids() const { return solids_; }

  /// Ghosts are valid after construction, set_velocity and project. Between predict and project it holds u*,
  /// whose ghosts need fill_ghosts() before they are read.
  FaceField& velocity() { return velocity_; }
  const FaceField& velocity() const { return velocity_; }
  const Field& pressure() const { return pressure_; }
  /// Force density on the fluid, micronewton/mm3, on the owned faces. Zero, and no memory, until it is asked
  /// for.
  FaceField& force() { return force_ ? *force_ : force_.emplace(slab_); }
  void fill_ghosts();

  /// Initial velocity (component d at the position of its face, mm/s) and pressure; forgets the step history.
  void set_velocity(const std::function<double(int d, const Vec3& x)>& value);
  void set_pressure(const std::function<double(const Vec3& x)>& value);

  /// Pressure of the reservoir at an open end, Pa.
  void set_end_pressure(End end, double pressure) { end_pressure_[static_cast<int>(end)] = pressure; }
  double end_pressure(End end) const { return end_pressure_[static_cast<int>(end)]; }
  double known_pressure(const PressurePlace& place) const;
  /// Called at the end of every projection over dt, before ghosts are filled; returns what is to be reported
  /// instead. For what answers to the new velocity (raise).
  void after_projection(std::function<StepReport(double dt, const StepReport& found)> hook) {
    after_projection_ = std::move(hook);
  }
  /// Within after_projection: as though these pressures had been known higher at the end of the step. Exact,
  /// without another solve but one for each place whenever the fluid's cells have changed (krylov).
  StepReport raise(const std::vector<PressureRise>& rises, double dt);
  /// What raise adds to a velocity (owned faces).
  void add_response(const std::vector<PressureRise>& rises, double dt, FaceField& velocity);

  /// Tangential velocity of a wall from now on, mm/s. Ghosts take it with the next step or fill_ghosts().
  void set_wall_velocity(int axis, int side, const Vec3& velocity) {
    boundaries_.velocity[axis][side] = velocity;
  }
  /// Velocity on an inflow side of the axis 0, 1, 2 (side 0 low, 1 high): component d at x, mm/s. Solid faces
  /// stay at rest. Before predict: that at the end of the step.
  void set_inflow(int axis, int side, const std::function<double(int d, const Vec3& x)>& velocity);
  /// What the given velocity of an inflow side carries: flow into the box, sum of the sizes (mm3/s), open
  /// area and the part of it with flow (mm2).
  struct GivenInflow {
    double inwards = 0, size = 0, area = 0, flowing_area = 0;
  };
  GivenInflow given_inflow(int axis, int side) const;
  /// Adds to the inward velocity of the open faces of an inflow side, mm/s.
  void shift_inflow(int axis, int side, double speed);
  /// Velocity along +z on the faces of an inflow end, mm/s, without tangential part.
  void set_inflow(End end, const std::function<double(const Vec3& x)>& w);
  /// The same shape, scaled to a flow in mm3/s along +z. InputError when the shape carries no flow.
  void set_inflow_rate(End end, const std::function<double(const Vec3& x)>& shape, double rate);

  /// Where the vessel is open; needs FlowParameters::krylov. After the solids that stand still are placed.
  int add_opening(const OpeningPlane& plane);
  /// Before predict: what stands at the end of the step.
  Openings& openings() { return *openings_; }
  const Openings* openings_if_any() const {
    return openings_ && openings_->count() > 0 ? openings_.get() : nullptr;
  }
  /// Flow out of the fluid through an opening, mm3/s.
  double opening_flow(int opening) const { return openings_->outflow(opening, velocity_); }
  /// Of the pressure in the last step; 0 with the direct solver.
  int pressure_iterations() const { return krylov_ ? krylov_->iterations() : 0; }
  /// Cells whose pressure is solved for.
  double pressure_unknowns() const {
    return krylov_ ? krylov_->unknowns() : static_cast<double>(slab_.grid.all_cells());
  }

  void predict(double dt, const PredictOptions& options = {});
  /// u += dt/rho * force density, between predict and project.
  void add_impulse(const FaceField& force, double dt);
  void penalise(double dt);
  /// What solids and incompressibility leave of a velocity: zero at solid faces, then free of divergence with
  /// no pressure at open ends and no flow through inflow sides; where the pressure is solved by
  /// iterations (krylov) solid faces alone. Owned faces only. Not between predict and project; not of fourth
  /// order. within: the velocity is zero in all other planes (of all ranks), and stays so here.
  void constrain(FaceField& velocity, Planes within = {});
  /// NumericalFailure (on all ranks) that names the cell when the new velocity is not finite.
  StepReport project(double dt);
  StepReport step(double dt) {
    predict(dt);
    return project(dt);
  }

  /// One Runge-Kutta step with force() and end pressures as they are. It keeps no history for AB2, and cannot
  /// be taken back.
  /// before_stage(part): called before each stage with the part of the step at which it ends, to prescribe
  /// what stands there.
  StepReport step_rk3(double dt, const std::function<void(double part)>& before_stage = {});

  /// Directly after project(): takes the step back. Velocity and pressure are exactly what they were before;
  /// the step history is forgotten, so that the next step is a first one.
  void undo();

  /// Flow out of the box through a side, mm3/s.
  double outflow(int axis, int side) const;
  /// Flow along +z through the face plane k (0..nz of the whole grid), inside the lumen, mm3/s.
  double flow_through(int plane) const;
  double flow_through(End end) const { return flow_through(end == End::low ? 0 : grid().cells[2]); }
  /// Open (not solid) area of a face plane, mm2.
  double open_area(int plane) const;
  /// Mean pressure over the lumen's cells of plane k (0..nz-1), Pa.
  double mean_pressure(int plane) const;
  /// Conjugate-gradient iterations of the last step; 0 with explicit viscosity.
  int viscous_iterations() const { return implicit_viscosity_ ? implicit_viscosity_->iterations() : 0; }
  /// Where viscosity is not constant: what is added to it, mm2/s (viscosity.hpp); otherwise null.
  const ExtraViscosity* extra_viscosity() const { return extra_viscosity_.get(); }
  /// The face plane nearest to z.
  int plane_at(double z) const;
  double kinetic_energy() const;          ///< nanojoule
  double divergence() const;              ///< max |div u| over all cells, 1/s
  Vec3 momentum() const;                  ///< g mm/s
  Vec3 velocity_at(const Vec3& x) const;  ///< trilinear, mm/s; the same on all ranks
  double pressure_at(const Vec3& x);      ///< trilinear, Pa
  /// At many points, which periodic sides repeat; velocity quadratic between faces, pressure trilinear
  /// between cells.
  std::vector<Vec3> velocity_at(const Points& points) const;
  std::vector<double> pressure_at(const Points& points);

  /// Traction of the fluid along a wall through x, Pa: tangential part of mu times the slope at the wall of
  /// the parabola through the velocities at a, 2a and 3a = 4.5 h along the normal (towards the fluid). The
  /// wall's own velocity does not enter: the error of the interpolated wall is, next to it, a constant of
  /// second order. The constant viscosity counts.
  Vec3 wall_shear_stress(const Vec3& x, const Vec3& normal) const;
  std::vector<Vec3> wall_shear_stress(const std::vector<WallPoint>& walls) const;

  /// Everything the continuation needs, below "fluid/", complete on rank 0 and empty elsewhere; the same for
  /// any number of ranks. Body masks and inflow shapes are the caller's, who sets them before load().
  std::map<std::string, state::Array> save() const;
  /// From the full arrays on every rank. InputError when shapes differ from the grid.
  void load(const state::State& state);
  /// Velocity (mm/s) and pressure (mmHg) at cell centres, on rank 0: what views show.
  state::Image image() const;

 private:
  bool has_side(int axis, int side) const {
    return axis < 2 || (side == 0 ? slab_.is_lowest() : slab_.is_highest());
  }
  bool solid_at_side(int axis, int side, int a, int b) const;
  void apply_inflow(FaceField& velocity) const;
  void advance(Advance step, const PredictOptions& options);
  void fill_phi_ghosts(Field& pressure, const std::array<double, 2>& end_pressure);
  // Fluid cells alone: flow_cells.cpp.
  void prepare_cells();
  void list_cells();
  StepReport project_cells(double dt);
  StepReport correct_cells(double dt);
  double largest_predicted() const;
  void extend_pressure();
  // Answers to known pressures: flow_response.cpp.
  const Field& unit_pressure(const PressurePlace& place);
  void gather_rises(const std::vector<PressureRise>& rises);
  double raised_at(int k) const;
  StepReport measure(double dt) const;
  void fill_source_fourth_order(int k, double per_dt, const CellRows& b) const;
  StepReport correct_fourth_order(double dt);
  /// The low faces of a cell of the local plane k.
  std::array<const double*, 3> faces_of(int place, int k) const;
  enum class Given { velocity, nothing };  ///< through inflow sides
  void fill_source(int k, double per_dt, Given through, const CellRows& b);
  StepReport correct(double dt);
  StepReport report_of(double dt, const RowMotion& motion) const;
  [[noreturn]] void report_not_finite() const;
  // The part of this rank: the value where it holds the point, 0 elsewhere.
  double sample(const Field& field, int d, const Vec3& x) const;
  double sample_quadratic(int d, const Vec3& x) const;
  Vec3 wrapped(const Vec3& x) const;

  Slab slab_;
  Boundaries boundaries_;
  FlowParameters parameters_;
  Solids solids_;
  Momentum momentum_;
  std::unique_ptr<PressureSolver> poisson_;
  KrylovPressure* krylov_ = nullptr;  ///< poisson_, where it is that
  std::unique_ptr<Openings> openings_;
  long cells_of_version_ = -1;  ///< of the solids
  struct Run {                  // side by side in x
    std::ptrdiff_t first;
    int count;
  };
  struct Shell {  // a cell without pressure beside the fluid, and the cells whose mean it shows
    std::ptrdiff_t cell;
    std::vector<std::ptrdiff_t> from;
  };
  std::array<std::vector<Run>, 3> fluid_faces_;  ///< without those of openings
  std::vector<Run> fluid_cells_;
  std::vector<Shell> shell_;
  std::unique_ptr<ImplicitViscosity> implicit_viscosity_;
  std::unique_ptr<ExtraViscosity> extra_viscosity_;  ///< none: the viscosity is constant
  std::unique_ptr<WallUpwind> wall_upwind_;
  FaceField velocity_, next_, rate_;
  std::optional<FaceField> force_;
  Field pressure_, correction_;
  std::array<double, 2> end_pressure_{};
  std::function<StepReport(double dt, const StepReport& found)> after_projection_;
  std::map<PressurePlace, Field> unit_pressure_;  ///< krylov: 1 at the place, 0 at the others
  std::array<double, 2> raised_end_{};            ///< of raise and add_response: at the ends,
  std::vector<double> raised_opening_;            ///< at the openings,
  std::optional<Field> raised_;                   ///< and in the cells (krylov)
  double previous_dt_ = 0;                        ///< 0: no history
  bool keep_pressure_ = true;                     ///< of the running step: incremental
};

}  // namespace valsalva::fluid
