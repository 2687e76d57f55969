#include "materials/sheet_test.hpp"

#include <Eigen/LU>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::materials {
namespace {

Eigen::Matrix2d gradient(double stretch1, double stretch2, double shear) {
  Eigen::Matrix2d f;
  f << stretch1, shear * stretch2, 0, stretch2;
  return f;
}

SheetState evaluate(const PlaneLaw& law, const PlaneFibres& fibres, double stretch1, double stretch2,
                    double shear, double factor) {
  const Eigen::Matrix2d f = gradient(stretch1, stretch2, shear);
  const PlaneStress s = law.plane_stress(f.transpose() * f, fibres, factor);
  const double stretch3 = std::sqrt(s.c33);
  const Eigen::Matrix2d nominal = f * s.stress;
  return {stretch1,      stretch2, stretch3,   nominal(0, 0),
          nominal(1, 1), s.energy, s.exponent, nominal * f.transpose() / (f.determinant() * stretch3)};
}

void require_stretch(const std::optional<double>& stretch, const char* name) {
  if (stretch && !(std::isfinite(*stretch) && *stretch > 0))
    throw InputError("{} = {}; expected a positive number", name, *stretch);
}

}  // namespace

SheetState sheet_test(const PlaneLaw& law, const PlaneFibres& fibres, const SheetLoad& load, double factor) {
  require_stretch(load.stretch1, "stretch1");
  require_stretch(load.stretch2, "stretch2");
  if (!load.stretch1 && !load.stretch2)
    throw InputError("neither stretch1 nor stretch2 is prescribed; expected at least one");
  if (load.stretch1 && load.stretch2)
    return evaluate(law, fibres, *load.stretch1, *load.stretch2, load.shear, factor);

  // The free stretch bears no force: bracketed from the incompressible guess, then bisected to round-off.
  const bool free_is_2 = load.stretch1.has_value();
  const double given = free_is_2 ? *load.stretch1 : *load.stretch2;
  const auto at = [&](double log_free) {
    const double l = std::exp(log_free);
    return free_is_2 ? evaluate(law, fibres, given, l, load.shear, factor)
                     : evaluate(law, fibres, l, given, load.shear, factor);
  };
  const auto pull = [&](const SheetState& s) {
    return free_is_2 ? s.nominal2_Pa * s.stretch2 : s.nominal1_Pa * s.stretch1;
  };
  constexpr double first_step = 0.02, growth = 1.6, farthest = 20;
  const double guess = -0.5 * std::log(given);
  double low = guess, high = guess;
  for (double step = first_step; pull(at(low)) > 0 && guess - low < farthest; step *= growth) low -= step;
  for (double step = first_step; pull(at(high)) < 0 && high - guess < farthest; step *= growth) high += step;
  if (!(pull(at(low)) <= 0 && pull(at(high)) >= 0))
    throw NumericalFailure("material {}: no free stretch bears no load at a prescribed stretch of {}",
                           law.name(), given);
  for (double middle = 0.5 * (low + high); low < middle && middle < high; middle = 0.5 * (low + high))
    (pull(at(middle)) > 0 ? high : low) = middle;
  return at(high);
}

}  // namespace valsalva::materials
