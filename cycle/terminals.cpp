#include "terminals.hpp"

#include <algorithm>

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::cycle {

namespace {

using namespace circulation;

// An open valve of about 1.7 cm2: only the start of the beat depends on it.
constexpr double ideal_valve_resistance = 0.02 * units::resistance_per_mmHg_s_per_mL;

double smooth(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

}  // namespace

Terminals::Terminals(const CirculationParameters& p, double initialisation_s, double inertance)
    : parameters_(p), initialisation_s_(initialisation_s), inertance_(inertance) {
  const bool heart = p.upstream == Upstream::heart, windkessel = p.downstream == Downstream::windkessel;
  auto& [low, high] = end_;
  double stored = p.aortic_Pa;
  low.start = p.end_diastolic_Pa;
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
    low.start = heart_->ventricular_pressure();
    low.resistance = p.heart.outflow_resistance;
    low.model = std::move(left_heart);
  } else if (p.upstream == Upstream::flow) {
    low.model = std::make_unique<FlowSource>(*p.flow, inertance, p.end_diastolic_Pa);
  } else if (p.upstream == Upstream::adapter) {
    low.start = p.pressure->at(0);
    low.model = std::make_unique<ImpedanceAdapter>(p.adapter, *p.pressure, low.start);
  } else if (p.upstream == Upstream::pump) {
    low.model = std::make_unique<PumpChamber>(p.pump, *p.flow, *p.atrial_pressure, p.end_diastolic_Pa);
  } else {
    low.model = std::make_unique<PressureSource>(*p.pressure);
    low.start = p.pressure->at(0);
  }
  if (windkessel) {
    high.start = stored;
    high.resistance = p.windkessel.characteristic_resistance;
    high.model = std::make_unique<Windkessel>(p.windkessel, stored);
  } else {
    high.start = p.aortic_Pa;
    high.resistance = p.downstream == Downstream::resistance ? p.outlet_resistance : 0.0;
    high.model = std::make_unique<Resistance>(high.resistance, p.aortic_Pa);
  }
}

/// The model has then gone to the end of the step with this flow.
double Terminals::answer(End& end, double outflow) {
  if (time_s_ < initialisation_s_)
    return smooth((time_s_ + dt_s_) / initialisation_s_) * end.start + end.resistance * outflow;
  end.model->restore(end.before);
  end.model->advance(time_s_ - initialisation_s_, dt_s_, outflow);
  return end.model->pressure();
}

void Terminals::begin(double time_s, double dt_s, double low_flow, double high_flow) {
  time_s_ = time_s;
  dt_s_ = dt_s;
  const std::array<double, 2> outflow{-low_flow, high_flow};
  for (int e = 0; e < 2; ++e) {
    End& end = end_[e];
    end.before = end.model->save();
    const auto of = [&](double q) { return answer(end, q); };
    end.steep = coupling::slope(of, outflow[e]) * dt_s / inertance_ > coupling::explicit_until;
    if (end.steep) {
      end.model->restore(end.before);
    } else {
      end.pressure = of(outflow[e]);
    }
  }
}

std::array<coupling::Answer, 2> Terminals::answers() {
  std::array<coupling::Answer, 2> out;
  for (int e = 0; e < 2; ++e)
    if (end_[e].steep) out[e] = [this, e](double outflow) { return answer(end_[e], outflow); };
  return out;
}

void Terminals::finish(const std::array<double, 2>& outflow, const std::array<double, 2>& pressure) {
  for (int e = 0; e < 2; ++e) {
    if (!end_[e].steep) continue;
    answer(end_[e], outflow[e]);
    end_[e].pressure = pressure[e];
  }
}

double Terminals::ventricular_pressure() const {
  // Before the beat the heart stands still at its starting volume.
  return heart_ ? heart_->ventricular_pressure() : low_pressure();
}

std::vector<double> Terminals::save() const {
  std::vector<double> saved{low_pressure(), high_pressure()};
  for (const End& end : end_)
    for (const double v : end.model->save()) saved.push_back(v);
  return saved;
}

void Terminals::restore(const std::vector<double>& saved) {
  const std::size_t low = end_[0].model->save().size(), high = end_[1].model->save().size();
  if (saved.size() != end_.size() + low + high)
    throw InputError("the state's circulation has {} numbers, this case's needs {}", saved.size(),
                     end_.size() + low + high);
  for (int e = 0; e < 2; ++e) end_[e].pressure = saved[e];
  const auto of_low = saved.begin() + static_cast<long>(end_.size()),
             of_high = of_low + static_cast<long>(low);
  end_[0].model->restore({of_low, of_high});
  end_[1].model->restore({of_high, saved.end()});
}

}  // namespace valsalva::cycle
