// Oscillation of a leaflet's free edge while the valve is open: amplitude and peak in a frequency band.
//
// The signal (a length over time) is resampled evenly, its quadratic trend removed, weighted with a Hann
// window and transformed. The amplitude is the root mean square of what lies within the band, corrected for
// the window's power, in the signal's own unit.
#pragma once

#include <vector>

namespace valsalva::metrics {

struct FlutterBand {
  double low_Hz = 30, high_Hz = 200;  ///< published flutter lies at 40-70 Hz (Johnson et al. 2022)
};

struct Flutter {
  double amplitude = 0;
  double peak_Hz = 0;  ///< of the band's strongest line; 0 when the signal is still
};

/// Between start_s and end_s. Zero for fewer than eight samples or a window shorter than two periods of
/// low_Hz.
Flutter flutter(const std::vector<double>& time_s, const std::vector<double>& signal, double start_s,
                double end_s, const FlutterBand& band = {});

}  // namespace valsalva::metrics
