// Haemodynamic figures of one beat, from simulated pressure and flow, never from a formula for the gradient.
//
//   ejection        the stretch of forward flow around its peak
//   gradient        P_upstream - P_downstream, mean pressures of two planes; its mean is taken over the part
//   of
//                   ejection where it is positive
//   EOA             Q_rms / (51.6 sqrt(mean gradient / rho)), Q_rms (mL/s) over the same part, gradient in
//                   mmHg, rho in g/cm3, cm2 (Gorlin type, ISO 5840)
//   EOA, continuity stroke volume / velocity-time integral of the jet over ejection, cm2
//   stroke volume   forward volume of ejection;  regurgitant volume: all backward volume of the beat (closing
//                   volume included);  cardiac output: (stroke - regurgitant) / period
//   efficiency      energy that leaves the outlet / energy that enters the inlet, as integrals of
//                   (p + rho |u|^2 / 2) u over the beat (Johnson et al. 2022, section 3.4)
// Integrals by the trapezoidal rule over the samples.
#pragma once

#include <optional>
#include <vector>

namespace valsalva::metrics {

/// Samples of one beat, times increasing.
struct BeatSeries {
  std::vector<double> time_s;
  std::vector<double> upstream_Pa, downstream_Pa;
  std::vector<double> flow;                         ///< through the valve into the aorta, mm3/s
  std::vector<double> jet_mm_per_s;                 ///< the largest axial velocity behind the valve
  std::vector<double> inflow_power, outflow_power;  ///< nJ/s through inlet and outlet, along the flow
  std::vector<double> paravalvular;                 ///< flow between device and wall, mm3/s; empty: no device
};

struct BeatMetrics {
  double mean_gradient_Pa = 0, peak_gradient_Pa = 0;
  double eoa_mm2 = 0, eoa_continuity_mm2 = 0;
  double stroke_volume = 0, regurgitant_volume = 0, paravalvular_leak = 0;  ///< mm3
  double output = 0;                                                        ///< mm3/s
  double peak_jet_mm_per_s = 0;
  double energy_efficiency = 0;  ///< 0 to 1
  double ejection_start_s = 0, ejection_end_s = 0;
};

/// period_s: for the output. density: g/mm3. Nothing when there is no forward flow or no positive gradient,
/// or fewer than four samples.
std::optional<BeatMetrics> beat_metrics(const BeatSeries& series, double period_s, double density);

}  // namespace valsalva::metrics
