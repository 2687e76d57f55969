// valsalva-deploy: places the crimped device in the anatomy, opens the native leaflets, releases the device
// and lets it settle against wall and native leaflets.
//
//   valsalva-deploy CASE.toml
//   valsalva-deploy CASE.toml --set deploy.depth_mm=4 --set deploy.release=sheath
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/progress.hpp"
#include "core/stage.hpp"
#include "core/units.hpp"
#include "output.hpp"
#include "scene/scene.hpp"
#include "state/checkpoint.hpp"
#include "state/parents.hpp"
#include "structure/threads.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::deploy;

constexpr long history_interval = 100;

History new_history() {
  return History({"time_s", "act", "kinetic_nJ", "stored_nJ", "kinetic_to_internal", "mass_ratio", "depth_mm",
                  "inflow_diameter_mm", "wall_penetration_mm", "hold_force_N"});
}

/// Runs the two acts from a fresh start or from a state; knows how to write one.
class Run {
 public:
  Run(StageContext& context, Inputs in, const Parameters& p)
      : context_(context),
        in_(std::move(in)),
        p_(p),
        placement_(place(in_, p)),
        when_(schedule(in_, placement_, p)),
        history_(new_history()) {
    if (placement_.tilt_deg > 0.01)
      context_.summary.notes["placement"] =
          fmt::format("the device's axis is tilted by {:.1f} degrees to clear the wall", placement_.tilt_deg);
    apply(placement_, in_);
  }

  /// Returns false when --steps ended the run early.
  bool go() {
    start();
    Progress progress("deploy", when_.end_s, context_.speaks);
    progress.start_at(simulation_->time_s());
    state::CheckpointClock clock(context_);
    while (true) {
      if (act_ == Act::opening && simulation_->time_s() > when_.opened_s - 0.5 * p_.step_s)
        open_to_expansion();
      if (act_ == Act::expansion && simulation_->time_s() > when_.end_s - 0.5 * p_.step_s) return true;
      advance();
      if (step_ % history_interval == 0) record(progress);
      if (clock.due(context_.comm)) state::save(context_, now());
      if (interrupted()) state::stop(context_, now());
      if (context_.steps && step_ - first_step_ >= *context_.steps) {
        state::save(context_, now());
        return false;
      }
    }
  }

  void finish() {
    const Measures m = measure(*simulation_, in_, p_);
    state::State last = now();
    last.final = true;
    add_results(last, m, placement_);
    state::save(context_, last);
    history_.write(context_.run.file("history.csv"));
    summarise(m);
  }

 private:
  void start() {
    if (const auto state = state::resume(context_)) {
      const Restored r = restored_from(*state, history_);
      act_ = r.act;
      step_ = r.step;
      largest_ratio_ = r.largest_ratio;
      make(in_.native ? in_.native->points : Points{});
      simulation_->integrator().restore(r.snapshot);
    } else {
      act_ = in_.native ? Act::opening : Act::expansion;
      make({});
    }
    first_step_ = step_;
  }

  void make(const Points& native_now) {
    simulation_ = std::make_unique<Simulation>(act_ == Act::opening
                                                   ? Simulation::opening(in_, placement_, p_)
                                                   : Simulation::expansion(in_, placement_, p_, native_now));
  }

  void open_to_expansion() {
    const double overlap = simulation_->dilator_penetration_mm();
    if (overlap > 0.3)
      throw NumericalFailure(
          "deploy: the native leaflets reach {:.2f} mm into the space of the crimped device (radius "
          "{:.2f} mm) after {:.3g} s; raise deploy.open_pressure_mmHg or deploy.open_hold_ms",
          overlap - 0.3, placement_.radius_mm, simulation_->time_s());
    const Points opened = simulation_->points(in_.native->name);
    act_ = Act::expansion;
    make(opened);
  }

  void advance() {
    try {
      simulation_->step();
    } catch (const NumericalFailure& failure) {
      throw NumericalFailure("{}; the last checkpoint, if any, is in {}", failure.what(),
                             context_.run.path().string());
    }
    ++step_;
    context_.summary.steps = step_;
    context_.summary.simulated_s = simulation_->time_s();
    // At rest and just after release there is nothing to compare with; both are measured against what is
    // stored.
    if (act_ == Act::expansion)
      largest_ratio_ = std::max(largest_ratio_, simulation_->integrator().energies().ratio());
  }

  void record(Progress& progress) {
    const structure::Energies& e = simulation_->integrator().energies();
    const bool device = act_ == Act::expansion;
    const double depth = device ? depth_now(*simulation_, in_) : p_.depth_mm;
    const double diameter = device ? inflow_diameter_now(*simulation_, in_) : 2 * placement_.radius_mm;
    history_.add({simulation_->time_s(), static_cast<double>(act_), e.kinetic, e.stored, e.ratio(),
                  simulation_->integrator().mass_ratio(), depth, diameter, simulation_->wall_penetration_mm(),
                  simulation_->hold_force_uN() / units::uN_per_N});
    progress.update(simulation_->time_s(),
                    device ? fmt::format("inflow {:.1f} mm, depth {:.1f} mm, kinetic/internal {:.2g}",
                                         diameter, depth, e.ratio())
                           : std::string("opening the native leaflets"));
  }

  state::State now() const {
    return snapshot(context_, *simulation_, in_, act_, step_, history_, largest_ratio_);
  }

  void summarise(const Measures& m) {
    Summary& s = context_.summary;
    s.metrics["implant_depth_mm"] = m.implant_depth_mm;
    s.metrics["eccentricity"] = m.eccentricity;
    s.metrics["expanded_diameter_annulus_mm"] = m.expanded_diameter_annulus_mm;
    s.metrics["apposition_gap_area_mm2"] = m.apposition_gap_area_mm2;
    s.metrics["contact_area_mm2"] = m.contact_area_mm2;
    s.metrics["chronic_outward_force_N"] = m.chronic_outward_force_N;
    s.metrics["max_penetration_mm"] = m.max_penetration_mm;
    s.metrics["max_wall_stress_kPa"] = m.max_wall_stress_kPa;
    s.metrics["kinetic_to_internal_energy_max"] = largest_ratio_;
    const structure::Energies& e = simulation_->integrator().energies();
    s.metrics["kinetic_to_internal_energy_end"] = e.ratio();
    s.metrics["max_strut_strain_pct"] = 100 * m.max_frame_strain;
    s.metrics["max_leaflet_stretch"] = m.max_leaflet_stretch;
    s.metrics["max_law_exponent"] = m.max_exponent;
    s.metrics["mass_scaling_ratio"] = simulation_->integrator().mass_ratio();
    s.checks["implant_depth_above_4_mm"] = {m.implant_depth_mm, p_.depth_mm - 1,
                                            m.implant_depth_mm >= p_.depth_mm - 1};
    s.checks["implant_depth_below_6_mm"] = {m.implant_depth_mm, p_.depth_mm + 1,
                                            m.implant_depth_mm <= p_.depth_mm + 1};
    s.checks["penetration"] = {m.max_penetration_mm, p_.penetration_tolerance,
                               m.max_penetration_mm <= p_.penetration_tolerance};
    s.checks["bodies_that_cross"] = {static_cast<double>(m.strut_crossings), 0, m.strut_crossings == 0};
    s.checks["kinetic_to_internal_energy_at_rest"] = {e.ratio(), 0.05, e.ratio() < 0.05};
    s.notes["max_wall_stress_kPa"] =
        "Laplace estimate from the radial contact force in bands of 2 mm; no local bending under struts";
    s.notes["wall"] = "rigid level set; elastic penalty in contact";
    s.notes["dynamics"] = fmt::format(
        "explicit with mass scaling (total mass x {:.0f}); release damping {} 1/s stands for the delivery "
        "system",
        simulation_->integrator().mass_ratio(), p_.release_damping);
    if (m.max_exponent > 6)
      s.notes["tissue law"] = fmt::format(
          "the exponential was continued by its Taylor polynomial somewhere (largest exponent {:.1f})",
          m.max_exponent);
  }

  StageContext& context_;
  Inputs in_;
  const Parameters p_;
  Placement placement_;
  Schedule when_;
  History history_;
  Act act_ = Act::opening;
  long step_ = 0, first_step_ = 0;
  double largest_ratio_ = 0;
  std::unique_ptr<Simulation> simulation_;
};

void run(StageContext& context) {
  if (mpi::size(context.comm) > 1 && mpi::rank(context.comm) == 0)
    log::info("deploy works on one rank with threads; the other ranks repeat it");
  const Parameters p = read_parameters(context.scene);
  const auto parents = state::parent_states(context, {"crimp", "mesher"});
  Run deployment(context, read_inputs(parents[0], parents[1], p), p);
  if (deployment.go()) deployment.finish();
}

Estimate estimate(const Case& scene, int) {
  const Parameters p = read_parameters(scene);
  const double steps = (p.open_ramp_s + p.open_hold_s + p.expand_s + p.settle_s) / p.step_s;
  const double edge = scene.real("device.leaflet_edge_mm");
  const double triangles = 900 / (0.43 * edge * edge) * 2.2;
  return {steps * triangles * 0.6e-6, 300 + triangles * 0.02,
          "implant depth within 1 mm of the command; contact overlap within deploy.penetration_tolerance_mm"};
}

void check(const Case& scene) {
  if (!scene.has("device"))
    throw InputError("{}: deploy needs a [device] table; a scene without device goes from mesher to cycle",
                     scene.file().string());
}

}  // namespace

int main(int argc, char** argv) {
  valsalva::structure::wait_passively(argv);
  return valsalva::stage_main(
      argc, argv,
      {"deploy",
       "Places the device, opens the native leaflets, releases and settles it",
       "valsalva-deploy CASE.toml --set deploy.depth_mm=4 --set deploy.release=sheath",
       valsalva::declare_all,
       {"deploy", "contact", "device", "native", "mesh"},
       run,
       estimate,
       check});
}
