#include "metrics/flutter.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::metrics {

namespace {

constexpr int samples = 512;

std::vector<double> resample(const std::vector<double>& t, const std::vector<double>& f, double start,
                             double end) {
  std::vector<double> out(samples);
  std::size_t i = 0;
  for (int n = 0; n < samples; ++n) {
    const double at = start + (end - start) * n / samples;
    while (i + 2 < t.size() && t[i + 1] < at) ++i;
    const double s = std::clamp((at - t[i]) / (t[i + 1] - t[i]), 0.0, 1.0);
    out[n] = (1 - s) * f[i] + s * f[i + 1];
  }
  return out;
}

void remove_quadratic_trend(std::vector<double>& f) {
  Eigen::MatrixXd basis(samples, 3);
  Eigen::VectorXd values(samples);
  for (int n = 0; n < samples; ++n) {
    const double s = 2.0 * n / samples - 1;
    basis.row(n) << 1, s, s * s;
    values[n] = f[n];
  }
  const Eigen::VectorXd rest = values - basis * basis.colPivHouseholderQr().solve(values);
  for (int n = 0; n < samples; ++n) f[n] = rest[n];
}

}  // namespace

Flutter flutter(const std::vector<double>& time_s, const std::vector<double>& signal, double start_s,
                double end_s, const FlutterBand& band) {
  VALSALVA_ASSERT(time_s.size() == signal.size());
  Flutter result;
  const double length = end_s - start_s;
  if (time_s.size() < 8 || !(length * band.low_Hz >= 2)) return result;
  std::vector<double> f = resample(time_s, signal, start_s, end_s);
  remove_quadratic_trend(f);
  double window_power = 0;
  for (int n = 0; n < samples; ++n) {
    const double hann = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * n / samples);
    f[n] *= hann;
    window_power += hann * hann / samples;
  }
  double power = 0, strongest = 0;
  for (int k = 1; k < samples / 2; ++k) {
    const double frequency = k / length;
    if (frequency < band.low_Hz || frequency > band.high_Hz) continue;
    std::complex<double> line = 0;
    for (int n = 0; n < samples; ++n) line += f[n] * std::polar(1.0, -2 * std::numbers::pi * k * n / samples);
    const double line_power = 2 * std::norm(line) / (static_cast<double>(samples) * samples);
    power += line_power;
    if (line_power > strongest) {
      strongest = line_power;
      result.peak_Hz = frequency;
    }
  }
  result.amplitude = std::sqrt(power / window_power);
  return result;
}

}  // namespace valsalva::metrics
