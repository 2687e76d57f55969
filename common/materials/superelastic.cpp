#include "materials/superelastic.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "core/units.hpp"
#include "materials/checks.hpp"

namespace valsalva::materials {

const std::vector<SuperelasticSet>& superelastic_sets() {
  constexpr double GPa = units::pa_per_GPa, MPa = units::pa_per_MPa;
  static const std::vector<SuperelasticSet> sets{
      {"nitinol-62.9",
       "a published deck of a stent at 37 C: E_A 62.9 GPa, E_M 27.8 GPa, nu 0.33, eps_L 0.046, loading "
       "460-500 "
       "MPa, unloading 240-210 MPa, compression 690 MPa",
       {62.9 * GPa, 27.8 * GPa, 0.33, 0.046, 460 * MPa, 500 * MPa, 240 * MPa, 210 * MPa, 690 * MPa}},
      {"nitinol-51.7",
       "another: E_A 51.7 GPa, E_M 47.8 GPa, nu 0.3, eps_L 0.063, loading 600-670 MPa, unloading 288-254 "
       "MPa, "
       "compression 900 MPa",
       {51.7 * GPa, 47.8 * GPa, 0.3, 0.063, 600 * MPa, 670 * MPa, 288 * MPa, 254 * MPa, 900 * MPa}},
  };
  return sets;
}

const SuperelasticParameters& superelastic_set(const std::string& name) {
  std::string known;
  for (const SuperelasticSet& set : superelastic_sets()) {
    if (set.name == name) return set.parameters;
    known += (known.empty() ? "" : ", ") + set.name;
  }
  throw InputError("there is no superelastic set '{}'; expected one of: {}", name, known);
}

Superelastic::Superelastic(const SuperelasticParameters& parameters) : p_(parameters) {
  constexpr const char* law = "superelastic";
  require_positive(law, "austenite_Pa", p_.austenite_Pa);
  require_positive(law, "martensite_Pa", p_.martensite_Pa);
  require(p_.poisson > -1 && p_.poisson <= 0.5, law, "poisson", p_.poisson, "-1 to 0.5");
  require_positive(law, "transformation_strain", p_.transformation_strain);
  require(p_.unloading_finish_Pa > 0, law, "unloading_finish_Pa", p_.unloading_finish_Pa,
          "a positive stress, so that nothing is left of the strain at rest");
  require(p_.unloading_start_Pa > p_.unloading_finish_Pa, law, "unloading_start_Pa", p_.unloading_start_Pa,
          "more than unloading_finish_Pa");
  require(p_.loading_start_Pa >= p_.unloading_start_Pa, law, "loading_start_Pa", p_.loading_start_Pa,
          "at least unloading_start_Pa");
  require(p_.loading_finish_Pa > p_.loading_start_Pa, law, "loading_finish_Pa", p_.loading_finish_Pa,
          "more than loading_start_Pa");
  require_positive(law, "compression_start_Pa", p_.compression_start_Pa);
  softening_ = 1 / p_.martensite_Pa - 1 / p_.austenite_Pa;
  const auto branch = [&](double scale) {
    const double mean = 0.5 * scale * (p_.loading_start_Pa + p_.unloading_start_Pa);
    const Branch b{scale * p_.loading_start_Pa, scale * p_.loading_finish_Pa, scale * p_.unloading_start_Pa,
                   scale * p_.unloading_finish_Pa,
                   0.5 * softening_ * mean * mean + p_.transformation_strain * mean};
    require(p_.transformation_strain + softening_ * b.load_finish > 0, law, "transformation_strain",
            p_.transformation_strain, "more than what a stiffer martensite takes back when loaded");
    return b;
  };
  tension_ = branch(1);
  compression_ = branch(p_.compression_start_Pa / p_.loading_start_Pa);
}

double Superelastic::stiffest_Pa() const {
  return std::max(p_.austenite_Pa, p_.martensite_Pa);
}

// Along the line xi = fraction + slope (sigma - from): strain = sigma (1/E_A + m xi) + eps_L xi is quadratic.
Superelastic::Step Superelastic::transform(const Branch& b, double fraction, double from, double slope,
                                           double strain) const {
  const double at = fraction - slope * from, eps_L = p_.transformation_strain;
  const double square = softening_ * slope;
  const double linear = 1 / p_.austenite_Pa + softening_ * at + eps_L * slope;
  const double constant = eps_L * at - strain;
  const double root = std::sqrt(std::max(linear * linear - 4 * square * constant, 0.0));
  Step s;
  s.stress = -2 * constant / (linear + root);  // on the rising branch
  s.fraction = std::clamp(at + slope * s.stress, 0.0, 1.0);
  s.tangent = 1 / (compliance(s.fraction) + (softening_ * s.stress + eps_L) * slope);
  // The driving force is a quadratic polynomial of sigma: Simpson's rule is exact.
  const auto force = [&](double sigma) { return 0.5 * softening_ * sigma * sigma + eps_L * sigma - b.work; };
  s.dissipated =
      (s.fraction - fraction) * (force(from) + 4 * force(0.5 * (from + s.stress)) + force(s.stress)) / 6;
  return s;
}

Superelastic::Step Superelastic::follow(const Branch& b, double fraction, double stress,
                                        double strain) const {
  const double eps_L = p_.transformation_strain;
  constexpr double negligible = 1e-9;  // what is left of a transformation's range of stress
  const auto elastic = [&](double xi) {
    const double compliant = compliance(xi);
    return Step{(strain - eps_L * xi) / compliant, xi, 1 / compliant, 0};
  };
  // The whole transformation, ended at `finish`, then elastic.
  const auto beyond = [&](double from, double slope, double finish, double xi) {
    Step s = elastic(xi);
    s.dissipated = transform(b, fraction, from, slope, finish * compliance(xi) + eps_L * xi).dissipated;
    return s;
  };
  const Step s = elastic(fraction);
  if (s.stress > stress && s.stress > b.load_start && fraction < 1) {
    const double from = std::max(stress, b.load_start), range = b.load_finish - from;
    if (range <= negligible * b.load_finish) return elastic(1);
    const double slope = (1 - fraction) / range;
    const Step t = transform(b, fraction, from, slope, strain);
    return t.stress < b.load_finish ? t : beyond(from, slope, b.load_finish, 1);
  }
  if (s.stress < stress && s.stress < b.unload_start && fraction > 0) {
    const double from = std::min(stress, b.unload_start), range = from - b.unload_finish;
    if (range <= negligible * b.unload_finish) return elastic(0);
    const double slope = fraction / range;
    const Step t = transform(b, fraction, from, slope, strain);
    return t.stress > b.unload_finish ? t : beyond(from, slope, b.unload_finish, 0);
  }
  return s;
}

SuperelasticResponse Superelastic::respond(const SuperelasticState& from, double strain) const {
  const double sign = strain < 0 ? -1 : 1;
  const auto side = [&](double s) -> const Branch& { return s < 0 ? compression_ : tension_; };
  double fraction = std::abs(from.martensite), stress = std::abs(from.stress_Pa), dissipated = 0;
  if (from.stress_Pa * sign < 0) {  // through zero, where there is no martensite
    dissipated = follow(side(-sign), fraction, stress, 0).dissipated;
    fraction = stress = 0;
  }
  const Branch& b = side(sign);
  const Step s = follow(b, fraction, stress, std::abs(strain));
  const double psi = 0.5 * s.stress * s.stress * compliance(s.fraction) + s.fraction * b.work;
  return {{sign * s.fraction, sign * s.stress}, s.tangent, psi, dissipated + s.dissipated};
}

}  // namespace valsalva::materials
