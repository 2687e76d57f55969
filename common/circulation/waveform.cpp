#include "circulation/waveform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::circulation {

namespace {

constexpr double flow_response_s = 2e-3;  // tau

double harmonic_slope(double left, double right) {
  return left * right > 0 ? 2 * left * right / (left + right) : 0.0;
}

}  // namespace

Waveform::Waveform(std::vector<double> time_s, std::vector<double> value, double period_s,
                   const std::string& what)
    : time_(std::move(time_s)), value_(std::move(value)), period_s_(period_s) {
  if (time_.size() != value_.size() || time_.size() < 2)
    throw InputError("{}: {} times and {} values; expected as many of each, at least two", what, time_.size(),
                     value_.size());
  if (!(period_s > 0) || !std::isfinite(period_s))
    throw InputError("{}: the period is {} s; expected a positive one", what, period_s);
  for (std::size_t i = 0; i < time_.size(); ++i) {
    if (!std::isfinite(time_[i]) || !std::isfinite(value_[i]))
      throw InputError("{}: knot {} is ({}, {}); expected finite numbers", what, i + 1, time_[i], value_[i]);
    if (time_[i] < 0 || time_[i] >= period_s || (i > 0 && time_[i] <= time_[i - 1]))
      throw InputError("{}: knot {} is at {} s; expected increasing times from 0 to below the period of {} s",
                       what, i + 1, time_[i], period_s);
  }
  time_.push_back(time_.front() + period_s);
  value_.push_back(value_.front());
  const std::size_t intervals = time_.size() - 1;
  auto chord = [&](std::size_t i) { return (value_[i + 1] - value_[i]) / (time_[i + 1] - time_[i]); };
  for (std::size_t i = 0; i < intervals; ++i)
    slope_.push_back(harmonic_slope(chord((i + intervals - 1) % intervals), chord(i)));
  slope_.push_back(slope_.front());
}

double Waveform::at(double time_s) const {
  double phase = std::fmod(time_s - time_.front(), period_s_);
  if (phase < 0) phase += period_s_;
  const double t = time_.front() + phase;
  const auto after = std::upper_bound(time_.begin() + 1, time_.end() - 1, t);
  const std::size_t i = static_cast<std::size_t>(after - time_.begin()) - 1;
  const double width = time_[i + 1] - time_[i], s = (t - time_[i]) / width, r = 1 - s;
  return r * r * (1 + 2 * s) * value_[i] + s * s * (1 + 2 * r) * value_[i + 1] +
         width * s * r * (r * slope_[i] - s * slope_[i + 1]);
}

double Waveform::integral() const {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < time_.size(); ++i) {
    const double width = time_[i + 1] - time_[i];
    sum += width * (value_[i] + value_[i + 1]) / 2 + width * width * (slope_[i] - slope_[i + 1]) / 12;
  }
  return sum;
}

Waveform systolic_flow(double stroke_volume, double ejection_s, double period_s) {
  if (!(stroke_volume > 0) || !(ejection_s > 0) || !(ejection_s < period_s))
    throw InputError(
        "systolic flow: stroke volume {}, ejection {} s of a period of {} s; expected a positive stroke "
        "volume "
        "and an ejection within the period",
        stroke_volume, ejection_s, period_s);
  constexpr int knots = 24;
  std::vector<double> time, value;
  for (int i = 0; i <= knots; ++i) {
    const double s = static_cast<double>(i) / knots;
    time.push_back(ejection_s * s);
    value.push_back(s * (1 - s) * (1 - s));
  }
  const double scale = stroke_volume / Waveform(time, value, period_s, "systolic flow").integral();
  for (double& v : value) v *= scale;
  return Waveform(time, value, period_s, "systolic flow");
}

Waveform systolic_pressure(double end_diastolic, double peak, double systole_s, double period_s) {
  if (!(systole_s > 0) || !(systole_s < period_s) || !(peak > end_diastolic))
    throw InputError(
        "ventricular pressure: from {} to {} Pa within {} s of a period of {} s; expected a rise within the "
        "period",
        end_diastolic, peak, systole_s, period_s);
  constexpr int knots = 24;
  std::vector<double> time, value;
  for (int i = 0; i <= knots; ++i) {
    const double s = static_cast<double>(i) / knots, sine = std::sin(std::numbers::pi * s);
    time.push_back(systole_s * s);
    value.push_back(end_diastolic + (peak - end_diastolic) * sine * sine);
  }
  return Waveform(time, value, period_s, "ventricular pressure");
}

PressureSource::PressureSource(Waveform pressure_Pa)
    : waveform_(std::move(pressure_Pa)), pressure_(waveform_.at(0)) {}

void PressureSource::advance(double time_s, double dt_s, double) {
  pressure_ = waveform_.at(time_s + dt_s);
}

void PressureSource::restore(const std::vector<double>& saved) {
  VALSALVA_ASSERT(saved.size() == 1);
  pressure_ = saved[0];
}

FlowSource::FlowSource(Waveform flow, double inertance, double start_pressure)
    : waveform_(std::move(flow)), inertance_(inertance), held_(start_pressure), pressure_(start_pressure) {
  if (!(inertance > 0) || !std::isfinite(inertance))
    throw InputError("circulation: the domain's inertance is {} g/mm4; expected a positive one", inertance);
}

void FlowSource::advance(double time_s, double dt_s, double inflow) {
  const double target = waveform_.at(time_s + dt_s), error = target + inflow;
  const double impedance = inertance_ / flow_response_s;
  held_ += impedance * error * dt_s / (4 * flow_response_s);
  pressure_ = held_ + impedance * error + inertance_ * (target - waveform_.at(time_s)) / dt_s;
}

void FlowSource::restore(const std::vector<double>& saved) {
  VALSALVA_ASSERT(saved.size() == 2);
  held_ = saved[0];
  pressure_ = saved[1];
}

}  // namespace valsalva::circulation
