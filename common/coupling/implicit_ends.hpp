// 0D models behind places of known pressure, whose pressure is found together with the flow of the same time.
//
// After a projection with the pressures p*_i, which gave the outflows Q*_i, the step is one with
//   Q_i = Q*_i - dt sum_j S_ij (p_j - p*_j),   p_i = P_i(Q_i)
// S_ij: what a rise at j takes from the outflow of i (fluid::Flow::add_response), P_i: the model's answer
// over the step. Newton's iteration; then p - p* is added to the step (Flow::raise). Stable for any slope
// dP/dQ >= 0. The answer to the flow of the step before is stable for dP/dQ dt S below 1/2 or so in front of
// a column of fluid; in front of a beating valve a Windkessel swung at 0.09 already.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "fluid/flow.hpp"

namespace valsalva::coupling {

using Answer = std::function<double(double outflow)>;  ///< Pa at the end of the step, of mm3/s

/// Of dP/dQ dt S: up to here the answer to the flow of the step before will do.
constexpr double explicit_until = 0.0625;

/// The p_i above. taken: dt S, mm3/s per Pa. NumericalFailure when there are none.
std::vector<double> meet(const Eigen::MatrixXd& taken, const std::vector<double>& outflow,
                         const std::vector<double>& pressure, const std::vector<Answer>& answers);

/// dP/dQ over 1 mL/s, Pa s/mm3.
double slope(const Answer& answer, double outflow);

class ImplicitEnds {
 public:
  struct Place {
    fluid::PressurePlace at;
    std::function<double()> outflow;  ///< mm3/s, as the flow stands (collective)
  };
  /// The flow must outlive this object.
  explicit ImplicitEnds(fluid::Flow& flow) : flow_(flow) {}
  void add(Place place) { places_.push_back(std::move(place)); }

  /// What an end takes from its own outflow in a second, mm3/s per Pa and s (collective).
  double taken_by_itself(int place);
  /// Within Flow::after_projection. answers: of each place; empty: its pressure stays. The flow's known
  /// pressures are then those of the end of the step.
  fluid::StepReport settle(double dt, const fluid::StepReport& found, const std::vector<Answer>& answers);
  double outflow(int place) const { return places_[place].outflow(); }

 private:
  void find_response();

  fluid::Flow& flow_;
  std::vector<Place> places_;
  Eigen::MatrixXd taken_;  // S
  long version_ = -1;      // of the solids that it was found with
};

}  // namespace valsalva::coupling
