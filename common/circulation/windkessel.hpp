// Three-element Windkessel and plain resistance: the arterial tree behind the aortic end.
//
//        R_c        R_p
//   ----/\/\/--+--/\/\/-- 0        C dP_Wk/dt = Q - P_Wk / R_p           (tavr-ifed-2022, eq. 5)
//   P     P_Wk = C                 P = P_Wk + R_c Q                      (eq. 6)
//              |
//              0
//
// The step is exact for a flow that is constant during it:
//   P_Wk(t + dt) = R_p Q + (P_Wk(t) - R_p Q) exp(-dt / (R_p C)).
// Parameters of the paper: R_c 0.042, R_p 0.9046 mmHg s/mL, C 1.9504 mL/mmHg.
#pragma once

#include "circulation/terminal.hpp"

namespace valsalva::circulation {

struct WindkesselParameters {
  double characteristic_resistance = 0;  ///< R_c, Pa s/mm3, >= 0
  double peripheral_resistance = 0;      ///< R_p, Pa s/mm3, > 0
  double compliance = 0;                 ///< C, mm3/Pa, > 0
};

class Windkessel final : public Terminal {
 public:
  /// stored_pressure: P_Wk at the start, Pa. InputError for parameters outside their ranges.
  Windkessel(const WindkesselParameters& parameters, double stored_pressure);
  std::string name() const override { return "windkessel"; }
  void advance(double time_s, double dt_s, double inflow) override;
  double pressure() const override { return stored_ + parameters_.characteristic_resistance * inflow_; }
  std::vector<double> save() const override { return {stored_, inflow_}; }
  void restore(const std::vector<double>& saved) override;
  double stored_pressure() const { return stored_; }  ///< P_Wk

 private:
  WindkesselParameters parameters_;
  double stored_;
  double inflow_ = 0;
};

/// P = P_distal + R Q.
class Resistance final : public Terminal {
 public:
  /// resistance: Pa s/mm3, >= 0; distal_pressure: Pa.
  Resistance(double resistance, double distal_pressure);
  std::string name() const override { return "resistance"; }
  void advance(double time_s, double dt_s, double inflow) override;
  double pressure() const override { return distal_ + resistance_ * inflow_; }
  std::vector<double> save() const override { return {inflow_}; }
  void restore(const std::vector<double>& saved) override;

 private:
  double resistance_, distal_;
  double inflow_ = 0;
};

}  // namespace valsalva::circulation
