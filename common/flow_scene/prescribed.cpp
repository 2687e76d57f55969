#include "flow_scene/prescribed.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "assembly/entry.hpp"
#include "core/units.hpp"

namespace valsalva::flow_scene {

namespace {

void read_table(const std::filesystem::path& file, const std::string& what, std::vector<double>& time,
                std::vector<double>& value) {
  std::ifstream in(file);
  if (!in) throw InputError("{}: factor_file '{}' cannot be read", what, file.string());
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    double t, f;
    if (!(fields >> t >> f)) continue;  // header, comment
    time.push_back(t);
    value.push_back(f);
  }
  if (time.empty())
    throw InputError("{}: factor_file '{}' holds no row of two numbers, time_s and factor", what,
                     file.string());
}

}  // namespace

Factor::Factor(const Case& scene, const Case& entry, const std::string& table, const std::string& what)
    : time_(entry.reals(table + ".time_s")),
      value_(entry.reals(table + ".factor")),
      period_s_(entry.real(table + ".period_s")) {
  const std::string &file = entry.text(table + ".factor_file"), &text = entry.text(table + ".factor_of_t");
  if ((!time_.empty() || !value_.empty()) + !file.empty() + !text.empty() > 1)
    throw InputError("{}: more than one of factor, factor_file, factor_of_t; expected one", what);
  if (!text.empty()) expression_.emplace(text, what + ", factor_of_t");
  if (expression_ && expression_->varies())
    throw InputError("{}: factor_of_t '{}' has x, y or z; expected t alone", what, text);
  if (!file.empty()) read_table(scene.resolve(file), what, time_, value_);
  if (time_.empty() && value_.empty()) return;
  const assembly::TimeTable checked(time_, value_, what);
  if (period_s_ > 0 && time_.back() > period_s_)
    throw InputError("{}: time_s ends at {} s, after period_s = {}", what, time_.back(), period_s_);
}

double Factor::operator()(double time_s) const {
  if (expression_) return (*expression_)(Vec3::Zero(), time_s);
  if (time_.empty()) return 1;
  double t = time_s;
  if (period_s_ > 0) t -= period_s_ * std::floor(t / period_s_);
  const auto next = std::upper_bound(time_.begin(), time_.end(), t);
  std::size_t to = next - time_.begin();
  const bool wraps = period_s_ > 0 && (to == 0 || to == time_.size());
  if (!wraps && to == 0) return value_.front();
  if (!wraps && to == time_.size()) return value_.back();
  const std::size_t from = to == 0 ? time_.size() - 1 : to - 1;
  const double start = to == 0 ? time_[from] - period_s_ : time_[from];
  const double end = to == time_.size() ? time_[0] + period_s_ : time_[to];
  if (to == time_.size()) to = 0;
  const double share = end > start ? (t - start) / (end - start) : 0;
  return value_[from] + share * (value_[to] - value_[from]);
}

KnownPressure::KnownPressure(const Case& scene, const Case& entry, const std::string& table) {
  const assembly::Entry e(scene, table, entry);
  pressure_ = e.real("pressure_Pa");
  factor_ = std::make_shared<Factor>(scene, entry, table, e.what());
  const double resistance = e.real("resistance_Pa_s_per_mL") / units::mm3_per_mL;
  const double compliance = e.real("compliance_mL_per_Pa") * units::mm3_per_mL;
  if (compliance > 0) {
    if (!(resistance > 0)) e.fail("compliance_mL_per_Pa needs a resistance_Pa_s_per_mL");
    const double characteristic = e.real("characteristic_Pa_s_per_mL") / units::mm3_per_mL;
    terminal_ = std::make_shared<circulation::Windkessel>(
        circulation::WindkesselParameters{characteristic, resistance, compliance}, pressure_);
  } else if (resistance > 0) {
    terminal_ = std::make_shared<circulation::Resistance>(resistance, pressure_);
  }
}

double KnownPressure::at(double time_s) const {
  return terminal_ ? terminal_->pressure() : pressure_ * (*factor_)(time_s);
}

void KnownPressure::advance(double time_s, double dt_s, double outflow) {
  if (terminal_) terminal_->advance(time_s, dt_s, outflow);
}

double KnownPressure::after(double time_s, double dt_s, double outflow) const {
  const std::vector<double> kept = terminal_->save();
  terminal_->advance(time_s, dt_s, outflow);
  const double pressure = terminal_->pressure();
  terminal_->restore(kept);
  return pressure;
}

std::vector<double> KnownPressure::save() const {
  return terminal_ ? terminal_->save() : std::vector<double>{};
}

void KnownPressure::restore(const std::vector<double>& saved, std::size_t& at) {
  if (!terminal_) return;
  const std::size_t count = terminal_->save().size();
  if (at + count > saved.size())
    throw InputError("the state does not hold what stands behind sides and openings; start anew");
  terminal_->restore({saved.begin() + static_cast<long>(at), saved.begin() + static_cast<long>(at + count)});
  at += count;
}

}  // namespace valsalva::flow_scene
