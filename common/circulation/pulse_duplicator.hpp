// What drives the valve in a pulse duplicator: a piston pump behind a viscoelastic impedance adapter (VIA),
// as pulse-duplicator-2020 models it (Fig. 3; values in its section on boundary conditions).
//
// Adapter (their porcine valve): the pump's pressure is known.
//
//   P_pump(t) --R_1--+--R_2-- domain        C dP_C/dt = (P_pump - P_C) / R_1 - Q
//                    C                      P = P_C - R_2 Q
//
// Chamber (their bovine pericardial valve): the pump's flow and the atrium's pressure are known.
//
//   Q_pump(t) --+--R_VIA--+--R_out-- domain     C_1 dP_1/dt = Q_pump - (P_1 - P_2) / R_VIA
//              C_1       C_2                    C_2 dP_2/dt = (P_1 - P_2) / R_VIA + Q_MV - Q
//                         |                     P = P_2 - R_out Q
//   P_LA(t) --R_MV, diode-+                     Q_MV = max(0, P_LA - P_2) / R_MV - max(0, P_2 - P_LA) /
//   R_back
//
// Q is the flow into the domain (the inflow of a terminal, negative). R_back: a mitral valve that leaks; none
// (0) is a diode. The adapter's step is exact for data constant during it; the chamber's is backward Euler
// with the mitral valve's state solved together with the pressures: both are stable for any step, resistance
// and compliance.
// Pressures Pa, flows mm3/s, R Pa s/mm3, C mm3/Pa.
#pragma once

#include "circulation/terminal.hpp"
#include "circulation/waveform.hpp"

namespace valsalva::circulation {

struct AdapterParameters {
  double inner_resistance = 0;  ///< R_1, > 0
  double outer_resistance = 0;  ///< R_2, >= 0
  double compliance = 0;        ///< C, > 0
};

class ImpedanceAdapter final : public Terminal {
 public:
  /// InputError for parameters outside their ranges.
  ImpedanceAdapter(const AdapterParameters& parameters, Waveform pump_pressure, double stored_pressure);
  std::string name() const override { return "impedance adapter"; }
  void advance(double time_s, double dt_s, double inflow) override;
  double pressure() const override { return stored_ + parameters_.outer_resistance * inflow_; }
  std::vector<double> save() const override { return {stored_, inflow_}; }
  void restore(const std::vector<double>& saved) override;
  double stored_pressure() const { return stored_; }  ///< P_C

 private:
  AdapterParameters parameters_;
  Waveform pump_;
  double stored_, inflow_ = 0;
};

struct ChamberParameters {
  double pump_compliance = 0;         ///< C_1, > 0
  double chamber_compliance = 0;      ///< C_2, > 0
  double adapter_resistance = 0;      ///< R_VIA, > 0
  double outlet_resistance = 0;       ///< R_out, >= 0
  double mitral_resistance = 0;       ///< R_MV, > 0
  double mitral_leak_resistance = 0;  ///< R_back; 0: none passes
};

class PumpChamber final : public Terminal {
 public:
  /// pressure: of both compliances at the start. InputError for parameters outside their ranges.
  PumpChamber(const ChamberParameters& parameters, Waveform pump_flow, Waveform atrial_pressure,
              double pressure);
  std::string name() const override { return "pump"; }
  void advance(double time_s, double dt_s, double inflow) override;
  double pressure() const override { return chamber_ + parameters_.outlet_resistance * inflow_; }
  std::vector<double> save() const override { return {pump_side_, chamber_, mitral_flow_, inflow_}; }
  void restore(const std::vector<double>& saved) override;
  double chamber_pressure() const { return chamber_; }      ///< P_2
  double pump_side_pressure() const { return pump_side_; }  ///< P_1
  double mitral_flow() const { return mitral_flow_; }

 private:
  ChamberParameters parameters_;
  Waveform pump_, atrium_;
  double pump_side_, chamber_, mitral_flow_ = 0, inflow_ = 0;
};

}  // namespace valsalva::circulation
