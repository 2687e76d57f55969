#include "materials/solid_law.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "materials/plane_in_space.hpp"
#include "materials/voigt.hpp"

namespace valsalva::materials {
namespace {

const Voigt6 twice_shears = (Voigt6() << 1, 1, 1, 2, 2, 2).finished();

double volume_ratio(const Mat3& c) {
  const double det = c.determinant();
  if (!(det > 0) || !std::isfinite(det))
    throw NumericalFailure("det C = {}; expected a positive number: the element is flat or not finite", det);
  return std::sqrt(det);
}

// W(J^(-2/3) C): S = J^(-2/3) Dev S~, Dev A = A - (A:C)/3 C^-1.
ElasticResponse isochoric(const ElasticLaw& law, const Mat3& c, double j, const Fibres& fibres, double factor,
                          Derivatives wanted) {
  const double scale = std::pow(j, -2.0 / 3.0);
  const ElasticResponse w = law.respond(scale * c, fibres, factor, wanted);
  const Mat3 inverse = c.inverse();
  const double pull = w.stress.cwiseProduct(c).sum();  // S~ : C
  ElasticResponse r = w;
  r.stress = scale * (w.stress - pull / 3 * inverse);
  if (wanted == Derivatives::stress) return r;

  const Voigt6 k = voigt(inverse), weighted = voigt(c).cwiseProduct(twice_shears);
  const Voigt6 dc = w.tangent * weighted;  // D~ : C
  const Voigt6 s = voigt(r.stress);
  r.tangent =
      scale * scale *
      (w.tangent - (k * dc.transpose() + dc * k.transpose()) / 3 + dc.dot(weighted) / 9 * k * k.transpose());
  r.tangent += 2.0 / 3.0 *
               (scale * pull * (symmetric_square(inverse) - k * k.transpose() / 3) - k * s.transpose() -
                s * k.transpose());
  return r;
}

// A term f(J): S = J f' C^-1, D = (J^2 f'' + J f') C^-1 x C^-1 - 2 J f' C^-1 o C^-1.
void add_function_of_volume(const VolumetricResponse& f, double j, const Mat3& c, Derivatives wanted,
                            ElasticResponse& r) {
  const Mat3 inverse = c.inverse();
  const double first = j * f.first;
  r.energy += f.energy;
  r.stress += first * inverse;
  if (wanted == Derivatives::stress) return;
  const Voigt6 k = voigt(inverse);
  r.tangent += (j * j * f.second + first) * k * k.transpose() - 2 * first * symmetric_square(inverse);
}

}  // namespace

SolidLaw::SolidLaw(std::shared_ptr<const ElasticLaw> law, Volumetric volumetric, Split split)
    : law_(std::move(law)), volumetric_(volumetric), split_(split) {
  const double k = volumetric_.modulus_Pa;
  if (volumetric_.form != Volumetric::Form::none && !(std::isfinite(k) && k > 0))
    throw InputError("material {}: bulk modulus (Pa) of the {} term = {}; expected a positive number",
                     law_->name(), name_of(volumetric_.form), k);
  if (split_ == Split::full) {
    const Fibres any{2};
    rest_stress_ = law_->respond(Mat3::Identity(), any, 1, Derivatives::stress).stress.trace() / 3;
  }
}

std::string SolidLaw::name() const {
  return law_->name() + (volumetric_.form == Volumetric::Form::none ? "" : " + " + name_of(volumetric_.form));
}

ElasticResponse SolidLaw::distortional(const Mat3& c, const Fibres& fibres, double factor,
                                       Derivatives wanted) const {
  const double j = volume_ratio(c);
  if (split_ == Split::modified) return isochoric(*law_, c, j, fibres, factor, wanted);
  ElasticResponse r = law_->respond(c, fibres, factor, wanted);
  const double rest = factor * rest_stress_;
  if (rest != 0) add_function_of_volume({-rest * std::log(j), -rest / j, rest / (j * j)}, j, c, wanted, r);
  return r;
}

ElasticResponse SolidLaw::respond(const Mat3& c, const Fibres& fibres, double factor,
                                  Derivatives wanted) const {
  ElasticResponse r = distortional(c, fibres, factor, wanted);
  if (volumetric_.form == Volumetric::Form::none) return r;
  const double j = volume_ratio(c);
  add_function_of_volume(volumetric_.respond(j), j, c, wanted, r);
  return r;
}

PlaneStress SolidLaw::plane_stress(const Eigen::Matrix2d& c, const PlaneFibres& fibres, double factor) const {
  return plane_tangent(c, fibres, factor).at;  // Newton has the tangent anyway
}

PlaneTangent SolidLaw::plane_tangent(const Eigen::Matrix2d& c, const PlaneFibres& fibres,
                                     double factor) const {
  constexpr int most_steps = 60;
  constexpr double longest_step = 0.7, tolerance = 1e-12;
  const double det = c.determinant();
  if (!(det > 0) || !std::isfinite(det))
    throw NumericalFailure("material {}: det C = {} in the plane; expected a positive number", name(), det);
  const Fibres spatial = in_space(fibres);
  double log_c33 = -std::log(det);
  for (int step = 0; step < most_steps; ++step) {
    const double c33 = std::exp(log_c33);
    const ElasticResponse r = respond(in_space(c, c33), spatial, factor, Derivatives::tangent);
    const PlaneBlocks d = plane_blocks(r.tangent);
    const double stress = c33 * r.stress(2, 2);
    const double slope = stress + 0.5 * c33 * c33 * d.thickness;
    if (!std::isfinite(stress) || !(d.thickness > 0)) break;
    if (std::abs(stress) <= tolerance * std::abs(slope))
      return {{r.energy, r.exponent, c33, r.stress.topLeftCorner<2, 2>()},
              d.plane - d.coupling * d.coupling.transpose() / d.thickness};
    const double newton = slope > 0 ? -stress / slope : (stress > 0 ? -longest_step : longest_step);
    log_c33 += std::clamp(newton, -longest_step, longest_step);
  }
  throw NumericalFailure(
      "material {}: no thickness stretch makes S33 vanish at C = [{}, {}; {}]; expected a plane-stress "
      "state: "
      "the law has lost its stability there",
      name(), c(0, 0), c(0, 1), c(1, 1));
}

PressureStress volumetric_stress(const Mat3& c, double pressure_Pa) {
  const double j = volume_ratio(c);
  const Mat3 inverse = c.inverse();
  const Voigt6 k = voigt(inverse);
  const double p = pressure_Pa * j;
  return {p * inverse, p * (k * k.transpose() - 2 * symmetric_square(inverse)), j * k};
}

Mat3 cauchy_stress(const Mat3& f, const Mat3& second_piola) {
  return f * second_piola * f.transpose() / f.determinant();
}

}  // namespace valsalva::materials
