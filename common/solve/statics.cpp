#include "solve/statics.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::solve {

Statics::Statics(structure::System& system, std::vector<std::shared_ptr<structure::ForceTerm>> terms,
                 const Supports& supports, const StaticsSettings& settings)
    : settings_(settings),
      equations_(system, std::move(terms), supports),
      matrix_(equations_.matrix()),
      solver_(settings.linear),
      step_(settings.first_step) {
  if (!(settings_.first_step > 0) || !(settings_.min_step > 0) || settings_.max_step < settings_.min_step ||
      !(settings_.growth >= 1))
    throw InputError(
        "statics: first step {}, smallest {}, largest {}, growth {}; expected positive, growth >= 1",
        settings_.first_step, settings_.min_step, settings_.max_step, settings_.growth);
}

NewtonReport Statics::settle() {
  const NewtonProblem problem{[this](double& size) { return equations_.forces(size, stored_); },
                              [this](structure::BlockMatrix& k) { equations_.tangent(k); }};
  const NewtonReport report = newton(equations_, problem, matrix_, solver_, settings_.newton);
  settings_.newton.search_first = report.searched;
  return report;
}

void Statics::advance_to(double factor) {
  structure::Configuration& now = equations_.system().state;
  while (now.time_s < factor) {
    const double left = factor - now.time_s;
    double step = std::min({step_, settings_.max_step, left});
    if (left - step < 1e-9 * std::max(1.0, std::abs(factor))) step = left;
    const Attempt before(equations_, now);
    const double start = now.time_s;
    try {
      for (const auto& term : equations_.terms()) term->begin_step(now, step);
      now.time_s = step == left ? factor : start + step;
      const NewtonReport report = settle();
      iterations_ += report.iterations;
      ++steps_;
      if (report.iterations <= settings_.quick_iterations)
        step_ = std::min(std::max(step_, step) * settings_.growth, settings_.max_step);
    } catch (const NumericalFailure& failure) {
      before.undo(equations_);
      iterations_ += settings_.newton.max_iterations;
      ++failures_;
      step_ = step / 2;
      if (step_ < settings_.min_step)
        throw NumericalFailure(
            "statics: no equilibrium beyond the load factor {:.6g} (wanted {:.6g}, {} steps taken, smallest "
            "step {:.2g}): {}; the state is the last equilibrium",
            start, factor, steps_, settings_.min_step, failure.what());
    }
  }
}

Points Statics::reactions() const {
  double size = 0, stored = 0;
  const Eigen::VectorXd r = equations_.in_space(equations_.forces(size, stored));
  Points out;
  for (std::size_t a = 0; 3 * a + 2 < static_cast<std::size_t>(r.size()); ++a)
    out.push_back(-r.segment<3>(3 * static_cast<Eigen::Index>(a)));
  return out;
}

}  // namespace valsalva::solve
