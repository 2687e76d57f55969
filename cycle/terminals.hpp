// The two ends of the flow domain: what the case asks for, brought up from rest.
//
// During the initialisation (time < initialisation_s) both ends rise from zero to the pressures at which the
// beat starts, s = t / initialisation_s, 3 s^2 - 2 s^3; resistances next to the domain act already. A heart
// with a Windkessel starts from the periodic beat of the 0D loop with an ideal valve.
//
// An end answers the flow of the step's start, P(Q), as long as the slope Z = dP/dQ of its answer is small
// against the domain's inertance, Z dt / L <= 1/8; a larger one makes flow and pressure swing against each
// other, and grow (from some mmHg s/mL in a valve at draft). Beyond, the pressure goes towards that answer
// within some ten steps and works against every change of the flow,
//   P' = P_last + a (1 - k) (P(Q) - P_last) + k a L/dt (Q - Q_last) dt/dt_last,
//   k = Z / (Z + a L/dt), a = 1/10,
// and settles at P = P(Q). A column of blood of any such inertance bears that for any Z. The flow domain, in
// which fluid also goes through what is solid until the next step, was stable at Z dt / L = 0.5 and not at
// 0.9 (5 and 9 mmHg s/mL at draft): ends steeper than 0.4 L / dt are refused.
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
  /// InputError that names the end whose answer is steeper than 0.4 L / largest_step_s. A prescribed flow is
  /// not looked at.
  void require_bearable(double largest_step_s, const std::string& file);
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
