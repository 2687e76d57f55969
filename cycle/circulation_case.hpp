// The table [circulation] of a case in internal units: what drives the valve, and what it works against.
#pragma once

#include <optional>

#include "circulation/left_heart.hpp"
#include "circulation/pulse_duplicator.hpp"
#include "circulation/waveform.hpp"
#include "circulation/windkessel.hpp"
#include "core/case.hpp"

namespace valsalva::cycle {

enum class Upstream { heart, flow, pressure, adapter, pump };
enum class Downstream { windkessel, resistance, pressure };

struct CirculationParameters {
  Upstream upstream = Upstream::heart;
  Downstream downstream = Downstream::windkessel;
  double period_s = 0.8512;
  circulation::LeftHeartParameters heart;
  circulation::WindkesselParameters windkessel;
  circulation::AdapterParameters adapter;
  circulation::ChamberParameters pump;
  std::optional<circulation::Waveform> flow, pressure;   ///< mm3/s, Pa: of the domain's end or of the pump
  std::optional<circulation::Waveform> atrial_pressure;  ///< Pa, beside a pump
  double end_diastolic_Pa = 0, aortic_Pa = 0, outlet_resistance = 0;
};

/// InputError names the case file and the key.
CirculationParameters read_circulation(const Case& scene);

}  // namespace valsalva::cycle
