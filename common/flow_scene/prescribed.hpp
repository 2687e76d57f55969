// What a side of the box or an opening prescribes over time: factors, and places of known pressure with what
// stands behind them.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "circulation/windkessel.hpp"
#include "core/case.hpp"
#include "flow_scene/expression.hpp"

namespace valsalva::flow_scene {

/// A factor over time: a table (in the file or beside it), an expression, or 1. Keys of an entry of `table`.
class Factor {
 public:
  Factor(const Case& scene, const Case& entry, const std::string& table, const std::string& what);
  double operator()(double time_s) const;

 private:
  std::vector<double> time_, value_;
  double period_s_ = 0;
  std::optional<Expression> expression_;
};

/// pressure_Pa times the factor; or what a resistance or a Windkessel behind it answers to the flow.
class KnownPressure {
 public:
  KnownPressure(const Case& scene, const Case& entry, const std::string& table);
  double at(double time_s) const;  ///< Pa
  bool modelled() const { return terminal_ != nullptr; }
  /// Of a model, which stays as it is: its pressure after a time dt with this flow out of the box.
  double after(double time_s, double dt_s, double outflow) const;
  /// After a step with this flow out of the box, mm3/s.
  void advance(double time_s, double dt_s, double outflow);
  std::vector<double> save() const;
  /// From `at` on, which moves on. InputError when the saved values end before.
  void restore(const std::vector<double>& saved, std::size_t& at);

 private:
  double pressure_;
  std::shared_ptr<Factor> factor_;
  std::shared_ptr<circulation::Terminal> terminal_;  ///< none: the pressure is prescribed
};

}  // namespace valsalva::flow_scene
