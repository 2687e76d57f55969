#include "dry.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "assembly/march.hpp"
#include "assembly/prestress.hpp"
#include "assembly/probes.hpp"
#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/progress.hpp"
#include "core/provenance.hpp"
#include "core/units.hpp"
#include "dry_state.hpp"
#include "state/checkpoint.hpp"

namespace valsalva::cycle {
namespace {

using assembly::Scene;

void refuse_what_needs_fluid(const Case& scene) {
  for (const Case& body : scene.entries("body"))
    if (!body.texts("body.start_displacement").empty())
      throw InputError("{}: [[body]] '{}': start_displacement is for scenes with fluid.box_mm",
                       scene.file().string(), body.text("body.name"));
}

/// Below this many nodes threads cost more than they bring.
constexpr std::size_t small_scene = 5000;

History new_history(const assembly::Probes& probes) {
  std::vector<std::string> columns{"time_s", "kinetic_nJ", "stored_nJ"};
  columns.insert(columns.end(), probes.columns().begin(), probes.columns().end());
  return History(columns);
}

class DryRun {
 public:
  explicit DryRun(StageContext& context)
      : context_(context),
        threads_(omp_get_max_threads()),
        before_(state::resume(context)),
        prestress_(prestress()),
        scene_(assembly::compose(context.scene, prestress_.reference)),
        probes_(context.scene, scene_),
        march_(assembly::make_march(context.scene, scene_)),
        history_(new_history(probes_)),
        view_times_(context.scene.reals("output.view_times_s")) {
    std::sort(view_times_.begin(), view_times_.end());
  }

  void go() {
    if (scene_.system->nodes() >= small_scene) omp_set_num_threads(threads_);
    say_scene();
    record_inputs();
    if (before_)
      load(*before_);
    else
      begin();
    good_ = march_->save();
    const long first = march_->steps();
    Progress progress("cycle", scene_.end_s, context_.speaks);
    progress.start_at(time_s());
    state::CheckpointClock clock(context_);
    try {
      while (!march_->finished() && !(context_.steps && march_->steps() - first >= *context_.steps)) {
        march_->step();
        if (march_->row_due()) {
          add_row();
          good_ = march_->save();
          keep_views();
        }
        progress.update(time_s(), fmt::format("t = {:.4g} s, kinetic {:.3g} nJ, stored {:.3g} nJ", time_s(),
                                              march_->kinetic_nJ(), march_->stored_nJ()));
        if (mpi::any(context_.comm, interrupted())) {
          write_history();
          state::stop(context_, now());
        }
        if (clock.due(context_.comm)) save();
      }
    } catch (const NumericalFailure& failure) {
      march_->restore(good_);
      save();
      throw NumericalFailure("{}. The last good state is {}", failure.what(),
                             context_.run.state_path(march_->steps()).string());
    }
    summarise();
    save();
  }

 private:
  /// The stress-free shapes: found, or those of the state that is continued.
  assembly::Prestress prestress() const {
    omp_set_num_threads(1);
    assembly::Prestress p;
    if (!assembly::wants_prestress(context_.scene)) return p;
    if (!before_)
      return assembly::find_stress_free(context_.scene, [](int iteration, double error_mm) {
        log::info("prestress, equilibrium {}: {:.3g} mm from the given shape", iteration, error_mm);
      });
    for (const auto& [name, mesh] : before_->meshes)
      p.reference[name] = before_->point_data(name, "reference").points(name);
    p.iterations = static_cast<int>(before_->array("prestress").doubles("prestress").at(0));
    p.error_mm = before_->array("prestress").doubles("prestress").at(1);
    return p;
  }

  double time_s() const { return scene_.system->state.time_s; }

  void begin() {
    state::drop_kept(context_);
    if (!prestress_.equilibrium.empty()) march_->start_from(prestress_.equilibrium, prestress_.stored_nJ);
    add_row();
    keep_views();
  }

  /// When one of the times has been reached.
  void keep_views() {
    const auto next = std::upper_bound(view_times_.begin(), view_times_.end(), time_s());
    if (next == view_times_.begin()) return;
    view_times_.erase(view_times_.begin(), next);
    state::keep(context_, now());
  }

  void say_scene() const {
    for (const assembly::BuiltBody& body : scene_.bodies)
      log::info("body {}: {} nodes, {} triangles, {} beams, {} solid elements", body.name, body.at.count,
                body.mesh.triangles.size(), body.mesh.lines.size(), body.mesh.solids.size());
    if (mpi::size(context_.comm) > 1)
      log::info("a scene without fluid works on one rank; the others repeat it");
  }

  void record_inputs() {
    for (const Case& body : context_.scene.entries("body"))
      if (body.text("body.shape") == "file") {
        const auto path = context_.scene.resolve(body.text("body.file"));
        context_.summary.inputs[path.string()] = sha256_of_path(path);
      }
  }

  void add_row() {
    std::vector<double> row{time_s(), march_->kinetic_nJ(), march_->stored_nJ()};
    const std::vector<double> measured = probes_.values(scene_, march_->kinetic_nJ());
    row.insert(row.end(), measured.begin(), measured.end());
    for (std::size_t i = 0; i < row.size(); ++i)
      if (!std::isfinite(row[i]))
        throw NumericalFailure("'{}' is not finite at {} s; reduce the step or the load",
                               history_.columns()[i], time_s());
    history_.add(row);
  }

  state::State now() const {
    state::State s = state::begin(context_, time_s(), march_->steps());
    s.final = march_->finished();
    add_bodies(s, scene_);
    add_snapshot(s, march_->save());
    s.restart["history"] = state::Array::of(history_.values());
    s.restart["prestress"] =
        state::Array::of(std::vector<double>{double(prestress_.iterations), prestress_.error_mm});
    return s;
  }

  void load(const state::State& s) {
    march_->restore(snapshot_of(s));
    history_.restore(s.array("history").doubles("history"));
    // What was reached before has been kept.
    view_times_.erase(view_times_.begin(),
                      std::upper_bound(view_times_.begin(), view_times_.end(), time_s()));
    log::info("continued from step {} at t = {:.6g} s", march_->steps(), time_s());
  }

  void write_history() const {
    if (mpi::rank(context_.comm) == 0) history_.write(context_.run.file("history.csv"));
  }
  void save() {
    state::save(context_, now());
    write_history();
    context_.summary.steps = march_->steps();
    context_.summary.simulated_s = time_s();
  }

  void summarise() {
    auto& m = context_.summary.metrics;
    for (const std::string& column : probes_.columns()) m[column] = history_.at(history_.rows() - 1, column);
    for (const auto& [name, value] : march_->metrics()) m["solver_" + name] = value;
    if (assembly::wants_prestress(context_.scene)) {
      m["prestress_iterations"] = prestress_.iterations;
      m["prestress_error_mm"] = assembly::loaded_at_the_end(context_.scene)
                                    ? assembly::distance_from_given(scene_)
                                    : prestress_.error_mm;
    }
    m["kinetic_nJ"] = march_->kinetic_nJ();
    m["stored_nJ"] = march_->stored_nJ();
    double nodes = 0, elements = 0, exponent = 0;
    for (const assembly::BuiltBody& body : scene_.bodies) {
      exponent = std::max(exponent, assembly::element_field(body, scene_.system->state).exponent);
      nodes += body.at.count;
      elements +=
          static_cast<double>(body.mesh.triangles.size() + body.mesh.lines.size() + body.mesh.solids.size());
    }
    m["nodes"] = nodes;
    m["elements"] = elements;
    m["largest_law_exponent"] = exponent;
    if (exponent > 6)
      context_.summary.notes["tissue law"] =
          "the exponential was continued by its Taylor polynomial beyond 6 somewhere: strains there are "
          "bounds, stresses too low";
    context_.summary.notes["solver"] = context_.scene.text("dynamics.solver");
  }

  StageContext& context_;
  int threads_;
  std::optional<state::State> before_;  // what is continued
  assembly::Prestress prestress_;
  Scene scene_;
  assembly::Probes probes_;
  std::unique_ptr<assembly::March> march_;
  History history_;
  std::vector<double> view_times_;  // those still to come
  structure::Snapshot good_;
};

}  // namespace

bool is_dry(const Case& scene) {
  if (scene.has("fluid") && scene.has("body"))
    throw InputError(
        "{}: the scene has [fluid] and [[body]]; expected fluid.box_mm for bodies in a box of fluid, or no "
        "[fluid]",
        scene.file().string());
  if (scene.has("body")) refuse_what_needs_fluid(scene);
  return scene.has("body");
}

void run_dry(StageContext& context) {
  DryRun run(context);
  run.go();
}

void check_dry(const Case& scene) {
  assembly::wants_prestress(scene);
  assembly::Scene built = assembly::compose(scene);
  const assembly::Probes probes(scene, built);
  assembly::make_march(scene, built);
}

Estimate estimate_dry(const Case& scene) {
  // Measured on one core, docs/scenes.md.
  const assembly::Scene built = assembly::compose(scene);
  double elements = 0, points = 0;
  for (const assembly::BuiltBody& body : built.bodies) {
    elements += static_cast<double>(body.mesh.triangles.size() + body.mesh.lines.size());
    for (const assembly::SolidCell& cell : body.mesh.solids) points += static_cast<double>(cell.nodes.size());
  }
  const double evaluation_s = 0.5e-6 * elements + 1e-6 * points;
  const std::string& solver = scene.text("dynamics.solver");
  const double end_s = scene.real("dynamics.end_s"), given = scene.real("dynamics.step_s");
  const double steps = static_cast<double>(scene.integer("dynamics.load_steps"));
  const double most = given > 0 ? given : 1e-3 * end_s;
  double evaluations = 360 * steps;  // a Newton iteration costs about 60 of them, and there are about 6
  if (solver == "explicit") {
    const double stable = scene.real("dynamics.safety") * assembly::stable_step_s(built);
    const bool raised =
        scene.boolean("dynamics.mass_scaling") && given > 0;  // the step is kept, masses follow
    evaluations = end_s / (raised ? given : std::min(most, stable));
  }
  if (solver == "quasi_static") evaluations = 3e4 * steps;
  if (solver == "implicit") evaluations = 360 * end_s / (given > 0 ? given : 0.01 * end_s);
  if (assembly::wants_prestress(scene)) evaluations *= 10;
  return {evaluations * evaluation_s, 100 + 0.01 * elements + 0.02 * points,
          "by element and mesh: docs/verification/shells.md, docs/verification/solids.md, docs/structure.md"};
}

}  // namespace valsalva::cycle
