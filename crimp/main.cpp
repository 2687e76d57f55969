// valsalva-crimp: closes the device into its sheath. The beam frame with its sewn leaflets and skirt is
// squeezed by a cylindrical crimper to its final diameter and rests there; explicit dynamics with contact of
// frame, tissue and crimper, without fluid. docs/crimp.md.
//
//   valsalva-crimp CASE.toml
//   valsalva-crimp CASE.toml --set crimp.diameter_mm=6 --from runs/demo/stent/state_000000.h5
//   valsalva-crimp CASE.toml --resume
#include <cmath>

#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/progress.hpp"
#include "output.hpp"
#include "scene/scene.hpp"
#include "structure/threads.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::crimp;

void run(StageContext& context) {
  const Parameters p = read_parameters(context.scene);
  const state::State stent = state::read_final(context.parent_state("stent"), "stent");
  Simulation simulation(read_device(stent, p), p);
  History history = make_history();
  if (const auto resumed = state::resume(context)) restore(*resumed, simulation, history);

  const structure::Integrator& integrator = simulation.integrator();
  const auto& mesh = simulation.body_contact().candidates().mesh();
  log::info("crimp: {} nodes, {} beams, {} triangles; {:.2f} -> {:.2f} mm in {:.1f} ms, step {:.2g} us",
            simulation.system().nodes(), simulation.device().frame->elements(), mesh.faces().size(),
            2 * simulation.crimper().radius_mm(0), p.target_diameter_mm,
            1e3 * simulation.crimper().duration_s(), 1e6 * p.step_s);
  Progress progress("crimp", simulation.longest_s(), context.speaks);
  progress.start_at(simulation.system().state.time_s);
  state::CheckpointClock clock(context);
  const long first = integrator.steps();
  bool stopped = false;
  while (!simulation.done() && !stopped) {
    try {
      simulation.step();
    } catch (const NumericalFailure& failure) {
      if (mpi::rank(context.comm) == 0) history.write(context.run.file("history.csv"));
      const auto good = context.run.latest_state();
      throw NumericalFailure("{}; the last good state is {}", failure.what(),
                             good ? good->string() : "stent's, " + stent.source);
    }
    if (integrator.steps() % p.history_interval == 0) record(history, simulation);
    if (clock.due(context.comm)) state::save(context, snapshot(context, stent, simulation, history));
    if (interrupted()) state::stop(context, snapshot(context, stent, simulation, history));
    stopped = context.steps && integrator.steps() - first >= *context.steps;
    progress.update(simulation.system().state.time_s,
                    fmt::format("{:.2f} mm, {:.1f} N", 2 * simulation.crimper_radius_mm(),
                                history.rows() ? history.at(history.rows() - 1, "radial_force_N") : 0.0));
  }
  const bool recorded =
      history.rows() > 0 && history.at(history.rows() - 1, "time_s") == simulation.system().state.time_s;
  if (simulation.done() && !recorded) record(history, simulation);
  if (mpi::rank(context.comm) == 0) history.write(context.run.file("history.csv"));
  context.summary.steps = integrator.steps();
  context.summary.simulated_s = simulation.system().state.time_s;
  fill_summary(context.summary, simulation, history, p);
  state::State last = snapshot(context, stent, simulation, history);
  last.final = simulation.done();
  state::save(context, last);
}

void check(const Case& scene) {
  if (!scene.has("device"))
    throw InputError("{}: the scene has no [device] table; there is nothing to crimp", scene.file().string());
  if (scene.real("contact.wide_skin_mm") <= scene.real("contact.near_skin_mm"))
    throw InputError("{}: contact.wide_skin_mm = {} must exceed contact.near_skin_mm = {}",
                     scene.file().string(), scene.real("contact.wide_skin_mm"),
                     scene.real("contact.near_skin_mm"));
}

/// Steps times the time of one, which grows with the number of triangles (measured at draft, docs/crimp.md).
Estimate estimate(const Case& scene, int) {
  const Parameters p = read_parameters(scene);
  const double way_mm = 13.5;  // of the library's 26 mm device
  const double steps = (way_mm / p.speed_mm_per_s + p.ramp_s + 0.5 * p.settle_s) / p.step_s;
  const double leaflet = scene.real("device.leaflet_edge_mm"), skirt = scene.real("device.skirt_edge_mm");
  const double triangles =
      scene.boolean("device.tissue") ? 2400 / (leaflet * leaflet) + 3000 / (skirt * skirt) : 0;
  return {
      steps * (2e-4 + 7e-7 * triangles), 60 + 0.02 * triangles,
      "crimped diameter within 0.05 mm of the crimper's (contact overlap); radial force: elastic frame, for "
      "comparisons only"};
}

}  // namespace

int main(int argc, char** argv) {
  valsalva::structure::wait_passively(argv);
  return stage_main(argc, argv,
                    {"crimp",
                     "Closes the device into its sheath: explicit dynamics with contact",
                     "valsalva-crimp CASE.toml --set crimp.diameter_mm=5.7",
                     declare_all,
                     {"case", "device", "crimp", "contact"},
                     run,
                     estimate,
                     check});
}
