#include "flow_scene.hpp"

#include <omp.h>

#include <cmath>
#include <optional>

#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/progress.hpp"
#include "core/provenance.hpp"
#include "dry_state.hpp"
#include "flow_scene/scene.hpp"
#include "state/checkpoint.hpp"

namespace valsalva::cycle {

namespace {

using flow_scene::FlowScene;

constexpr long steps_between_copies = 200;

state::State state_of(const StageContext& context, const FlowScene& scene) {
  state::State out = state::begin(context, scene.time_s(), scene.steps());
  out.restart = scene.save();
  out.images["fluid"] = scene.image();
  if (scene.bodies()) add_bodies(out, scene.bodies()->scene());
  out.final = scene.finished();
  return out;
}

void write_tables(const StageContext& context, FlowScene& scene) {
  const auto profiles = scene.profiles();  // collective
  if (mpi::rank(context.comm) != 0) return;
  scene.history().write(context.run.file("history.csv"));
  for (const auto& [name, text] : profiles) write_atomically(context.run.file(name), text);
}

void save(const StageContext& context, FlowScene& scene) {
  state::save(context, state_of(context, scene));
  write_tables(context, scene);
}

void record_files(StageContext& context) {
  const auto record = [&](const Case& entry, const std::string& key) {
    if (entry.text(key).empty()) return;
    const auto path = context.scene.resolve(entry.text(key));
    context.summary.inputs[path.string()] = sha256_of_path(path);
  };
  for (const Case& entry : context.scene.entries("obstacle")) record(entry, "obstacle.file");
  for (const Case& entry : context.scene.entries("boundary")) record(entry, "boundary.factor_file");
  for (const Case& entry : context.scene.entries("opening")) record(entry, "opening.factor_file");
  for (const Case& entry : context.scene.entries("body"))
    if (entry.text("body.shape") == "file") record(entry, "body.file");
  for (const Case& entry : context.scene.entries("contact_pair")) record(entry, "contact_pair.file");
}

void say_bodies(const flow_scene::Bodies& bodies) {
  for (const assembly::BuiltBody& body : bodies.scene().bodies)
    log::info("body {}: {} nodes, {} triangles, {} beams, {} solid elements", body.name, body.at.count,
              body.mesh.triangles.size(), body.mesh.lines.size(), body.mesh.solids.size());
  const auto figures = bodies.metrics();
  log::info("coupling at {} points", figures.at("coupling_points"));
  if (const double rate = figures.at("coupling_tie_rate_per_s"); rate > 0)
    log::info("ties to masses beyond the fluid's: {:.3g} 1/s; motion slower than {:.3g} Hz is right to 1 %",
              rate, 0.1 * rate / (2 * M_PI));
}

/// Forces on an obstacle lag behind its motion by about a step and a half; nothing else shortens the steps
/// where the motion is slow against the grid.
void check_motion(Summary& summary, const flow_scene::Obstacles& obstacles) {
  constexpr double most = 0.05;
  const double change = obstacles.largest_change_of_velocity();
  summary.checks["obstacle_velocity_change_per_step"] = {change, most, change <= most};
  if (change > most)
    log::warn(
        "the velocity of an obstacle changes by {:.2g} of its largest in one step: forces on it are wrong by "
        "about as much; give a smaller fluid.step_s, or let it start less suddenly",
        change);
}

/// Of one core: forces, spreading and interpolation, and in one step of eight the search for its limit.
double body_seconds_a_step(const flow_scene::Bodies& bodies) {
  constexpr double triangle_s = 0.5e-6, solid_node_s = 1e-6, point_s = 0.6e-6, searches = 1.8;
  double evaluation_s = 0;
  for (const assembly::BuiltBody& body : bodies.scene().bodies) {
    evaluation_s += triangle_s * static_cast<double>(body.mesh.triangles.size() + body.mesh.lines.size());
    for (const assembly::SolidCell& cell : body.mesh.solids)
      evaluation_s += solid_node_s * static_cast<double>(cell.nodes.size());
  }
  return searches * (evaluation_s + point_s * bodies.metrics().at("coupling_points"));
}

}  // namespace

bool is_flow_scene(const Case& scene) {
  return flow_scene::has_box(scene);
}

void run_flow_scene(StageContext& context) {
  omp_set_num_threads(1);  // the ranks share the work
  FlowScene scene(context.scene, context.comm);
  const fluid::Grid& grid = scene.flow().grid();
  log::info("fluid: {} x {} x {} cells of {} mm", grid.cells[scene.frame().solver_axis(0)],
            grid.cells[scene.frame().solver_axis(1)], grid.cells[scene.frame().solver_axis(2)], grid.h);
  if (scene.bodies()) say_bodies(*scene.bodies());
  if (scene.given_step_s() > scene.stable_s())
    log::warn("fluid.step_s is {} s; fluid.cfl and the viscosity allow {:.3g} s: the run may become unstable",
              scene.given_step_s(), scene.stable_s());
  record_files(context);
  if (const auto before =
          state::resume(context, {"fluid.end_s", "fluid.history_rows", "fluid.average_from_s"})) {
    scene.load(*before);
    log::info("continued from step {} at t = {:.6g} s", scene.steps(), scene.time_s());
  } else {
    scene.add_row();
  }
  const long first = scene.steps();
  Progress progress("cycle", scene.end_s(), context.speaks);
  progress.start_at(scene.time_s());
  state::CheckpointClock clock(context);
  // Of a scene without bodies, which has no way back of its own, until there is a checkpoint in a file.
  std::optional<state::State> copy;
  bool copying = !scene.bodies(), stepping = false;
  try {
    while (!scene.finished() && !(context.steps && scene.steps() - first >= *context.steps)) {
      if (copying && (scene.steps() - first) % steps_between_copies == 0) copy = state_of(context, scene);
      stepping = true;
      scene.step();
      stepping = false;
      if (scene.row_due()) scene.add_row();
      progress.update(scene.time_s(),
                      fmt::format("t = {:.4g} s, dt = {:.3g} s", scene.time_s(), scene.step_s()));
      if (mpi::any(context.comm, interrupted())) {
        write_tables(context, scene);
        state::stop(context, state_of(context, scene));
      }
      if (clock.due(context.comm)) {
        save(context, scene);
        copying = false;
        copy.reset();
      }
    }
  } catch (const NumericalFailure& failure) {
    if (mpi::rank(context.comm) == 0) scene.history().write(context.run.file("history.csv"));
    const long step = scene.steps();
    const double time_s = scene.time_s();
    if (stepping && scene.bodies())
      state::save(context, state_of(context, scene));  // the rescue has gone back to it
    else if (copy)
      state::save(context, *copy);
    MPI_Barrier(context.comm);
    const auto last = context.run.latest_state();
    throw NumericalFailure(
        "{}. t = {:.6g} s, step {}. {}", failure.what(), time_s, step,
        last ? "The last good state is " + last->string() : std::string("No state was written before"));
  }
  context.summary.metrics = scene.metrics();
  context.summary.metrics["cells"] = static_cast<double>(grid.all_cells());
  context.summary.metrics["divergence_max_per_s"] = scene.flow().divergence();
  if (scene.obstacles().move()) check_motion(context.summary, scene.obstacles());
  context.summary.steps = scene.steps();
  context.summary.simulated_s = scene.time_s();
  save(context, scene);
}

void check_flow_scene(const Case& scene) {
  FlowScene built(scene, MPI_COMM_SELF);
  built.add_row();
}

Estimate estimate_flow_scene(const Case& scene, int ranks) {
  // Measured: a step of 0.06 microseconds a cell on one core (docs/decisions/fluid.md).
  FlowScene built(scene, MPI_COMM_SELF);
  built.step();
  const double cells = static_cast<double>(built.flow().grid().all_cells());
  const bool rk3 = scene.text("fluid.time_scheme") == "rk3";
  double step = built.given_step_s() > 0 ? built.given_step_s() : built.stable_s();
  double seconds_a_step = cells * 0.06e-6 * (rk3 ? 3 : 1) / (ranks > 1 ? 1.7 : 1.0);
  if (built.bodies()) {
    const auto figures = built.bodies()->metrics();
    if (const double critical = figures.at("coupling_critical_step_s"); critical > 0)
      step = std::min(step, scene.real("coupling.step_safety") * critical);
    seconds_a_step += body_seconds_a_step(*built.bodies());
  }
  const double steps = std::max(built.end_s() / step, double(scene.integer("fluid.history_rows")));
  return {
      steps * seconds_a_step, 100 + 2e-4 * cells,
      "second order in the open, first order at staircase walls (docs/verification/fluid.md) and at bodies "
      "(docs/verification/coupling.md); the step is that of the start, and shrinks where the flow gets "
      "faster "
      "or a body stiffer"};
}

}  // namespace valsalva::cycle
