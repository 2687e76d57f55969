// The motion of the crimper: a cylinder about the z axis whose radius closes from R0 to R1 at constant speed,
// with a smooth start and stop.
//
//   speed(t) = v S(t / t_r) while starting, v, then v S((T - t) / t_r) while stopping, S(u) = u^2 (3 - 2 u),
//   T = (R0 - R1) / v + t_r
// When the way is too short to reach v, the ramps are shortened to (R0 - R1) / v each. mm, s.
#pragma once

namespace valsalva::crimp {

class Crimper {
 public:
  Crimper(double start_radius_mm, double end_radius_mm, double speed_mm_per_s, double ramp_s);
  double radius_mm(double time_s) const;
  double speed_mm_per_s(double time_s) const;
  /// T: closed from here on.
  double duration_s() const { return duration_; }

 private:
  double start_, end_, speed_, ramp_, duration_;
};

}  // namespace valsalva::crimp
