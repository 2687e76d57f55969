#include "circulation/pulse_duplicator.hpp"

#include <cmath>
#include <tuple>

#include "core/errors.hpp"

namespace valsalva::circulation {

ImpedanceAdapter::ImpedanceAdapter(const AdapterParameters& parameters, Waveform pump_pressure,
                                   double stored_pressure)
    : parameters_(parameters), pump_(std::move(pump_pressure)), stored_(stored_pressure) {
  const auto& [r1, r2, c] = parameters;
  if (!(r1 > 0) || !(r2 >= 0) || !(c > 0) || !std::isfinite(r1 + r2 + c) || !std::isfinite(stored_pressure))
    throw InputError(
        "circulation: impedance adapter with R_1 = {}, R_2 = {} Pa s/mm3, C = {} mm3/Pa, P_C = {} Pa; "
        "expected "
        "finite values with R_1 > 0, R_2 >= 0, C > 0",
        r1, r2, c, stored_pressure);
}

void ImpedanceAdapter::advance(double time_s, double dt_s, double inflow) {
  const double steady = pump_.at(time_s + 0.5 * dt_s) + parameters_.inner_resistance * inflow;
  const double tau = parameters_.inner_resistance * parameters_.compliance;
  stored_ = steady + (stored_ - steady) * std::exp(-dt_s / tau);
  inflow_ = inflow;
}

void ImpedanceAdapter::restore(const std::vector<double>& saved) {
  VALSALVA_ASSERT(saved.size() == 2);
  stored_ = saved[0];
  inflow_ = saved[1];
}

PumpChamber::PumpChamber(const ChamberParameters& p, Waveform pump_flow, Waveform atrial_pressure,
                         double pressure)
    : parameters_(p),
      pump_(std::move(pump_flow)),
      atrium_(std::move(atrial_pressure)),
      pump_side_(pressure),
      chamber_(pressure) {
  const bool good = p.pump_compliance > 0 && p.chamber_compliance > 0 && p.adapter_resistance > 0 &&
                    p.outlet_resistance >= 0 && p.mitral_resistance > 0 && p.mitral_leak_resistance >= 0;
  const double sum = p.pump_compliance + p.chamber_compliance + p.adapter_resistance + p.outlet_resistance +
                     p.mitral_resistance + p.mitral_leak_resistance + pressure;
  if (!good || !std::isfinite(sum))
    throw InputError(
        "circulation: pump with C_1 = {}, C_2 = {} mm3/Pa, R_VIA = {}, R_out = {}, R_MV = {}, R_back = {} Pa "
        "s/mm3, at {} Pa; expected finite values, C_1, C_2, R_VIA and R_MV positive, the others not negative",
        p.pump_compliance, p.chamber_compliance, p.adapter_resistance, p.outlet_resistance,
        p.mitral_resistance, p.mitral_leak_resistance, pressure);
}

void PumpChamber::advance(double time_s, double dt_s, double inflow) {
  const double end = time_s + dt_s, atrial = atrium_.at(end);
  const double c1 = parameters_.pump_compliance / dt_s, c2 = parameters_.chamber_compliance / dt_s;
  const double g = 1 / parameters_.adapter_resistance;
  const double source1 = c1 * pump_side_ + pump_.at(end), source2 = c2 * chamber_ + inflow;
  // (c1 + g) P1 - g P2 = source1,  (c2 + g + g_MV) P2 - g P1 = source2 + g_MV P_LA, with g_MV of the valve's
  // state. The net flow into P2 falls with P2 whatever the state, so that exactly one of them fits.
  const auto solve = [&](double mitral) {
    const double a = c1 + g, d = c2 + g + mitral, right = source2 + mitral * atrial;
    const double determinant =
        c1 * (c2 + mitral) + g * (c1 + c2 + mitral);  // a d - g^2, free of cancellation
    return std::pair{(d * source1 + g * right) / determinant, (a * right + g * source1) / determinant};
  };
  const double open = 1 / parameters_.mitral_resistance;
  const double shut = parameters_.mitral_leak_resistance > 0 ? 1 / parameters_.mitral_leak_resistance : 0;
  double conductance = open;
  auto [first, second] = solve(open);
  if (second > atrial) {
    conductance = shut;
    std::tie(first, second) = solve(shut);
  }
  pump_side_ = first;
  chamber_ = second;
  mitral_flow_ = conductance * (atrial - chamber_);
  inflow_ = inflow;
}

void PumpChamber::restore(const std::vector<double>& saved) {
  VALSALVA_ASSERT(saved.size() == 4);
  pump_side_ = saved[0];
  chamber_ = saved[1];
  mitral_flow_ = saved[2];
  inflow_ = saved[3];
}

}  // namespace valsalva::circulation
