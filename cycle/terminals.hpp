// The two ends of the flow domain: what the case asks for, brought up from rest.
//
// During the initialisation (time < initialisation_s) both ends rise from zero to the pressures at which the
// beat starts, s = t / initialisation_s, 3 s^2 - 2 s^3; resistances next to the domain act already. A heart
// with a Windkessel starts from the periodic beat of the 0D loop with an ideal valve.
//
// An end answers the flow Q of the step's start, as long as the slope Z = dP/dQ of its answer is small
// against the domain's inertance, Z dt / L <= 1/8; a larger one would make flow and pressure swing against
// each other, and grow from Z dt / L = 2 (5 mmHg s/mL in a valve at draft). Beyond, it answers the flow that
// the domain will have under that answer, from L dQ/dt = P_d - P with P_d as in the last step and half of L
// (so that the end is soft rather than unstable where L is overestimated):
//   Q' = Q + [dt/dt_last (Q - Q_last) + dt/L (P_last - P(Q))] / (1 + Z dt/L).
#pragma once

#include <memory>
#include <optional>

#include "circulation/closed_loop.hpp"
#include "circulation/terminal.hpp"
#include "circulation_case.hpp"

namespace valsalva::cycle {

class Terminals {
 public:
  /// inertance: rho length / area of the domain, g/mm4.
  Terminals(const CirculationParameters& p, double initialisation_s, double inertance);

  /// Brings both ends to time_s + dt_s. flows: along +z through the low and the high end, mm3/s.
  void advance(double time_s, double dt_s, double low_flow, double high_flow);
  double low_pressure() const { return low_Pa_; }
  double high_pressure() const { return high_Pa_; }

  /// Null where the upstream is not a heart.
  const circulation::LeftHeart* heart() const { return heart_; }
  /// Pressure in the ventricle: of the heart, else the pressure at the domain's low end.
  double ventricular_pressure() const;
  /// What the 0D loop expects; nothing without a heart and a Windkessel.
  const std::optional<circulation::PeriodicBeat>& expected() const { return expected_; }

  std::vector<double> save() const;
  void restore(const std::vector<double>& saved);

 private:
  CirculationParameters parameters_;
  double initialisation_s_, inertance_;
  std::unique_ptr<circulation::Terminal> low_, high_;
  circulation::LeftHeart* heart_ = nullptr;
  std::optional<circulation::PeriodicBeat> expected_;
  double low_start_Pa_ = 0, high_start_Pa_ = 0, low_Pa_ = 0, high_Pa_ = 0;
  double last_low_ = 0, last_high_ = 0, last_dt_s_ = 0;  ///< flows into the terminals, of the last step
};

}  // namespace valsalva::cycle
