// What the metrics read from the flow field. All functions are collective.
#pragma once

#include <vector>

#include "fluid/flow.hpp"

namespace valsalva::metrics {

/// Energy carried along +z through the face plane k, nJ/s: p Q + sum rho w^3 / 2 h^2 over the lumen, p the
/// given pressure of the plane (Pa).
double power_through(const fluid::Flow& flow, int plane, double pressure);

/// The largest velocity along +z on the lumen's face planes first..last, mm/s; zero when nothing flows that
/// way.
double largest_axial_velocity(const fluid::Flow& flow, int first, int last);

/// The part of a face plane that lies between a device and the wall: lumen faces further from the device's
/// axis than its skirt, direction by direction. What flows there passes the valve by.
class ParavalvularGap {
 public:
  /// skirt: nodes of the skirt. The plane is the one nearest to z_mm.
  ParavalvularGap(const fluid::Flow& flow, const Points& skirt, double z_mm);
  /// Flow along +z through the gap, mm3/s.
  double flow_through(const fluid::Flow& flow) const;
  double area_mm2() const { return area_mm2_; }

 private:
  int plane_;
  double area_mm2_ = 0;
  std::vector<std::array<int, 3>> faces_;  // of this rank: i, j, local k
};

}  // namespace valsalva::metrics
