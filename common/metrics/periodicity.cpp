#include "metrics/periodicity.hpp"

#include <algorithm>
#include <cmath>

namespace valsalva::metrics {
namespace {

double at(const BeatSamples& beat, double phase_s) {
  const auto next = std::lower_bound(beat.phase_s.begin(), beat.phase_s.end(), phase_s);
  if (next == beat.phase_s.begin()) return beat.value.front();
  if (next == beat.phase_s.end()) return beat.value.back();
  const auto i = next - beat.phase_s.begin();
  const double share = (phase_s - beat.phase_s[i - 1]) / (beat.phase_s[i] - beat.phase_s[i - 1]);
  return (1 - share) * beat.value[i - 1] + share * beat.value[i];
}

}  // namespace

double beat_difference(const BeatSamples& before, const BeatSamples& after) {
  constexpr int phases = 128;
  const auto [low, high] = std::minmax_element(after.value.begin(), after.value.end());
  const double length = std::min(before.phase_s.back(), after.phase_s.back());
  double sum = 0;
  for (int i = 0; i < phases; ++i) {
    const double phase = length * i / (phases - 1);
    sum += std::pow(at(after, phase) - at(before, phase), 2);
  }
  const double rms = std::sqrt(sum / phases);
  return rms == 0 ? 0 : rms / std::max(*high - *low, rms);
}

}  // namespace valsalva::metrics
