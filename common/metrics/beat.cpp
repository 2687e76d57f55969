#include "metrics/beat.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::metrics {

namespace {

// Trapezoidal integral of f over the samples first..last.
template <class Function>
double integrate(const std::vector<double>& t, std::size_t first, std::size_t last, Function&& f) {
  double sum = 0;
  for (std::size_t i = first; i < last; ++i) sum += 0.5 * (f(i) + f(i + 1)) * (t[i + 1] - t[i]);
  return sum;
}

}  // namespace

std::optional<BeatMetrics> beat_metrics(const BeatSeries& s, double period_s, double density) {
  const std::size_t n = s.time_s.size();
  VALSALVA_ASSERT(s.flow.size() == n && s.upstream_Pa.size() == n && s.downstream_Pa.size() == n &&
                  s.jet_mm_per_s.size() == n && s.inflow_power.size() == n && s.outflow_power.size() == n &&
                  (s.paravalvular.empty() || s.paravalvular.size() == n));
  if (n < 4) return std::nullopt;
  const std::size_t peak = std::max_element(s.flow.begin(), s.flow.end()) - s.flow.begin();
  if (!(s.flow[peak] > 0)) return std::nullopt;
  std::size_t first = peak, last = peak;
  while (first > 0 && s.flow[first - 1] > 0) --first;
  while (last + 1 < n && s.flow[last + 1] > 0) ++last;

  auto gradient = [&](std::size_t i) { return s.upstream_Pa[i] - s.downstream_Pa[i]; };
  auto positive = [&](std::size_t i) { return gradient(i) > 0 ? 1.0 : 0.0; };
  const double duration = integrate(s.time_s, first, last, positive);
  if (!(duration > 0)) return std::nullopt;

  BeatMetrics m;
  m.ejection_start_s = s.time_s[first];
  m.ejection_end_s = s.time_s[last];
  m.mean_gradient_Pa =
      integrate(s.time_s, first, last, [&](std::size_t i) { return positive(i) * gradient(i); }) / duration;
  for (std::size_t i = first; i <= last; ++i) m.peak_gradient_Pa = std::max(m.peak_gradient_Pa, gradient(i));
  const double mean_square =
      integrate(s.time_s, first, last, [&](std::size_t i) { return positive(i) * s.flow[i] * s.flow[i]; }) /
      duration;
  const double flow_mL = std::sqrt(mean_square) / units::mm3_per_mL;
  const double rho_cm3 = density * 1e3;  // g/mm3 to g/cm3
  m.eoa_mm2 =
      units::mm2_per_cm2 * flow_mL / (51.6 * std::sqrt(m.mean_gradient_Pa / units::pa_per_mmHg / rho_cm3));
  m.stroke_volume = integrate(s.time_s, first, last, [&](std::size_t i) { return s.flow[i]; });
  const double travel = integrate(s.time_s, first, last, [&](std::size_t i) { return s.jet_mm_per_s[i]; });
  if (travel > 0) m.eoa_continuity_mm2 = m.stroke_volume / travel;
  for (std::size_t i = first; i <= last; ++i)
    m.peak_jet_mm_per_s = std::max(m.peak_jet_mm_per_s, s.jet_mm_per_s[i]);
  m.regurgitant_volume =
      -integrate(s.time_s, 0, n - 1, [&](std::size_t i) { return std::min(0.0, s.flow[i]); });
  if (!s.paravalvular.empty())
    m.paravalvular_leak =
        -integrate(s.time_s, 0, n - 1, [&](std::size_t i) { return std::min(0.0, s.paravalvular[i]); });
  m.output = (m.stroke_volume - m.regurgitant_volume) / period_s;
  const double entered = integrate(s.time_s, 0, n - 1, [&](std::size_t i) { return s.inflow_power[i]; });
  if (entered > 0)
    m.energy_efficiency =
        integrate(s.time_s, 0, n - 1, [&](std::size_t i) { return s.outflow_power[i]; }) / entered;
  return m;
}

}  // namespace valsalva::metrics
