// valsalva-cycle: the valve beats. Blood on a staggered grid, the leaflets as immersed shells, the left heart
// and the arteries as 0D models at the two ends. Parent: deploy, or mesher where the scene has no device.
// A valve in a [test_section] (test_section.hpp) needs no parent.
// A scene of [[body]] entries without [fluid] (dry.hpp), or of fluid in a box (flow_scene.hpp), is advanced
// alone, without a parent.
//
//   valsalva-cycle CASE.toml
//   mpirun -np 2 valsalva-cycle CASE.toml --fidelity standard
//   valsalva-cycle CASE.toml --resume
//   valsalva-cycle CASE.toml --set circulation.upstream=flow --set cycle.kernel=cbs43
#include <omp.h>

#include <cmath>

#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/progress.hpp"
#include "core/stage.hpp"
#include "core/units.hpp"
#include "dry.hpp"
#include "flow_scene.hpp"
#include "measured.hpp"
#include "results.hpp"
#include "scene/scene.hpp"
#include "state/checkpoint.hpp"
#include "structure/threads.hpp"
#include "test_section.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::cycle;

void write_history(const StageContext& context, const Simulation& simulation) {
  if (mpi::rank(context.comm) == 0) simulation.recorder().history().write(context.run.file("history.csv"));
}

void save(const StageContext& context, const Inputs& in, const Simulation& simulation, bool final) {
  state::save(context, state_of(context, in, simulation, final));
  write_history(context, simulation);
}

void say_scene(const Inputs& in, const Parameters& p, const Simulation& simulation) {
  const fluid::Grid& grid = simulation.flow().grid();
  log::info("fluid: {} x {} x {} cells of {} mm, z from {:.1f} to {:.1f} mm", grid.cells[0], grid.cells[1],
            grid.cells[2], grid.h, grid.low().z(), grid.high().z());
  if (in.leaflets) {
    log::info("{}: {} nodes, {} triangles, mean edge {:.3f} mm", in.leaflets->name,
              in.leaflets->points.size(), in.leaflets->mesh.triangles.size(), in.leaflets->mean_edge_mm);
    if (in.leaflets->mean_edge_mm > 0.55 * p.h)
      log::warn(
          "the leaflets' edges are longer than half a cell: the closed valve will leak; use a finer "
          "device.leaflet_edge_mm or mesh.leaflet_edge_mm");
  }
  if (in.skirt) log::info("gap between skirt and wall: {:.1f} mm2", simulation.recorder().gap_area_mm2());
}

Expectation expectation_of(const Case& scene, const Parameters& p, int ranks) {
  Expectation expected = expect(measured_beats(), kind_of_valve(scene), p.h, p.end_s, ranks);
  if (has_test_section(scene)) expected.basis += "; of valves in a test section none was measured";
  return expected;
}

/// The band of every figure of the beat that has one: where the value at h = 0 is likely to lie.
void state_accuracy(const StageContext& context, Summary& s, const Parameters& p) {
  const Expectation expected = expectation_of(context.scene, p, s.ranks);
  for (const auto& [figure, error] : expected.error_pct) {
    const auto found = s.metrics.find(figure);
    if (found == s.metrics.end()) continue;
    const double value = found->second, reach = 0.01 * error * std::abs(value);
    s.extra["accuracy"][figure] = fmt::format("{:.4g}, likely {:.3g} to {:.3g} ({:.2g} % either way)", value,
                                              value - reach, value + reach, error);
  }
  if (s.extra.contains("accuracy")) s.extra["accuracy"]["basis"] = expected.basis;
}

void run(StageContext& context) {
  if (is_flow_scene(context.scene)) return run_flow_scene(context);
  if (!has_test_section(context.scene) && is_dry(context.scene)) return run_dry(context);
  omp_set_num_threads(1);  // the ranks share the work; results do not depend on it
  const Parameters p = read_parameters(context.scene);
  const Inputs in = has_test_section(context.scene)
                        ? test_section_inputs(context.scene, p)
                        : read_inputs(context.parent_state(p.device ? "deploy" : "mesher"), p);
  Simulation simulation(context.comm, in, p);
  say_scene(in, p, simulation);
  if (const auto before = state::resume(context, {"cycle.beats", "cycle.duration_s"})) {
    simulation.load(*before);
    log::info("continued from step {} at t = {:.6f} s", simulation.steps(), simulation.time_s());
  }
  const long first = simulation.steps();
  Progress progress("cycle", p.end_s, context.speaks);
  progress.start_at(simulation.time_s());
  state::CheckpointClock clock(context);
  try {
    while (!simulation.finished() && !(context.steps && simulation.steps() - first >= *context.steps)) {
      simulation.step();
      progress.update(simulation.time_s(), fmt::format("t = {:.4f} s, dt = {:.1f} us", simulation.time_s(),
                                                       1e6 * simulation.last_step().dt_s));
      if (mpi::any(context.comm, interrupted())) {
        write_history(context, simulation);
        state::stop(context, state_of(context, in, simulation, false));
      }
      if (clock.due(context.comm)) save(context, in, simulation, false);
    }
  } catch (const NumericalFailure& failure) {
    save(context, in, simulation, false);
    throw NumericalFailure("{}. The last good state is {}", failure.what(),
                           context.run.state_path(simulation.steps()).string());
  }
  summarise(context.summary, in, p, simulation);
  state_accuracy(context, context.summary, p);
  save(context, in, simulation, simulation.finished());
}

Estimate estimate(const Case& scene, int ranks) {
  if (is_flow_scene(scene)) return estimate_flow_scene(scene, ranks);
  if (!has_test_section(scene) && is_dry(scene)) return estimate_dry(scene);
  const Parameters p = read_parameters(scene);
  const Expectation expected = expectation_of(scene, p, ranks);
  return {expected.wall_s, expected.memory_MiB, in_words(expected)};
}

void check(const Case& scene) {
  if (is_flow_scene(scene)) return check_flow_scene(scene);
  if (!has_test_section(scene) && is_dry(scene)) return check_dry(scene);
  const Parameters p = read_parameters(scene);
  if (!scene.has("fluid"))
    throw InputError(
        "{}: cycle needs a [fluid] table (an empty one takes the defaults), or [[body]] entries for a scene "
        "without fluid",
        scene.file().string());
  if (p.end_s <= 0)
    throw InputError("{}: nothing to simulate: cycle.duration_s is {} s", scene.file().string(), p.end_s);
  if (has_test_section(scene)) test_section_inputs(scene, p);
}

}  // namespace

int main(int argc, char** argv) {
  valsalva::structure::wait_passively(argv);
  return valsalva::stage_main(argc, argv,
                              {"cycle",
                               "The valve beats: blood, leaflets, heart and arteries",
                               "mpirun -np 2 valsalva-cycle CASE.toml --fidelity standard",
                               valsalva::declare_all,
                               {"cycle", "fluid", "circulation", "device", "native", "body", "nodes",
                                "support", "load", "tie", "contact_pair", "contact", "dynamics", "probe",
                                "coupling", "boundary", "obstacle", "flow_probe", "test_section"},
                               run,
                               estimate,
                               check});
}
