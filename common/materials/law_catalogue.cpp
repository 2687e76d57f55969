#include "materials/law_catalogue.hpp"

#include <algorithm>
#include <limits>

#include "core/errors.hpp"
#include "core/schema.hpp"
#include "materials/fung.hpp"
#include "materials/hgo.hpp"
#include "materials/holzapfel.hpp"
#include "materials/lee_sacks.hpp"
#include "materials/mooney_rivlin.hpp"
#include "materials/neo_hookean.hpp"
#include "materials/ogden.hpp"
#include "materials/st_venant_kirchhoff.hpp"
#include "materials/straightened_fibre.hpp"

namespace valsalva::materials {
namespace {

using Law = std::shared_ptr<const ElasticLaw>;
using Values = ParameterValues;

constexpr double infinity = std::numeric_limits<double>::infinity();

std::optional<double> optional_value(const Values& v, const std::string& key) {
  const auto found = v.find(key);
  return found == v.end() ? std::nullopt : std::optional(found->second);
}

Law make_ogden(const Values& v) {
  std::vector<OgdenTerm> terms;
  for (const char* n : {"1", "2", "3"}) {
    const double mu = v.at(std::string("mu") + n + "_Pa");
    if (mu != 0) terms.push_back({mu, v.at(std::string("alpha") + n)});
  }
  return std::make_shared<Ogden>(std::move(terms));
}

Law make_straightened_fibre(const Values& v) {
  return std::make_shared<StraightenedFibre>(
      StraightenedFibreParameters{v.at("c1_Pa"), v.at("c2_Pa"), v.at("c3_Pa"), v.at("c4"),
                                  v.at("straightening_stretch"), optional_value(v, "c5_Pa")});
}

std::vector<LawEntry> build() {
  constexpr double soft = 1, stiff = 1e9;  // Pa
  return {
      {"neo-hookean",
       "W = mu/2 (I1 - 3)",
       0,
       {{"mu_Pa", "shear modulus", soft, stiff, {}}},
       [](const Values& v) -> Law { return std::make_shared<NeoHookean>(v.at("mu_Pa")); }},
      {"mooney-rivlin",
       "W = C1 (I1 - 3) + C2 (I2 - 3)",
       0,
       {{"c1_Pa", "C1", soft, stiff, {}}, {"c2_Pa", "C2", 0, stiff, 0.0}},
       [](const Values& v) -> Law { return std::make_shared<MooneyRivlin>(v.at("c1_Pa"), v.at("c2_Pa")); }},
      {"st-venant-kirchhoff",
       "W = lambda/2 (tr E)^2 + mu E:E",
       0,
       {{"lambda_Pa", "first Lame parameter", 0, stiff, {}}, {"mu_Pa", "shear modulus", soft, stiff, {}}},
       [](const Values& v) -> Law {
         return std::make_shared<StVenantKirchhoff>(v.at("lambda_Pa"), v.at("mu_Pa"));
       }},
      {"ogden",
       "W = sum mu_p/alpha_p (l1^alpha_p + l2^alpha_p + l3^alpha_p - 3)",
       0,
       {{"mu1_Pa", "mu of the first term", soft, stiff, {}},
        {"alpha1", "exponent of the first term", 1, 60, {}},
        {"mu2_Pa", "mu of the second term; 0: none", -stiff, stiff, 0.0},
        {"alpha2", "exponent of the second term", -60, 60, 2.0},
        {"mu3_Pa", "mu of the third term; 0: none", -stiff, stiff, 0.0},
        {"alpha3", "exponent of the third term", -60, 60, 2.0}},
       make_ogden},
      {"exponential-neo-hookean",
       "W = C10 {exp[C01 (I1 - 3)] - 1}",
       0,
       {{"c10_Pa", "C10", soft, stiff, {}}, {"c01", "C01", 1e-3, 500, {}}},
       [](const Values& v) -> Law {
         return std::make_shared<Hgo>(HgoParameters{v.at("c10_Pa"), v.at("c01"), 0, 1, 0});
       }},
      {"hgo",
       "W = C10 {exp[C01 (I1 - 3)] - 1} + k1/(2 k2) sum {exp[k2 E^2] - 1}, "
       "E = kappa (I1 - 3) + (1 - 3 kappa) (max(I4, 1) - 1)",
       2,
       {{"c10_Pa", "C10 of the matrix", soft, stiff, {}},
        {"c01", "C01 of the matrix", 1e-3, 500, {}},
        {"k1_Pa", "fibre stiffness", 0, stiff, {}},
        {"k2", "fibre exponent", 1e-4, 1000, {}},
        {"kappa", "dispersion, 0 aligned to 1/3 isotropic", 0, 1.0 / 3.0, 0.0}},
       [](const Values& v) -> Law {
         return std::make_shared<Hgo>(
             HgoParameters{v.at("c10_Pa"), v.at("c01"), v.at("k1_Pa"), v.at("k2"), v.at("kappa")});
       }},
      {"holzapfel",
       "W = mu/2 (I1 - 3) + sum a_i/(2 b_i) {exp[b_i (max(I4_i, 1) - 1)^2] - 1}",
       2,
       {{"mu_Pa", "shear modulus of the matrix", soft, stiff, {}},
        {"a1_Pa", "stiffness of the first family", 0, stiff, {}},
        {"b1", "exponent of the first family", 1e-4, 1000, {}},
        {"a2_Pa", "stiffness of the second family", 0, stiff, {}},
        {"b2", "exponent of the second family", 1e-4, 1000, {}}},
       [](const Values& v) -> Law {
         return std::make_shared<Holzapfel>(
             HolzapfelParameters{v.at("mu_Pa"), {v.at("a1_Pa"), v.at("a2_Pa")}, {v.at("b1"), v.at("b2")}});
       }},
      {"straightened-fibre",
       "W = C1 (I1 - 3) + C2 (I2 - 3) + F(l), dF/dl = C3/l {exp[C4 (l - 1)] - 1} to l*, then (C5 l + C6)/l",
       1,
       {{"c1_Pa", "C1 of the matrix", soft, stiff, {}},
        {"c2_Pa", "C2 of the matrix", 0, stiff, 0.0},
        {"c3_Pa", "fibre stiffness", 0, stiff, {}},
        {"c4", "fibre exponent", 1e-3, 300, {}},
        {"straightening_stretch", "l*; infinite: the fibres never straighten", 1.001, 3, infinity},
        {"c5_Pa", "slope of straight fibres; absent: smooth at l*", 0, stiff, {}, false}},
       make_straightened_fibre},
      {"fung",
       "W = Ch/2 (exp Q - 1), Q = b1 E11^2 + b2 (E22^2 + E33^2 + 2 E23^2) + 2 b3 (E12^2 + E13^2)",
       1,
       {{"ch_Pa", "Ch", soft, stiff, {}},
        {"b1", "along the fibre", 1e-4, 1000, {}},
        {"b2", "across the fibre", 1e-4, 1000, {}},
        {"b3", "fibre shear", 1e-4, 1000, {}}},
       [](const Values& v) -> Law {
         return std::make_shared<Fung>(FungParameters{v.at("ch_Pa"), v.at("b1"), v.at("b2"), v.at("b3")});
       }},
      {"lee-sacks",
       "W = c0/2 (I1 - 3) + c1/2 {w exp[c2 (I1 - 3)^2] + (1 - w) exp[c3 (max(I4, 1) - 1)^2] - 1}",
       1,
       {{"c0_Pa", "matrix stiffness", soft, stiff, {}},
        {"c1_Pa", "stiffness of the exponentials", 0, stiff, {}},
        {"c2", "isotropic exponent", 1e-3, 1000, {}},
        {"c3", "fibre exponent", 1e-3, 1000, 1.0},
        {"w", "share of the isotropic exponential", 0, 1, 1.0}},
       [](const Values& v) -> Law {
         return std::make_shared<LeeSacks>(
             LeeSacksParameters{v.at("c0_Pa"), v.at("c1_Pa"), v.at("c2"), v.at("c3"), v.at("w")});
       }},
  };
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  const std::string near = nearest(word, known);
  return near.empty() ? "" : "; did you mean '" + near + "'?";
}

}  // namespace

const std::vector<LawEntry>& law_catalogue() {
  static const std::vector<LawEntry> laws = build();
  return laws;
}

const LawEntry& find_law(const std::string& name) {
  std::vector<std::string> known;
  for (const LawEntry& law : law_catalogue()) {
    if (law.name == name) return law;
    known.push_back(law.name);
  }
  std::string list;
  for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
  throw InputError("material law '{}' is unknown{}; known laws: {}", name, suggestion(name, known), list);
}

std::shared_ptr<const ElasticLaw> make_law(const std::string& name, const ParameterValues& given) {
  const LawEntry& law = find_law(name);
  std::vector<std::string> known;
  ParameterValues values;
  for (const LawParameter& parameter : law.parameters) {
    known.push_back(parameter.key);
    if (parameter.standard) values[parameter.key] = *parameter.standard;
  }
  for (const auto& [key, value] : given) {
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw InputError("material {}: unknown parameter '{}'{}", name, key, suggestion(key, known));
    values[key] = value;
  }
  for (const LawParameter& parameter : law.parameters)
    if (parameter.required && !values.contains(parameter.key))
      throw InputError("material {}: parameter '{}' ({}) is missing", name, parameter.key, parameter.doc);
  return law.make(values);
}

}  // namespace valsalva::materials
