#include "terminals.hpp"

#include <algorithm>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::cycle {

namespace {

using namespace circulation;

// An open valve of about 1.7 cm2: only the start of the beat depends on it.
constexpr double ideal_valve_resistance = 0.02 * units::resistance_per_mmHg_s_per_mL;

constexpr double lag_until = 0.125, softness = 0.1, flow_probe = 1000, most_per_step = 0.4;
constexpr std::size_t own_numbers = 5;

double smooth(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

}  // namespace

Terminals::Terminals(const CirculationParameters& p, double initialisation_s, double inertance)
    : parameters_(p), initialisation_s_(initialisation_s), inertance_(inertance) {
  const bool heart = p.upstream == Upstream::heart, windkessel = p.downstream == Downstream::windkessel;
  double stored = p.aortic_Pa;
  low_start_Pa_ = p.end_diastolic_Pa;
  if (heart) {
    double atrial = 1000.0 / p.heart.atrium.minimum,
           ventricular = p.end_diastolic_Pa / p.heart.ventricle.minimum;
    if (windkessel) {
      expected_ = periodic_beat(p.heart, p.windkessel, {ideal_valve_resistance, inertance});
      atrial = expected_->atrial_volume;
      ventricular = expected_->ventricular_volume;
      stored = expected_->stored_pressure;
    }
    auto left_heart = std::make_unique<LeftHeart>(p.heart, atrial, ventricular);
    heart_ = left_heart.get();
    low_start_Pa_ = heart_->ventricular_pressure();
    low_ = std::move(left_heart);
  } else if (p.upstream == Upstream::flow) {
    low_ = std::make_unique<FlowSource>(*p.flow, inertance, p.end_diastolic_Pa);
  } else if (p.upstream == Upstream::adapter) {
    low_start_Pa_ = p.pressure->at(0);
    low_ = std::make_unique<ImpedanceAdapter>(p.adapter, *p.pressure, low_start_Pa_);
  } else if (p.upstream == Upstream::pump) {
    low_ = std::make_unique<PumpChamber>(p.pump, *p.flow, *p.atrial_pressure, p.end_diastolic_Pa);
  } else {
    low_ = std::make_unique<PressureSource>(*p.pressure);
    low_start_Pa_ = p.pressure->at(0);
  }
  high_start_Pa_ = stored;
  if (windkessel) {
    high_ = std::make_unique<Windkessel>(p.windkessel, stored);
  } else {
    high_ = std::make_unique<Resistance>(p.downstream == Downstream::resistance ? p.outlet_resistance : 0.0,
                                         p.aortic_Pa);
    high_start_Pa_ = p.aortic_Pa;
  }
}

void Terminals::advance(double time_s, double dt_s, double low_flow, double high_flow) {
  const bool beating = time_s >= initialisation_s_;
  const double share = beating ? 1 : smooth((time_s + dt_s) / initialisation_s_);
  const auto meet = [&](circulation::Terminal& terminal, double resistance, double start, double flow,
                        double last_flow, double before) {
    const std::vector<double> kept = terminal.save();
    const auto answer = [&](double inflow) {
      if (!beating) return share * start + resistance * inflow;
      terminal.restore(kept);
      terminal.advance(time_s - initialisation_s_, dt_s, inflow);
      return terminal.pressure();
    };
    const double plain = answer(flow), slope = (answer(flow + flow_probe) - plain) / flow_probe;
    if (!(slope * dt_s / inertance_ > lag_until)) return answer(flow);
    const double soft = softness * inertance_ / dt_s, stiff = slope / (soft + slope);
    const double change = last_dt_s_ > 0 ? dt_s / last_dt_s_ * (flow - last_flow) : 0;
    const double wanted = before + softness * (1 - stiff) * (plain - before) + stiff * soft * change;
    return answer(flow + (wanted - plain) / slope);
  };
  const double low_resistance = heart_ ? parameters_.heart.outflow_resistance : 0;
  const double high_resistance =
      parameters_.downstream == Downstream::windkessel   ? parameters_.windkessel.characteristic_resistance
      : parameters_.downstream == Downstream::resistance ? parameters_.outlet_resistance
                                                         : 0;
  low_Pa_ = meet(*low_, low_resistance, low_start_Pa_, -low_flow, last_low_, low_Pa_);
  high_Pa_ = meet(*high_, high_resistance, high_start_Pa_, high_flow, last_high_, high_Pa_);
  last_low_ = -low_flow;
  last_high_ = high_flow;
  last_dt_s_ = dt_s;
}

void Terminals::require_bearable(double largest_step_s, const std::string& file) {
  const double most = most_per_step * inertance_ / largest_step_s;
  const auto check = [&](circulation::Terminal& terminal, const char* which) {
    const std::vector<double> kept = terminal.save();
    const auto answer = [&](double inflow) {
      terminal.restore(kept);
      terminal.advance(0, largest_step_s, inflow);
      return terminal.pressure();
    };
    const double slope = (answer(flow_probe) - answer(0)) / flow_probe;
    terminal.restore(kept);
    if (slope > most)
      throw InputError(
          "{}: circulation: the {} end resists with {:.4g} mmHg s/mL within a step of {:.3g} s; expected at "
          "most {:.4g}, "
          "what the inertance of the blood in the vessel bears. Use a smaller cycle.max_step_s, or a smaller "
          "resistance or "
          "larger compliance there",
          file, which, slope / units::resistance_per_mmHg_s_per_mL, largest_step_s,
          most / units::resistance_per_mmHg_s_per_mL);
  };
  if (parameters_.upstream != Upstream::flow) check(*low_, "ventricle's");
  check(*high_, "aortic");
}

double Terminals::ventricular_pressure() const {
  // Before the beat the heart stands still at its starting volume.
  return heart_ ? heart_->ventricular_pressure() : low_Pa_;
}

std::vector<double> Terminals::save() const {
  std::vector<double> saved{low_Pa_, high_Pa_, last_low_, last_high_, last_dt_s_};
  for (const double v : low_->save()) saved.push_back(v);
  for (const double v : high_->save()) saved.push_back(v);
  return saved;
}

void Terminals::restore(const std::vector<double>& saved) {
  const std::size_t low = low_->save().size(), high = high_->save().size();
  if (saved.size() != own_numbers + low + high)
    throw InputError("the state's circulation has {} numbers, this case's needs {}", saved.size(),
                     own_numbers + low + high);
  low_Pa_ = saved[0];
  high_Pa_ = saved[1];
  last_low_ = saved[2];
  last_high_ = saved[3];
  last_dt_s_ = saved[4];
  const auto of_low = saved.begin() + own_numbers, of_high = of_low + static_cast<long>(low);
  low_->restore({of_low, of_high});
  high_->restore({of_high, saved.end()});
}

}  // namespace valsalva::cycle
