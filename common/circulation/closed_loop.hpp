// The whole circulation in 0D, with an ideal aortic valve in the place of the flow domain: where a beat
// should start, so that the first simulated beat is already near the periodic one.
//
//   L dQ/dt = P_LVOT - P_Ao - R Q,  Q >= 0.
#pragma once

#include "circulation/left_heart.hpp"
#include "circulation/windkessel.hpp"

namespace valsalva::circulation {

struct IdealValve {
  double resistance = 0;  ///< R, Pa s/mm3, when open
  double inertance = 0;   ///< L, g/mm4, > 0
};

/// The periodic state at the start of ventricular contraction, and its beat.
struct PeriodicBeat {
  double atrial_volume = 0, ventricular_volume = 0;      ///< mm3
  double stored_pressure = 0;                            ///< P_Wk, Pa
  double ventricular_pressure = 0, aortic_pressure = 0;  ///< Pa, at the start
  double stroke_volume = 0;                              ///< mm3
  double peak_ventricular_pressure = 0;                  ///< Pa
  double least_aortic_pressure = 0, greatest_aortic_pressure = 0, mean_aortic_pressure = 0;  ///< Pa
  double peak_flow = 0;                                                                      ///< mm3/s
  double ejection_s = 0;  ///< time with forward flow
  int beats = 0;          ///< until periodic
};

/// NumericalFailure when the loop is not periodic to 1e-5 after 400 beats (no inflow, no resistance).
PeriodicBeat periodic_beat(const LeftHeartParameters& heart, const WindkesselParameters& arteries,
                           const IdealValve& valve);

}  // namespace valsalva::circulation
