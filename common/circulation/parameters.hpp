// The table [circulation] of a case in internal units: what drives the valve, and what it works against.
#pragma once

#include <optional>

#include "circulation/left_heart.hpp"
#include "circulation/pulse_duplicator.hpp"
#include "circulation/waveform.hpp"
#include "circulation/windkessel.hpp"
#include "core/case.hpp"

namespace valsalva::circulation {

enum class Upstream { heart, flow, pressure, adapter, pump };
enum class Downstream { windkessel, resistance, pressure };

struct Parameters {
  Upstream upstream = Upstream::heart;
  Downstream downstream = Downstream::windkessel;
  double period_s = 0.8512;
  LeftHeartParameters heart;
  WindkesselParameters windkessel;
  AdapterParameters adapter;
  ChamberParameters pump;
  std::optional<Waveform> flow, pressure;   ///< mm3/s, Pa: of the domain's end or of the pump
  std::optional<Waveform> atrial_pressure;  ///< Pa, beside a pump
  double end_diastolic_Pa = 0, aortic_Pa = 0, outlet_resistance = 0;
};

/// InputError names the case file and the key.
Parameters read_parameters(const Case& scene);

}  // namespace valsalva::circulation
