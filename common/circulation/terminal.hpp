// What stands at an open end of the flow domain: a 0D model that turns flow into pressure.
//
// The flow is counted into the terminal (out of the domain), in mm3/s. The domain hands over the flow of its
// present step, the terminal answers with the pressure of the end of the step, Pa. The lag is harmless as
// long as the domain's inertance L = rho length / area exceeds R dt (about 2e-4 g/mm4 against 6e-7 for an
// aorta); beyond, the domain asks for answers to the flow of the step's end (coupling/implicit_ends.hpp).
// Every terminal is stable for any dt on its own.
#pragma once

#include <string>
#include <vector>

namespace valsalva::circulation {

class Terminal {
 public:
  virtual ~Terminal() = default;
  virtual std::string name() const = 0;
  /// From time_s to time_s + dt_s. inflow: the flow into the terminal, mm3/s.
  virtual void advance(double time_s, double dt_s, double inflow) = 0;
  /// At the domain's end plane, after the last advance; Pa.
  virtual double pressure() const = 0;
  /// All that a bitwise restart needs. restore takes what save gave.
  virtual std::vector<double> save() const = 0;
  virtual void restore(const std::vector<double>& saved) = 0;
};

}  // namespace valsalva::circulation
