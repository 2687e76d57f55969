// Is a beat like the one before it?
//
// The difference is the root mean square of what a quantity differs by at equal phases, over its range in the
// later beat (128 phases, linear between samples).
#pragma once

#include <vector>

namespace valsalva::metrics {

/// Samples of one beat: time since the beat began, increasing.
struct BeatSamples {
  std::vector<double> phase_s, value;
};

/// Share of the range, 0 for equal beats; 0 also where the quantity does not change in either. At least two
/// samples each.
double beat_difference(const BeatSamples& before, const BeatSamples& after);

}  // namespace valsalva::metrics
