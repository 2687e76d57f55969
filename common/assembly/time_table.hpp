// A factor over time: linear between the given times, constant before the first and after the last.
#pragma once

#include <string>
#include <vector>

namespace valsalva::assembly {

class TimeTable {
 public:
  static TimeTable constant(double value);
  /// 0 at 0 s, `last` at end_s.
  static TimeTable ramp(double end_s, double last = 1);
  /// InputError with `what` when sizes differ or times do not ascend.
  TimeTable(std::vector<double> time_s, std::vector<double> factor, const std::string& what);
  double operator()(double time_s) const;

 private:
  std::vector<double> time_, factor_;
};

}  // namespace valsalva::assembly
