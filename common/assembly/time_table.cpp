#include "assembly/time_table.hpp"

#include <algorithm>

#include "core/errors.hpp"

namespace valsalva::assembly {

TimeTable TimeTable::constant(double value) {
  return {{0}, {value}, ""};
}

TimeTable TimeTable::ramp(double end_s, double last) {
  return {{0, end_s}, {0, last}, ""};
}

TimeTable::TimeTable(std::vector<double> time_s, std::vector<double> factor, const std::string& what)
    : time_(std::move(time_s)), factor_(std::move(factor)) {
  if (time_.empty() || time_.size() != factor_.size())
    throw InputError("{}: time_s has {} entries and factor {}; expected as many, at least one", what,
                     time_.size(), factor_.size());
  if (std::adjacent_find(time_.begin(), time_.end(), std::greater_equal<>()) != time_.end())
    throw InputError("{}: time_s does not ascend; expected every time above the one before", what);
}

double TimeTable::operator()(double time_s) const {
  const auto next = std::upper_bound(time_.begin(), time_.end(), time_s);
  if (next == time_.begin()) return factor_.front();
  if (next == time_.end()) return factor_.back();
  const std::size_t i = next - time_.begin();
  const double share = (time_s - time_[i - 1]) / (time_[i] - time_[i - 1]);
  return factor_[i - 1] + share * (factor_[i] - factor_[i - 1]);
}

}  // namespace valsalva::assembly
