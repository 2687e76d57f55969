#include "recorder.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/units.hpp"
#include "metrics/statistics.hpp"

namespace valsalva::cycle {

namespace {

using state::Array;
using units::mm3_per_mL;
using units::pa_per_mmHg;

constexpr double probe_inset_mm = 3;  // pressures are read this far inside the two ends
constexpr double orifice_pixel_mm = 0.2;

std::vector<std::string> columns() {
  std::vector<std::string> names{"time_s",
                                 "beat",
                                 "p_la_mmHg",
                                 "p_lv_mmHg",
                                 "p_lvot_mmHg",
                                 "p_ao_mmHg",
                                 "q_mL_per_s",
                                 "q_in_mL_per_s",
                                 "q_mitral_mL_per_s",
                                 "q_paravalvular_mL_per_s",
                                 "v_lv_mL",
                                 "orifice_cm2",
                                 "jet_cm_per_s",
                                 "max_speed_cm_per_s",
                                 "von_mises_p99_kPa",
                                 "max_principal_strain_p99",
                                 "law_exponent",
                                 "leaflet_gap_mm",
                                 "device_force_N",
                                 "device_slide_mm",
                                 "power_in_mW",
                                 "power_out_mW",
                                 "volume_balance_mL",
                                 "dt_s",
                                 "dt_crit_s",
                                 "max_cfl",
                                 "kinetic_energy_mJ"};
  for (int leaf = 0; leaf < 3; ++leaf)
    for (const char* axis : {"x", "y", "z"}) names.push_back(fmt::format("tip{}_{}_mm", leaf + 1, axis));
  return names;
}

Array stacked(const std::vector<std::vector<float>>& frames, std::vector<std::size_t> shape) {
  std::vector<float> all;
  for (const auto& frame : frames) all.insert(all.end(), frame.begin(), frame.end());
  shape.insert(shape.begin(), frames.size());
  return Array::of(std::move(all), std::move(shape));
}

std::vector<std::vector<float>> unstacked(const Array& array, const std::string& name) {
  const std::vector<float>& all = array.floats(name);
  const std::size_t frames = array.shape.empty() ? 0 : array.shape[0],
                    each = frames ? all.size() / frames : 0;
  std::vector<std::vector<float>> out;
  for (std::size_t f = 0; f < frames; ++f)
    out.emplace_back(all.begin() + f * each, all.begin() + (f + 1) * each);
  return out;
}

}  // namespace

Recorder::Recorder(const Inputs& in, const Parameters& p, coupling::ImmersedFlow& system,
                   std::vector<int> device)
    : in_(in), p_(p), system_(system), device_(std::move(device)), history_(columns()) {
  const fluid::Flow& flow = system.flow();
  const fluid::Grid& grid = flow.grid();
  const int inset = static_cast<int>(std::ceil(probe_inset_mm / grid.h));
  low_plane_ = inset;
  high_plane_ = grid.cells[2] - 1 - inset;
  slice_j_ = std::clamp(static_cast<int>(std::floor(-grid.origin.y() / grid.h)), 0, grid.cells[1] - 1);
  if (in.leaflets) {
    Points attached;
    valve_z_mm_ = -1e300;
    for (std::size_t a = 0; a < in.leaflets->points.size(); ++a)
      if (in.leaflets->attached[a]) {
        attached.push_back(in.leaflets->points[a]);
        valve_z_mm_ = std::max(valve_z_mm_, in.leaflets->points[a].z());
      }
    outline_ = metrics::outline_of(attached, orifice_pixel_mm);
  }
  if (in.skirt) {
    double low = 1e300, high = -1e300;
    for (const Vec3& x : in.skirt->points) {
      low = std::min(low, x.z());
      high = std::max(high, x.z());
    }
    gap_.emplace(system.flow(), in.skirt->points, low < 0 && high > 0 ? 0.0 : 0.5 * (low + high));
  }
}

int Recorder::beat_of(double time_s) const {
  if (time_s < p_.initialisation_s) return 0;
  return 1 + static_cast<int>((time_s - p_.initialisation_s) / p_.circulation.period_s);
}

void Recorder::after_step(double time_s, const coupling::ImmersedStep& step, const Terminals& terminals) {
  low_volume_ += step.dt_s * system_.flow().flow_through(fluid::End::low);
  high_volume_ += step.dt_s * system_.flow().flow_through(fluid::End::high);
  max_cfl_ = std::max(max_cfl_, step.fluid.cfl);
  steps_ += 1;
  if (static_cast<long>(steps_) % p_.history_interval == 0) add_row(time_s, step, terminals);
  if (p_.frames_per_beat == 0 || beat_of(time_s) != p_.beats) return;
  const double start = p_.initialisation_s + (p_.beats - 1) * p_.circulation.period_s;
  const double due =
      start + static_cast<double>(frame_time_s_.size()) * p_.circulation.period_s / p_.frames_per_beat;
  if (time_s >= due && static_cast<int>(frame_time_s_.size()) < p_.frames_per_beat) add_frame(time_s);
}

Recorder::Load Recorder::load_of_leaflets() const {
  const coupling::ImmersedShell& shell = *system_.shell();
  const MPI_Comm comm = system_.flow().slab().comm;
  const int elements = shell.shell().elements(), ranks = mpi::size(comm);
  std::vector<double> values(2 * static_cast<std::size_t>(elements), 0.0), stress, strain, area;
  Load load;
  for (int e = mpi::rank(comm); e < elements; e += ranks) {
    const structure::ElementState now = shell.shell().element_state(shell.x(), e);
    values[2 * e] = now.von_mises_Pa;
    values[2 * e + 1] = 0.5 * (now.stretch_major * now.stretch_major - 1);
    load.exponent = std::max(load.exponent, now.exponent);
  }
  if (ranks > 1) mpi::sum_in_place(comm, values.data(), values.size());
  for (int e = 0; e < elements; ++e) {
    stress.push_back(values[2 * e]);
    strain.push_back(values[2 * e + 1]);
    area.push_back(shell.shell().reference_area(e));
  }
  load.von_mises_Pa = metrics::weighted_percentile(stress, area, 0.99);
  load.strain = metrics::weighted_percentile(strain, area, 0.99);
  load.exponent = mpi::max(comm, load.exponent);
  return load;
}

void Recorder::add_row(double time_s, const coupling::ImmersedStep& step, const Terminals& terminals) {
  const fluid::Flow& flow = system_.flow();
  const fluid::Grid& grid = flow.grid();
  const circulation::LeftHeart* heart = terminals.heart();
  double orifice = 0, gap = 0, pull = 0;
  Load load;
  if (const coupling::ImmersedShell* shell = system_.shell()) {
    orifice = metrics::orifice_area(shell->x(), shell->shell().mesh().triangles, *outline_);
    load = load_of_leaflets();
    gap = shell->nearest();
    if (in_.frame) pull = shell->pull_on_clamps().z();
  }
  double force = pull;
  for (const int body : device_) force += flow.solids().force_on(body).z();
  // The closing of the valve from rest is not the device's history.
  if (beat_of(time_s) > 0)
    slide_mm_ += std::copysign(std::max(0.0, std::abs(force) - in_.friction_capacity_uN), force) /
                 p_.anchor_drag * (time_s - row_time_s_);
  row_time_s_ = time_s;
  const double jet = metrics::largest_axial_velocity(flow, flow.plane_at(valve_z_mm_), high_plane_);
  std::vector<double> row{time_s,
                          static_cast<double>(beat_of(time_s)),
                          heart ? heart->atrial_pressure() / pa_per_mmHg : 0.0,
                          terminals.ventricular_pressure() / pa_per_mmHg,
                          flow.mean_pressure(low_plane_) / pa_per_mmHg,
                          flow.mean_pressure(high_plane_) / pa_per_mmHg,
                          flow.flow_through(fluid::End::high) / mm3_per_mL,
                          flow.flow_through(fluid::End::low) / mm3_per_mL,
                          heart ? heart->mitral_flow() / mm3_per_mL : 0.0,
                          gap_ ? gap_->flow_through(flow) / mm3_per_mL : 0.0,
                          heart ? heart->ventricular_volume() / mm3_per_mL : 0.0,
                          orifice / units::mm2_per_cm2,
                          jet / 10,
                          step.fluid.max_speed / 10,
                          load.von_mises_Pa / units::pa_per_kPa,
                          load.strain,
                          load.exponent,
                          gap,
                          force / units::uN_per_N,
                          slide_mm_,
                          1e-6 * metrics::power_through(flow, 0, terminals.low_pressure()),
                          1e-6 * metrics::power_through(flow, grid.cells[2], terminals.high_pressure()),
                          (high_volume_ - low_volume_) / mm3_per_mL,
                          step.dt_s,
                          std::min(step.critical_s, 1.0),
                          max_cfl_,
                          1e-6 * step.fluid.kinetic_energy};
  for (int leaf = 0; leaf < 3; ++leaf)
    for (int d = 0; d < 3; ++d)
      row.push_back(system_.shell() ? system_.shell()->x()[in_.leaflets->tip[leaf]][d] : 0.0);
  history_.add(row);
}

void Recorder::add_frame(double time_s) {
  const fluid::Flow& flow = system_.flow();
  const fluid::Slab& slab = flow.slab();
  const int nx = slab.grid.cells[0], nz = slab.grid.cells[2], j = slice_j_;
  std::vector<double> slice(4 * static_cast<std::size_t>(nx) * nz, 0.0);
  for (int k = 0; k < slab.planes; ++k)
    for (int i = 0; i < nx; ++i) {
      double* at = &slice[4 * (static_cast<std::size_t>(k + slab.first) * nx + i)];
      const fluid::FaceField& u = flow.velocity();
      at[0] = 0.5 * (u[0](i, j, k) + u[0](i + 1, j, k));
      at[1] = 0.5 * (u[1](i, j, k) + u[1](i, j + 1, k));
      at[2] = 0.5 * (u[2](i, j, k) + u[2](i, j, k + 1));
      at[3] = flow.pressure()(i, j, k) / pa_per_mmHg;
    }
  mpi::sum_in_place(slab.comm, slice.data(), slice.size());
  std::vector<float> velocity, pressure, points;
  for (std::size_t c = 0; c < slice.size(); c += 4) {
    for (int d = 0; d < 3; ++d) velocity.push_back(static_cast<float>(slice[c + d]));
    pressure.push_back(static_cast<float>(slice[c + 3]));
  }
  if (system_.shell())
    for (const Vec3& x : system_.shell()->x())
      for (int d = 0; d < 3; ++d) points.push_back(static_cast<float>(x[d]));
  frame_time_s_.push_back(time_s);
  frame_points_.push_back(std::move(points));
  frame_velocity_.push_back(std::move(velocity));
  frame_pressure_.push_back(std::move(pressure));
}

Recorder::Mark Recorder::mark() const {
  return {history_.rows(),
          frame_time_s_.size(),
          {low_volume_, high_volume_, slide_mm_, row_time_s_, max_cfl_, steps_}};
}

void Recorder::return_to(const Mark& mark) {
  VALSALVA_ASSERT(mark.sums.size() == 6 && mark.rows <= history_.rows());
  std::vector<double> values = history_.values();
  values.resize(mark.rows * history_.columns().size());
  history_.restore(std::move(values));
  frame_time_s_.resize(mark.frames);
  frame_points_.resize(mark.frames);
  frame_velocity_.resize(mark.frames);
  frame_pressure_.resize(mark.frames);
  low_volume_ = mark.sums[0];
  high_volume_ = mark.sums[1];
  slide_mm_ = mark.sums[2];
  row_time_s_ = mark.sums[3];
  max_cfl_ = mark.sums[4];
  steps_ = mark.sums[5];
}

std::map<std::string, Array> Recorder::save() const {
  std::map<std::string, Array> out;
  out["cycle/sums"] = Array::of(mark().sums);
  if (history_.rows() > 0)
    out["cycle/history"] = Array::of(history_.values(), {history_.rows(), history_.columns().size()});
  if (frame_time_s_.empty()) return out;
  const fluid::Grid& grid = system_.flow().grid();
  const auto nx = static_cast<std::size_t>(grid.cells[0]), nz = static_cast<std::size_t>(grid.cells[2]);
  const Vec3 origin = grid.position(3, 0, slice_j_, 0);
  out["frames/time_s"] = Array::of(frame_time_s_);
  if (system_.shell())
    out["frames/leaflet_points"] = stacked(frame_points_, {system_.shell()->x().size(), 3});
  out["frames/slice_velocity_mm_per_s"] = stacked(frame_velocity_, {nz, nx, 3});
  out["frames/slice_pressure_mmHg"] = stacked(frame_pressure_, {nz, nx});
  out["frames/slice_origin_mm"] = Array::of(std::vector<double>{origin.x(), origin.y(), origin.z()});
  out["frames/slice_spacing_mm"] = Array::of(std::vector<double>(3, grid.h));
  return out;
}

void Recorder::load(const state::State& state) {
  if (state.has_array("cycle/history"))
    history_.restore(state.array("cycle/history").doubles("cycle/history"));
  // Of a run with more beats than before, frames are those of the new last one.
  if (state.has_array("frames/time_s") &&
      beat_of(state.array("frames/time_s").doubles("frames/time_s").at(0)) == p_.beats) {
    frame_time_s_ = state.array("frames/time_s").doubles("frames/time_s");
    frame_velocity_ =
        unstacked(state.array("frames/slice_velocity_mm_per_s"), "frames/slice_velocity_mm_per_s");
    frame_pressure_ = unstacked(state.array("frames/slice_pressure_mmHg"), "frames/slice_pressure_mmHg");
    frame_points_.assign(frame_time_s_.size(), {});
    if (state.has_array("frames/leaflet_points"))
      frame_points_ = unstacked(state.array("frames/leaflet_points"), "frames/leaflet_points");
  }
  Mark now = mark();
  now.sums = state.array("cycle/sums").doubles("cycle/sums");
  if (now.sums.size() != 6)
    throw InputError("{}: 'cycle/sums' has {} entries; expected 6", state.source, now.sums.size());
  return_to(now);
}

}  // namespace valsalva::cycle
