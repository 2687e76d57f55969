#include "crimper.hpp"

#include <algorithm>

namespace valsalva::crimp {

Crimper::Crimper(double start_radius_mm, double end_radius_mm, double speed_mm_per_s, double ramp_s)
    : start_(start_radius_mm),
      end_(std::min(end_radius_mm, start_radius_mm)),
      speed_(speed_mm_per_s),
      ramp_(std::min(ramp_s, (start_ - end_) / speed_)),
      duration_((start_ - end_) / speed_ + ramp_) {}

double Crimper::speed_mm_per_s(double t) const {
  if (t <= 0 || t >= duration_) return 0;
  const double u = std::min({t, duration_ - t, ramp_}) / ramp_;
  return speed_ * u * u * (3 - 2 * u);
}

double Crimper::radius_mm(double t) const {
  if (t <= 0) return start_;
  if (t >= duration_) return end_;
  const auto ramped = [&](double u) { return speed_ * ramp_ * u * u * u * (1 - 0.5 * u); };
  if (t < ramp_) return start_ - ramped(t / ramp_);
  if (t > duration_ - ramp_) return end_ + ramped((duration_ - t) / ramp_);
  return start_ - speed_ * (t - 0.5 * ramp_);
}

}  // namespace valsalva::crimp
