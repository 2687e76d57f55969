// The two ends of the flow domain: what the case asks for, brought up from rest.
//
// During the initialisation (time < initialisation_s) both ends rise from zero to the pressures at which the
// beat starts, s = t / initialisation_s, 3 s^2 - 2 s^3; resistances next to the domain act already. A heart
// with a Windkessel starts from the periodic beat of the 0D loop with an ideal valve.
//
// An end answers the flow of the step's start, P(Q), as long as the slope Z = dP/dQ of its answer is small
// against the domain's inertance, Z dt / L <= 1/16; a larger one would make flow and pressure swing against
// each other, and grow (from some mmHg s/mL in a valve at draft). Beyond, its pressure is found together with
// the flow of the step's end (coupling/implicit_ends.hpp): any slope.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "circulation/closed_loop.hpp"
#include "circulation/terminal.hpp"
#include "circulation_case.hpp"
#include "coupling/implicit_ends.hpp"

namespace valsalva::cycle {

class Terminals {
 public:
  /// inertance: rho length / area of the domain, g/mm4.
  Terminals(const CirculationParameters& p, double initialisation_s, double inertance);

  /// Before a step from time_s to time_s + dt_s: gentle ends go there with the flow at its start; steep ones
  /// keep their pressure until `finish`. low_flow, high_flow: along +z through the ends, mm3/s.
  void begin(double time_s, double dt_s, double low_flow, double high_flow);
  /// What the low and the high end answer to a flow out of the domain at the end of the step; empty for
  /// those that begin has brought there.
  std::array<coupling::Answer, 2> answers();
  /// Brings the steep ends to the end of the step, with the flows out of the domain and the pressures there.
  void finish(const std::array<double, 2>& outflow, const std::array<double, 2>& pressure);
  double low_pressure() const { return end_[0].pressure; }
  double high_pressure() const { return end_[1].pressure; }

  /// Null where the upstream is not a heart.
  const circulation::LeftHeart* heart() const { return heart_; }
  /// Pressure in the ventricle: of the heart, else the pressure at the domain's low end.
  double ventricular_pressure() const;
  /// What the 0D loop expects; nothing without a heart and a Windkessel.
  const std::optional<circulation::PeriodicBeat>& expected() const { return expected_; }

  std::vector<double> save() const;
  void restore(const std::vector<double>& saved);

 private:
  struct End {
    std::unique_ptr<circulation::Terminal> model;
    double resistance = 0;            ///< next to the domain, which acts before the beat already, Pa s/mm3
    double start = 0;                 ///< pressure at which the beat starts, Pa
    double pressure = 0;              ///< at the end of the last step, Pa
    bool steep = false;               ///< in the running step
    std::vector<double> before = {};  ///< the model at the start of the running step
  };
  double answer(End& end, double outflow);

  CirculationParameters parameters_;
  double initialisation_s_, inertance_;
  std::array<End, 2> end_;  ///< low, high
  circulation::LeftHeart* heart_ = nullptr;
  std::optional<circulation::PeriodicBeat> expected_;
  double time_s_ = 0, dt_s_ = 0;  ///< of the running step
};

}  // namespace valsalva::cycle
