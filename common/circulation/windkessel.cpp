#include "circulation/windkessel.hpp"

#include <cmath>

#include "core/errors.hpp"

namespace valsalva::circulation {

Windkessel::Windkessel(const WindkesselParameters& parameters, double stored_pressure)
    : parameters_(parameters), stored_(stored_pressure) {
  const auto& [rc, rp, c] = parameters;
  if (!(rc >= 0) || !(rp > 0) || !(c > 0) || !std::isfinite(rc + rp + c) || !std::isfinite(stored_pressure))
    throw InputError(
        "circulation: Windkessel with R_c = {} Pa s/mm3, R_p = {} Pa s/mm3, C = {} mm3/Pa, P_Wk = {} Pa; "
        "expected finite values with R_c >= 0, R_p > 0, C > 0",
        rc, rp, c, stored_pressure);
}

void Windkessel::advance(double, double dt_s, double inflow) {
  const double steady = parameters_.peripheral_resistance * inflow;
  const double tau = parameters_.peripheral_resistance * parameters_.compliance;
  stored_ = steady + (stored_ - steady) * std::exp(-dt_s / tau);
  inflow_ = inflow;
}

void Windkessel::restore(const std::vector<double>& saved) {
  VALSALVA_ASSERT(saved.size() == 2);
  stored_ = saved[0];
  inflow_ = saved[1];
}

Resistance::Resistance(double resistance, double distal_pressure)
    : resistance_(resistance), distal_(distal_pressure) {
  if (!(resistance >= 0) || !std::isfinite(resistance) || !std::isfinite(distal_pressure))
    throw InputError("circulation: resistance {} Pa s/mm3 to {} Pa; expected a finite one >= 0", resistance,
                     distal_pressure);
}

void Resistance::advance(double, double, double inflow) {
  inflow_ = inflow;
}

void Resistance::restore(const std::vector<double>& saved) {
  VALSALVA_ASSERT(saved.size() == 1);
  inflow_ = saved[0];
}

}  // namespace valsalva::circulation
