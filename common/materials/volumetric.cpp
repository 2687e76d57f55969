#include "materials/volumetric.hpp"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/errors.hpp"
#include "core/schema.hpp"

namespace valsalva::materials {
namespace {

using Form = Volumetric::Form;

constexpr std::array<std::pair<const char*, Form>, 5> names{{{"none", Form::none},
                                                             {"j-ln-j", Form::j_ln_j},
                                                             {"quadratic", Form::quadratic},
                                                             {"logarithmic", Form::logarithmic},
                                                             {"simo-taylor", Form::simo_taylor}}};

}  // namespace

VolumetricResponse Volumetric::respond(double j) const {
  if (!(j > 0))
    throw NumericalFailure("det F = {}; expected a positive number: the element is turned inside out", j);
  const double k = modulus_Pa, l = std::log(j);
  switch (form) {
    case Form::none:
      return {};
    case Form::j_ln_j:
      return {k * (j * l - j + 1), k * l, k / j};
    case Form::quadratic:
      return {0.5 * k * (j - 1) * (j - 1), k * (j - 1), k};
    case Form::logarithmic:
      return {0.5 * k * l * l, k * l / j, k * (1 - l) / (j * j)};
    case Form::simo_taylor:
      return {0.25 * k * (j * j - 1 - 2 * l), 0.5 * k * (j - 1 / j), 0.5 * k * (1 + 1 / (j * j))};
  }
  return {};
}

Volumetric::Form volumetric_form(const std::string& name) {
  std::vector<std::string> known;
  for (const auto& [text, form] : names) {
    if (name == text) return form;
    known.emplace_back(text);
  }
  const std::string near = nearest(name, known);
  throw InputError(
      "volumetric term '{}' is unknown; expected none, j-ln-j, quadratic, logarithmic or simo-taylor{}", name,
      near.empty() ? "" : "; did you mean '" + near + "'?");
}

std::string name_of(Volumetric::Form form) {
  for (const auto& [text, known] : names)
    if (known == form) return text;
  return "none";
}

}  // namespace valsalva::materials
