#include "circulation/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/errors.hpp"

namespace valsalva::circulation {

PeriodicBeat periodic_beat(const LeftHeartParameters& heart_parameters, const WindkesselParameters& arteries,
                           const IdealValve& valve) {
  if (!(valve.inertance > 0) || !(valve.resistance >= 0))
    throw InputError("circulation: ideal valve with R = {} Pa s/mm3, L = {} g/mm4; expected R >= 0, L > 0",
                     valve.resistance, valve.inertance);
  constexpr int steps_per_beat = 4000, most_beats = 400;
  constexpr double tolerance = 1e-5;
  // Of a large compliance's pressure exp(-T / RC) of what is missing is missing one beat later: a small
  // change says nothing then, and what is still to come is added every few beats, in which the heart has
  // followed.
  constexpr int between_jumps = 8;
  constexpr double slow = 0.8;
  const double left =
      std::exp(-heart_parameters.period_s / (arteries.peripheral_resistance * arteries.compliance));
  const double least_change = left > slow ? tolerance * (1 - left) / (1 - slow) : tolerance;
  const double dt = heart_parameters.period_s / steps_per_beat;
  // Any start leads to the same beat; this one is near a resting adult's.
  LeftHeart heart(heart_parameters, 1000.0 / heart_parameters.atrium.minimum,
                  1200.0 / heart_parameters.ventricle.minimum);
  Windkessel tree(arteries, 10e3);
  double flow = 0;
  PeriodicBeat beat;
  for (int n = 0; n < most_beats; ++n) {
    beat = {heart.atrial_volume(),
            heart.ventricular_volume(),
            tree.stored_pressure(),
            heart.ventricular_pressure(),
            tree.pressure(),
            0.0,
            0.0,
            tree.pressure(),
            tree.pressure(),
            0.0,
            0.0,
            0.0,
            n};
    for (int i = 0; i < steps_per_beat; ++i) {
      heart.advance(i * dt, dt, -flow);
      tree.advance(i * dt, dt, flow);
      const double push = heart.pressure() - tree.pressure();
      flow =
          std::max(0.0, (flow + dt / valve.inertance * push) / (1 + dt / valve.inertance * valve.resistance));
      beat.stroke_volume += dt * flow;
      if (flow > 0) beat.ejection_s += dt;
      beat.peak_flow = std::max(beat.peak_flow, flow);
      beat.least_aortic_pressure = std::min(beat.least_aortic_pressure, tree.pressure());
      beat.greatest_aortic_pressure = std::max(beat.greatest_aortic_pressure, tree.pressure());
      beat.mean_aortic_pressure += tree.pressure() / steps_per_beat;
      beat.peak_ventricular_pressure = std::max(beat.peak_ventricular_pressure, heart.ventricular_pressure());
    }
    const double of_heart = std::max(std::abs(heart.atrial_volume() / beat.atrial_volume - 1),
                                     std::abs(heart.ventricular_volume() / beat.ventricular_volume - 1));
    const double of_tree = tree.stored_pressure() / beat.stored_pressure - 1;
    if (of_heart < tolerance && std::abs(of_tree) < least_change) return beat;
    if (left <= slow || n % between_jumps != between_jumps - 1) continue;
    std::vector<double> stored = tree.save();
    stored[0] *= 1 + std::clamp(of_tree * left / (1 - left), -0.5, 0.5);
    tree.restore(stored);
  }
  throw NumericalFailure(
      "circulation: the 0D loop did not become periodic within {} beats; is there inflow (vein_flow), a "
      "finite "
      "peripheral resistance, and a ventricle that contracts?",
      most_beats);
}

}  // namespace valsalva::circulation
