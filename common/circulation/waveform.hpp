// A periodic function of time through given knots, and the terminals that prescribe one.
//
// Between knots a monotone cubic (Fritsch and Butland 1984, harmonic mean of the neighbouring slopes): passes
// through every knot, never overshoots, has a continuous derivative, and is periodic.
#pragma once

#include <string>
#include <vector>

#include "circulation/terminal.hpp"

namespace valsalva::circulation {

class Waveform {
 public:
  /// time: increasing, from 0 up to below period_s; at least two knots. `what` names it in an InputError.
  Waveform(std::vector<double> time_s, std::vector<double> value, double period_s, const std::string& what);
  double at(double time_s) const;
  double period_s() const { return period_s_; }
  /// Over one period, exact for the cubic.
  double integral() const;

 private:
  std::vector<double> time_, value_, slope_;  // the first knot repeated at the period's end
  double period_s_;
};

/// A systolic flow, Q(t) = Q_peak (s (1 - s)^2 27/4), s = t / ejection_s, zero in diastole: the peak stands
/// at a third of ejection, as measured aortic flows do. Unit of the flow: volume per second.
Waveform systolic_flow(double stroke_volume, double ejection_s, double period_s);

/// A ventricular pressure: from end_diastolic to peak and back as sin^2 within systole_s, constant after it.
Waveform systolic_pressure(double end_diastolic, double peak, double systole_s, double period_s);

class PressureSource final : public Terminal {
 public:
  explicit PressureSource(Waveform pressure_Pa);
  std::string name() const override { return "pressure"; }
  void advance(double time_s, double dt_s, double inflow) override;
  double pressure() const override { return pressure_; }
  std::vector<double> save() const override { return {pressure_}; }
  void restore(const std::vector<double>& saved) override;

 private:
  Waveform waveform_;
  double pressure_;
};

/// A pump that drives a given flow Q*(t) into the domain, by a pressure that answers the flow's error
/// e = Q* - Q:  P = L dQ*/dt + Z (e + 1/(4 tau) int e dt),  Z = L / tau,  tau = 2 ms,  L the domain's
/// inertance: critically damped for L dQ/dt = P, and stable under the lag of one step for dt < tau.
class FlowSource final : public Terminal {
 public:
  /// flow: mm3/s into the domain. inertance: rho length / area of the domain, g/mm4.
  FlowSource(Waveform flow, double inertance, double start_pressure);
  std::string name() const override { return "flow"; }
  void advance(double time_s, double dt_s, double inflow) override;
  double pressure() const override { return pressure_; }
  std::vector<double> save() const override { return {held_, pressure_}; }
  void restore(const std::vector<double>& saved) override;

 private:
  Waveform waveform_;
  double inertance_;
  double held_;  // the integral part, Pa
  double pressure_;
};

}  // namespace valsalva::circulation
