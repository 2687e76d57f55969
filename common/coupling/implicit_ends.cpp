#include "coupling/implicit_ends.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/mpi.hpp"

namespace valsalva::coupling {

namespace {

constexpr double probe = 1000;  // mm3/s
constexpr int most_iterations = 50;
constexpr double close = 1e-12, close_enough = 1e-6;  // of the pressures

}  // namespace

double slope(const Answer& answer, double outflow) {
  return (answer(outflow + probe) - answer(outflow)) / probe;
}

std::vector<double> meet(const Eigen::MatrixXd& taken, const std::vector<double>& outflow,
                         const std::vector<double>& pressure, const std::vector<Answer>& answers) {
  const auto n = static_cast<Eigen::Index>(answers.size());
  const Eigen::Map<const Eigen::VectorXd> free(outflow.data(), n), before(pressure.data(), n);
  Eigen::VectorXd flow = free, known = before, answer(n), slopes(n), last_flow = free, last_answer(n);
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    for (Eigen::Index i = 0; i < n; ++i) {
      answer[i] = answers[i](flow[i]);
      // The secant: diodes have a kink that a derivative beside it does not see.
      if (iteration == 0) {
        slopes[i] = slope(answers[i], flow[i]);
      } else if (flow[i] != last_flow[i]) {
        slopes[i] = std::max(0.0, (answer[i] - last_answer[i]) / (flow[i] - last_flow[i]));
      }
    }
    last_flow = flow;
    last_answer = answer;
    // p = P + Z (free - dt S (p - before) - flow)
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(n, n) + slopes.asDiagonal() * taken;
    const Eigen::VectorXd right =
        answer + slopes.cwiseProduct(free - flow) + slopes.asDiagonal() * (taken * before);
    const Eigen::VectorXd next = left.partialPivLu().solve(right);
    const double change = (next - known).lpNorm<Eigen::Infinity>();
    known = next;
    flow = free - taken * (known - before);
    if (change <= close * known.lpNorm<Eigen::Infinity>()) break;
    // Round-off is that of the pressures that would stop the flows.
    const double size = std::max(known.lpNorm<Eigen::Infinity>(), before.lpNorm<Eigen::Infinity>()) +
                        free.cwiseQuotient(taken.diagonal().cwiseMax(1e-300)).lpNorm<Eigen::Infinity>();
    if (iteration + 1 == most_iterations && !(change <= close_enough * size))
      throw NumericalFailure(
          "coupling: the models behind the ends and the flow found no common pressure in {} iterations, "
          "which "
          "still changes by {:.3g} Pa. Use a smaller time step",
          most_iterations, change);
  }
  return {known.data(), known.data() + n};
}

void ImplicitEnds::find_response() {
  const long version = flow_.solids().version();
  if (!mpi::any(flow_.slab().comm, version_ != version)) return;
  version_ = version;
  const auto n = static_cast<Eigen::Index>(places_.size());
  taken_.resize(n, n);
  fluid::FaceField kept(flow_.slab());
  kept.swap(flow_.velocity());
  for (Eigen::Index j = 0; j < n; ++j) {
    for (int d = 0; d < 3; ++d) flow_.velocity()[d].fill(0);
    flow_.add_response({{places_[j].at, 1.0}}, 1.0, flow_.velocity());
    for (Eigen::Index i = 0; i < n; ++i) taken_(i, j) = -places_[i].outflow();
  }
  kept.swap(flow_.velocity());
}

double ImplicitEnds::taken_by_itself(int place) {
  find_response();
  return taken_(place, place);
}

fluid::StepReport ImplicitEnds::settle(double dt, const fluid::StepReport& found,
                                       const std::vector<Answer>& answers) {
  std::vector<Eigen::Index> at;
  std::vector<double> outflow, pressure;
  std::vector<Answer> those;
  for (std::size_t i = 0; i < answers.size(); ++i) {
    if (!answers[i]) continue;
    at.push_back(static_cast<Eigen::Index>(i));
    outflow.push_back(places_[i].outflow());
    pressure.push_back(flow_.known_pressure(places_[i].at));
    those.push_back(answers[i]);
  }
  if (at.empty()) return found;
  find_response();
  const std::vector<double> known = meet(dt * taken_(at, at), outflow, pressure, those);
  std::vector<fluid::PressureRise> rises;
  for (std::size_t i = 0; i < at.size(); ++i) rises.push_back({places_[at[i]].at, known[i] - pressure[i]});
  return flow_.raise(rises, dt);
}

}  // namespace valsalva::coupling
