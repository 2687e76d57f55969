// Left atrium and ventricle as time-varying elastances, the mitral valve as a diode.
//
//   Q_vein -> [LA] --R_MV, diode--> [LV] --R_LVOT--> domain
//
//   d(C_LA P_LA)/dt = Q_vein - Q_MV,  d(C_LV P_LV)/dt = Q_MV - Q_LVOT           (tavr-ifed-2022, eqs 7, 8)
//   P_LVOT = P_LV - R_LVOT Q_LVOT                                               (eq. 9)
//   Q_MV = max(0, (P_LA - P_LV) / R_MV)                                         (eq. 10)
//          - max(0, P_LV - P_LA) / R_back where the valve leaks (R_back > 0)
//   1/C = E(t) = k g1/(1+g1) 1/(1+g2) + E_min,  g = (t/tau)^m                   (eqs 11, 12)
//   k such that max E = E_max                                                   (eq. 13)
//
// The stored volumes V = C P include no unstressed volume: only their changes have a meaning. The step is
// backward Euler with the diode's state solved together with the volumes (the paper lags it): stable for any
// dt, first order, and volume is conserved to round-off.
#pragma once

#include "circulation/terminal.hpp"

namespace valsalva::circulation {

struct TwoHill {
  double tau1_s = 0, tau2_s = 0;    ///< > 0
  double m1 = 0, m2 = 0;            ///< > 0
  double minimum = 0, maximum = 0;  ///< E_min, E_max, Pa/mm3; 0 < E_min < E_max
  double shift_s = 0;               ///< the waveform starts this much after the beat does
};

/// E(t), periodic.
class Elastance {
 public:
  Elastance(const TwoHill& parameters, double period_s);
  double at(double time_s) const;          ///< Pa/mm3
  double scale() const { return scale_; }  ///< k

 private:
  double shape(double phase_s) const;
  TwoHill parameters_;
  double period_s_;
  double scale_ = 1;
};

struct LeftHeartParameters {
  double period_s = 0.8512;
  double vein_flow = 0;               ///< Q_vein, mm3/s, >= 0
  double mitral_resistance = 0;       ///< R_MV, Pa s/mm3, > 0
  double outflow_resistance = 0;      ///< R_LVOT, Pa s/mm3, >= 0
  double mitral_leak_resistance = 0;  ///< R_back, Pa s/mm3; 0: nothing passes the shut valve
  TwoHill atrium, ventricle;
};

/// The values of tavr-ifed-2022 (a healthy beat fitted to Murgo et al. 1980).
LeftHeartParameters healthy_left_heart();

class LeftHeart final : public Terminal {
 public:
  /// Volumes at the start, mm3. InputError for parameters outside their ranges.
  LeftHeart(const LeftHeartParameters& parameters, double atrial_volume, double ventricular_volume);
  std::string name() const override { return "heart"; }
  /// inflow: into the heart, so -Q_LVOT.
  void advance(double time_s, double dt_s, double inflow) override;
  double pressure() const override {
    return ventricular_pressure_ + parameters_.outflow_resistance * inflow_;
  }
  std::vector<double> save() const override;
  void restore(const std::vector<double>& saved) override;

  double ventricular_pressure() const { return ventricular_pressure_; }
  double atrial_pressure() const { return atrial_pressure_; }
  double mitral_flow() const { return mitral_flow_; }
  double ventricular_volume() const { return ventricular_volume_; }
  double atrial_volume() const { return atrial_volume_; }
  const LeftHeartParameters& parameters() const { return parameters_; }

 private:
  LeftHeartParameters parameters_;
  Elastance atrium_, ventricle_;
  double atrial_volume_, ventricular_volume_;
  double atrial_pressure_ = 0, ventricular_pressure_ = 0, mitral_flow_ = 0, inflow_ = 0;
};

}  // namespace valsalva::circulation
