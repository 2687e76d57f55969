// The material and the fibres of a body, from its [[body]] entry.
#pragma once

#include <memory>
#include <string>

#include "assembly/mesh.hpp"
#include "core/case.hpp"
#include "materials/library.hpp"
#include "materials/superelastic.hpp"

namespace valsalva::assembly {

/// material = a name of the library; or law and law_parameters; or law = "linear" with young_kPa and poisson
/// (St. Venant-Kirchhoff: large rotation, small strain). InputError with `what`, which names file and entry.
materials::MaterialSet material_of(const Case& body, const std::string& what);

/// The law of superelastic beams: law = "superelastic" with law_parameters, or material = the name of a
/// published set; null for any other law without a material.
std::shared_ptr<const materials::Superelastic> superelastic_of(const Case& body, const std::string& what);

/// Multiplies energy, stress and tangent of a plane law.
std::shared_ptr<const materials::PlaneLaw> scaled(std::shared_ptr<const materials::PlaneLaw> law,
                                                  double factor);

/// Young's modulus and Poisson number of a plane law at rest: nu = D12/D11, E = D11 (1 - nu^2), direction 1
/// along the first fibre family where there are fibres.
struct RestModuli {
  double young_Pa, poisson;
};
RestModuli moduli_at_rest(const materials::PlaneLaw& law, bool fibres);

/// Up to two families per element, unit vectors; empty where the body has no fibres.
struct FibreFields {
  std::vector<Vec3> first, second;
};
/// middle, normal: of every element; families are turned about the normal (solids: about the radius, or the
/// third axis of the body's frame).
FibreFields fibres_of(const Case& body, const materials::MaterialSet& material, const Points& middle,
                      const Points& normal, const std::string& what);

}  // namespace valsalva::assembly
