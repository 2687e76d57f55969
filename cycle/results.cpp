#include "results.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/log.hpp"
#include "core/units.hpp"
#include "metrics/beat.hpp"
#include "metrics/flutter.hpp"
#include "metrics/periodicity.hpp"
#include "state/checkpoint.hpp"

namespace valsalva::cycle {

namespace {

using state::Array;
using units::mm3_per_mL;
using units::pa_per_mmHg;

constexpr double nJ_per_s_per_mW = 1e6;

struct Window {  // rows of the last full beat
  std::size_t first = 0, last = 0;
  std::size_t size() const { return last - first; }
};

/// beat: counted from 1.
Window rows_of_beat(const History& history, const Parameters& p, int beat) {
  const double start = p.initialisation_s + (beat - 1) * p.circulation.period_s;
  const std::vector<double> time = history.column("time_s");
  const auto first = std::lower_bound(time.begin(), time.end(), start);
  const auto last = std::upper_bound(first, time.end(), start + p.circulation.period_s);
  return {static_cast<std::size_t>(first - time.begin()), static_cast<std::size_t>(last - time.begin())};
}

std::vector<double> part(const History& history, const std::string& column, Window w, double unit = 1) {
  const std::vector<double> all = history.column(column);
  std::vector<double> out(all.begin() + static_cast<long>(w.first), all.begin() + static_cast<long>(w.last));
  for (double& v : out) v *= unit;
  return out;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0 : *std::max_element(values.begin(), values.end());
}

/// Distance of each leaflet's tip from the valve's axis; the leaflet that flutters most speaks.
metrics::Flutter flutter_of(const History& history, Window w, const metrics::BeatMetrics& beat) {
  metrics::Flutter most;
  // Opening and closing are no flutter: the middle of ejection only.
  const double length = beat.ejection_end_s - beat.ejection_start_s;
  const double start = beat.ejection_start_s + 0.25 * length, end = beat.ejection_end_s - 0.2 * length;
  for (int leaf = 1; leaf <= 3; ++leaf) {
    const std::vector<double> x = part(history, fmt::format("tip{}_x_mm", leaf), w),
                              y = part(history, fmt::format("tip{}_y_mm", leaf), w);
    std::vector<double> radius;
    for (std::size_t i = 0; i < x.size(); ++i) radius.push_back(std::hypot(x[i], y[i]));
    const metrics::Flutter one = metrics::flutter(part(history, "time_s", w), radius, start, end);
    if (one.amplitude > most.amplitude) most = one;
  }
  return most;
}

// Blood that is faster than the run's pressures could drive it, sqrt(2 (p_max - p_min) / rho), was thrown by
// the structure: a burst of a stiff fold, which no alarm need have seen. The column holds |u| + |v| + |w|.
// What the ramp of the initialisation slams shut rings on for about as long as the ramp.
void check_speeds(Summary& s, const Parameters& p, const History& history) {
  double low = 0, high = 0, fastest = 0, at = 0;
  const std::vector<double> time = history.column("time_s"), speed = history.column("max_speed_cm_per_s");
  for (const char* name : {"p_lv_mmHg", "p_lvot_mmHg", "p_ao_mmHg"})
    for (const double pressure : history.column(name)) {
      low = std::min(low, pressure * pa_per_mmHg);
      high = std::max(high, pressure * pa_per_mmHg);
    }
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (time[i] < 2 * p.initialisation_s || speed[i] <= fastest) continue;
    fastest = speed[i];
    at = time[i];
  }
  if (!(high > low)) return;
  const double driven = std::sqrt(3 * 2 * (high - low) / p.fluid.density) / 10;
  const double ratio = fastest / driven;
  s.metrics["largest_speed_cm_per_s"] = fastest;
  s.checks["speed_over_what_pressures_drive"] = {ratio, 1, ratio <= 1};
  if (ratio > 1)
    s.notes["burst"] = fmt::format(
        "at {:.4f} s blood moved at {:.0f} cm/s somewhere, more than the pressures of the run could drive "
        "({:.0f} cm/s): a fold of the leaflets threw it; stresses and strains there are not to be trusted. A "
        "finer leaflet mesh or a smaller cycle.step_safety may calm it",
        at, fastest, driven);
}

void beat_figures(Summary& s, const Inputs& in, const Parameters& p, const Simulation& simulation) {
  const History& history = simulation.recorder().history();
  const Window w = rows_of_beat(history, p, p.beats);
  metrics::BeatSeries series;
  series.time_s = part(history, "time_s", w);
  series.upstream_Pa = part(history, "p_lvot_mmHg", w, pa_per_mmHg);
  series.downstream_Pa = part(history, "p_ao_mmHg", w, pa_per_mmHg);
  series.flow = part(history, "q_mL_per_s", w, mm3_per_mL);
  series.jet_mm_per_s = part(history, "jet_cm_per_s", w, 10);
  series.inflow_power = part(history, "power_in_mW", w, nJ_per_s_per_mW);
  series.outflow_power = part(history, "power_out_mW", w, nJ_per_s_per_mW);
  if (in.skirt) series.paravalvular = part(history, "q_paravalvular_mL_per_s", w, mm3_per_mL);
  const auto beat = metrics::beat_metrics(series, p.circulation.period_s, p.fluid.density);

  auto& m = s.metrics;
  const double goa = largest(part(history, "orifice_cm2", w));
  m["goa_max_cm2"] = goa;
  m["leaflet_von_mises_p99_kPa"] = largest(part(history, "von_mises_p99_kPa", w));
  m["leaflet_max_principal_strain_p99"] = largest(part(history, "max_principal_strain_p99", w));
  const std::vector<double> balance = part(history, "volume_balance_mL", w);
  if (!beat) {
    s.notes["beat"] =
        "no forward flow with a positive pressure difference in the last beat: no gradient, no EOA";
    s.checks["valve_opened"] = {0, 1, false};
    return;
  }
  m["mean_gradient_mmHg"] = beat->mean_gradient_Pa / pa_per_mmHg;
  m["peak_gradient_mmHg"] = beat->peak_gradient_Pa / pa_per_mmHg;
  m["eoa_cm2"] = beat->eoa_mm2 / units::mm2_per_cm2;
  m["eoa_continuity_cm2"] = beat->eoa_continuity_mm2 / units::mm2_per_cm2;
  m["stroke_volume_mL"] = beat->stroke_volume / mm3_per_mL;
  m["regurgitant_volume_mL"] = beat->regurgitant_volume / mm3_per_mL;
  if (in.skirt) m["paravalvular_leak_mL"] = beat->paravalvular_leak / mm3_per_mL;
  m["cardiac_output_L_per_min"] = beat->output / mm3_per_mL / 1e3 * units::s_per_min;
  m["peak_jet_velocity_cm_per_s"] = beat->peak_jet_mm_per_s / 10;
  m["energy_efficiency_pct"] = 100 * beat->energy_efficiency;
  m["ejection_s"] = beat->ejection_end_s - beat->ejection_start_s;
  m["volume_balance_error_pct"] =
      100 * std::abs(balance.back() - balance.front()) / (beat->stroke_volume / mm3_per_mL);
  s.checks["volume_balance_error_pct"] = {m["volume_balance_error_pct"], 0.5,
                                          m["volume_balance_error_pct"] <= 0.5};
  if (!in.leaflets) return;

  const metrics::Flutter flutter = flutter_of(history, w, *beat);
  const double radius = simulation.recorder().valve_radius_mm();
  m["flutter_band_amplitude"] = flutter.amplitude / radius;
  m["flutter_peak_Hz"] = flutter.peak_Hz;

  // Closed and holding: late diastole, the last fifth of the beat.
  const double hold_from = series.time_s.back() - 0.2 * p.circulation.period_s;
  double leak = 0, beside = 0, drop = 0, least_orifice = goa, time = 0;
  const std::vector<double> orifice = part(history, "orifice_cm2", w),
                            paravalvular = part(history, "q_paravalvular_mL_per_s", w);
  for (std::size_t i = 1; i < series.time_s.size(); ++i) {
    least_orifice = std::min(least_orifice, orifice[i]);
    if (series.time_s[i] < hold_from) continue;
    const double dt = series.time_s[i] - series.time_s[i - 1];
    leak -= series.flow[i] * dt;
    beside -= paravalvular[i] * dt;
    drop += (series.downstream_Pa[i] - series.upstream_Pa[i]) * dt;
    time += dt;
  }
  if (!(time > 0)) return;
  m["diastolic_leak_mL_per_s"] = leak / time / mm3_per_mL;
  if (in.skirt) m["diastolic_transvalvular_leak_mL_per_s"] = leak / time / mm3_per_mL - beside / time;
  m["diastolic_pressure_difference_mmHg"] = drop / time / pa_per_mmHg;
  const double projected = std::numbers::pi * radius * radius / units::mm2_per_cm2;
  s.checks["valve_opened_orifice_cm2"] = {goa, 0.1 * projected, goa >= 0.1 * projected};
  s.checks["valve_closed_orifice_share"] = {least_orifice / goa, 0.25, least_orifice <= 0.25 * goa};
  s.checks["holds_diastolic_mmHg"] = {m["diastolic_pressure_difference_mmHg"], 30,
                                      m["diastolic_pressure_difference_mmHg"] >= 30};
}

/// How much the last beat differs from the one before it; pressures and flow.
void compare_beats(Summary& s, const Parameters& p, const History& history) {
  double worst = 0;
  for (const char* column : {"p_lvot_mmHg", "p_ao_mmHg", "q_mL_per_s"}) {
    metrics::BeatSamples beat[2];
    for (int i = 0; i < 2; ++i) {
      const int number = p.beats - 1 + i;
      const Window w = rows_of_beat(history, p, number);
      if (w.size() < 2) return;
      beat[i].phase_s = part(history, "time_s", w);
      for (double& t : beat[i].phase_s) t -= p.initialisation_s + (number - 1) * p.circulation.period_s;
      beat[i].value = part(history, column, w);
    }
    worst = std::max(worst, metrics::beat_difference(beat[0], beat[1]));
  }
  s.metrics["beat_to_beat_difference_pct"] = 100 * worst;
  s.checks["periodic_beat_pct"] = {100 * worst, 2, worst <= 0.02};
}

state::Mesh leaflets_now(const Leaflets& l, const state::Mesh& parent, const coupling::ImmersedShell& shell) {
  state::Mesh mesh = parent;
  mesh.points = shell.x();
  std::vector<double> stress, stretch;
  for (int e = 0; e < shell.shell().elements(); ++e) {
    const structure::ElementState now = shell.shell().element_state(shell.x(), e);
    stress.push_back(now.von_mises_Pa);
    stretch.push_back(now.stretch_major);
  }
  mesh.cell_data["von_mises_Pa"] = Array::of(std::move(stress));
  mesh.cell_data["stretch_major"] = Array::of(std::move(stretch));
  mesh.point_data["start"] = Array::of(l.points);
  return mesh;
}

}  // namespace

state::State state_of(const StageContext& context, const Inputs& in, const Simulation& simulation,
                      bool final) {
  state::State out = state::begin(context, simulation.time_s(), simulation.steps());
  out.restart = simulation.save();
  out.final = final;
  if (in.leaflets)
    out.meshes[in.leaflets->name] =
        leaflets_now(*in.leaflets, in.parent.mesh(in.leaflets->name), *simulation.shell());
  for (const char* held : {"lumen", "frame", "skirt", "native_leaflets", "mount"})
    if (in.parent.has_mesh(held) && !out.has_mesh(held)) out.meshes[held] = in.parent.mesh(held);
  out.images["fluid"] = simulation.flow().image();
  return out;
}

void summarise(Summary& s, const Inputs& in, const Parameters& p, const Simulation& simulation) {
  const History& history = simulation.recorder().history();
  s.steps = simulation.steps();
  s.simulated_s = simulation.time_s();
  if (history.rows() == 0) return;
  s.metrics["max_cfl"] = largest(history.column("max_cfl"));
  s.metrics["cells"] = static_cast<double>(simulation.flow().grid().all_cells());
  if (in.leaflets) {
    s.metrics["leaflet_nodes"] = static_cast<double>(in.leaflets->points.size());
    s.metrics["largest_law_exponent"] = largest(history.column("law_exponent"));
    if (s.metrics["largest_law_exponent"] > 6)
      s.notes["tissue law"] =
          "the exponential was continued by its Taylor polynomial beyond 6 somewhere: strains there are "
          "bounds";
  }
  check_speeds(s, p, history);
  s.metrics["returns_after_alarm"] = static_cast<double>(simulation.returns());
  if (in.frame) {
    s.metrics["device_migration_mm"] = std::abs(history.column("device_slide_mm").back());
    s.metrics["device_force_peak_N"] = 0;
    for (const double f : history.column("device_force_N"))
      s.metrics["device_force_peak_N"] = std::max(s.metrics["device_force_peak_N"], std::abs(f));
    s.metrics["friction_capacity_N"] = in.friction_capacity_uN / units::uN_per_N;
    s.notes["device"] =
        "held in place as a solid; its migration is the slide that the blood's and the leaflets' force "
        "beyond the "
        "friction capacity of deploy would cause, and does not act back";
  }
  const bool whole = simulation.time_s() >= p.initialisation_s + p.beats * p.circulation.period_s - 1e-9;
  if (whole) {
    beat_figures(s, in, p, simulation);
    if (p.beats > 1) compare_beats(s, p, history);
  } else {
    s.notes["beat"] = "less than a full beat was simulated: no figures of a beat";
  }
  s.notes["masks"] = fmt::format(
      "frame, skirt, native leaflets under a device and the attached edge are solid to the fluid, {:.1f}, "
      "{:.1f} "
      "and {:.1f} cells thick on either side: the orifice is narrower by about that much",
      p.masks.strut, p.masks.shell, p.masks.edge);
  if (simulation.terminals().expected()) {
    const circulation::PeriodicBeat& beat = *simulation.terminals().expected();
    s.extra["zero_dimensional_beat"] = {
        {"stroke_volume_mL", beat.stroke_volume / mm3_per_mL},
        {"aortic_start_mmHg", beat.aortic_pressure / pa_per_mmHg},
        {"peak_ventricular_mmHg", beat.peak_ventricular_pressure / pa_per_mmHg},
        {"meaning", "the 0D circulation with an ideal valve: where the beat started, no result of the flow"}};
  }
  for (const auto& [name, check] : s.checks)
    if (!check.pass) log::warn("check {}: {:.4g}, limit {:.4g}", name, check.value, check.limit);
}

}  // namespace valsalva::cycle
