// What beats have cost and how far off they were, measured: cycle/measured.csv, which `make tradeoff` writes
// (its first line says by which command; every row has its commit and machine) and which is compiled in.
// --estimate and the accuracy band of a run are read from it.
//
// Between two measured grids, steps per simulated second, seconds per step and errors are powers of h; beyond
// the coarsest and the finest, steps grow like h^-1.4 (docs/decisions/time-step.md), seconds and memory like
// h^-3, errors like h (first order: an upper bound for finer grids). Seconds are those of a processor on one
// rank; n ranks are taken as n^0.77 times as fast, which is 1.7 on two (docs/results/ranks.md) and unmeasured
// beyond.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/case.hpp"

namespace valsalva::cycle {

struct MeasuredBeat {
  std::string valve;  ///< healthy, stenotic, device
  double spacing_mm = 0;
  double steps_per_s = 0;     ///< of simulated time
  double seconds_a_step = 0;  ///< of one rank
  double memory_MiB = 0;
  std::map<std::string, double>
      error_pct;      ///< figure -> per cent; empty where there is nothing to compare with
  std::string basis;  ///< of the errors
};

/// Rows of the table, finest grid first. InputError that names the line.
std::vector<MeasuredBeat> read_measured(const std::string& csv);
/// The table that is compiled in.
const std::vector<MeasuredBeat>& measured_beats();

struct Expectation {
  double wall_s = 0, memory_MiB = 0;
  std::map<std::string, double> error_pct;
  std::string basis;  ///< where it comes from, and how far it goes beyond what was measured
};

/// For a valve of this kind, h, and so much simulated time; of another kind (the basis says so) where no beat
/// of that kind was measured. InputError when the table is empty.
Expectation expect(const std::vector<MeasuredBeat>& table, const std::string& valve, double h,
                   double simulated_s, int ranks);

/// Which of the measured valves a case is nearest to.
std::string kind_of_valve(const Case& scene);

/// "mean gradient 12 %, ..." and the basis.
std::string in_words(const Expectation& expectation);

}  // namespace valsalva::cycle
