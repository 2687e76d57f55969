#include "coupling/stability.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/errors.hpp"

namespace valsalva::coupling {

namespace {

double dot(const Points& a, const Points& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

PowerIteration::PowerIteration(std::size_t nodes) : direction_(nodes), force_(nodes), next_(nodes) {
  std::uint64_t seed = 0x9E3779B97F4A7C15ull;
  for (Vec3& v : direction_)
    for (int d = 0; d < 3; ++d) {
      seed = seed * 6364136223846793005ull + 1442695040888963407ull;
      v[d] = static_cast<double>(seed >> 11) / 9007199254740992.0 - 0.5;
    }
}

std::optional<double> PowerIteration::quotient(const Points& direction, const Operator& stiffness,
                                               const Operator& mobility) {
  stiffness(direction, force_);
  mobility(force_, next_);
  const double energy = dot(direction, force_);
  if (!(energy > 0) || !(dot(next_, next_) > 0)) return std::nullopt;
  return dot(force_, next_) / energy;
}

void PowerIteration::take_next(Points& direction) const {
  const double size = std::sqrt(dot(next_, next_));
  for (std::size_t a = 0; a < direction.size(); ++a) direction[a] = next_[a] / size;
}

double PowerIteration::run(const Operator& stiffness, const Operator& mobility, int iterations) {
  for (int i = 0; i < iterations && !direction_.empty(); ++i) {
    const std::optional<double> found = quotient(direction_, stiffness, mobility);
    if (!found) return eigenvalue_ = 0;
    eigenvalue_ = *found;
    take_next(direction_);
  }
  return eigenvalue_;
}

double PowerIteration::look_along(Points direction, const Operator& stiffness, const Operator& mobility,
                                  int iterations) {
  std::optional<double> found;
  for (int i = 0; i < iterations; ++i) {
    found = quotient(direction, stiffness, mobility);
    if (!found) return eigenvalue_;
    take_next(direction);
  }
  if (found && *found > eigenvalue_) {
    eigenvalue_ = *found;
    direction_ = std::move(direction);
  }
  return eigenvalue_;
}

double PowerIteration::critical_step() const {
  return eigenvalue_ > 0 ? 2 / std::sqrt(eigenvalue_) : std::numeric_limits<double>::infinity();
}

void PowerIteration::restore(Points direction, double eigenvalue) {
  VALSALVA_ASSERT(direction.size() == direction_.size());
  direction_ = std::move(direction);
  eigenvalue_ = eigenvalue;
}

double next_step(const StepLimits& limits, double critical_s, double speed, double h, double last_s) {
  double dt = limits.largest_s;
  if (std::isfinite(critical_s)) {
    // dt^2 = a^2 (1 - convection |u| dt / h)
    const double a = limits.safety * critical_s, half = 0.5 * a * limits.convection * speed / h;
    dt = std::min(dt, a * (std::sqrt(1 + half * half) - half));
  }
  if (speed > 0) dt = std::min(dt, limits.cfl * h / speed);
  if (last_s > 0) dt = std::min(dt, limits.growth * last_s);
  if (!(dt >= limits.smallest_s) || std::isnan(critical_s) || std::isnan(speed))
    throw NumericalFailure(
        "coupling: the time step fell to {:.3g} s (structure allows {:.3g} s, the fastest fluid, {:.4g} "
        "mm/s, "
        "{:.3g} s); the computation has become unstable",
        dt, critical_s, speed, limits.cfl * h / std::max(speed, 1e-300));
  return dt;
}

}  // namespace valsalva::coupling
