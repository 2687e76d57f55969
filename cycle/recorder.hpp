// What is kept of the running beat: rows of history.csv, and light pictures for the report.
#pragma once

#include "core/run_folder.hpp"
#include "inputs.hpp"
#include "metrics/orifice.hpp"
#include "metrics/probes.hpp"
#include "terminals.hpp"

namespace valsalva::cycle {

class Recorder {
 public:
  Recorder(const Inputs& in, const Parameters& p, coupling::ImmersedFlow& system, std::vector<int> device);

  /// After every step (collective).
  void after_step(double time_s, const coupling::ImmersedStep& step, const Terminals& terminals);

  const History& history() const { return history_; }
  /// 0 during the initialisation, then 1, 2, ...
  int beat_of(double time_s) const;
  /// The jet's largest velocity is looked for above this height, the top of the attached edge: below it, thin
  /// leak jets between closing leaflets are faster.
  double valve_z_mm() const { return valve_z_mm_; }
  double valve_radius_mm() const { return outline_ ? outline_->largest_radius() : 0; }
  double gap_area_mm2() const { return gap_ ? gap_->area_mm2() : 0; }

  /// History, sums and frames (below "frames/"), for the state and back.
  std::map<std::string, state::Array> save() const;
  void load(const state::State& state);
  /// The same without frames: small enough to take often. Frames taken since are dropped.
  struct Mark {
    std::size_t rows = 0, frames = 0;
    std::vector<double> sums;
  };
  Mark mark() const;
  void return_to(const Mark& mark);

 private:
  void add_row(double time_s, const coupling::ImmersedStep& step, const Terminals& terminals);
  void add_frame(double time_s);
  struct Load {
    double von_mises_Pa = 0, strain = 0;  // 99th percentiles over the area
    double exponent = 0;                  // the largest of the tissue law
  };
  Load load_of_leaflets() const;

  const Inputs& in_;
  const Parameters& p_;
  coupling::ImmersedFlow& system_;
  std::vector<int> device_;
  std::optional<metrics::OrificeOutline> outline_;
  std::optional<metrics::ParavalvularGap> gap_;
  double valve_z_mm_ = 0;
  int low_plane_ = 0, high_plane_ = 0, slice_j_ = 0;
  History history_;
  // Sums over all steps: volume through both ends (mm3), the device's slide (mm), the last row's time, the
  // largest CFL number, the number of steps.
  double low_volume_ = 0, high_volume_ = 0, slide_mm_ = 0, row_time_s_ = 0, max_cfl_ = 0, steps_ = 0;
  std::vector<double> frame_time_s_;
  std::vector<std::vector<float>> frame_points_, frame_velocity_, frame_pressure_;
};

}  // namespace valsalva::cycle
