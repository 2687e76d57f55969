// The laws-by-parameters table: published materials by name, each with its source.
//
//   const MaterialSet set = MaterialLibrary::built_in().find("tavr-ifed-2022/porcine-pericardium");
//   Shell(mesh, set.plane_law(), ...);      fibres at +-set.fibre_angle_deg from the mean direction
//   SolidLaw solid = set.solid_law();
//
// The table is pipelines/materials/laws.toml (the page docs/materials.md shows it); it is built into the
// programs, and a file of the same form can be read in its place. One table a material:
//   ["paper/material"]
//   law = "hgo"                 a name of law_catalogue.hpp, and its parameters under their own keys
//   volumetric = "j-ln-j"       none (default), j-ln-j, quadratic, logarithmic, simo-taylor
//   bulk_modulus_Pa = 5.84e6    when volumetric is not none
//   split = "modified"          modified (default) or full, see solid_law.hpp
//   incompressible_sheet = true (default) shells take C33 = 1/det C; false: the compressible reduction
//   fibre_angles_deg = [7.81, -7.81]   default none; from the mean direction, one a family
//   used_for, source            texts, required
//   assumed                     text: what the source does not state
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "materials/law_catalogue.hpp"
#include "materials/solid_law.hpp"

namespace valsalva::materials {

struct MaterialSet {
  std::string name;
  std::string law;
  ParameterValues parameters;
  Volumetric volumetric;
  Split split = Split::modified;
  bool incompressible_sheet = true;
  std::vector<double> fibre_angles_deg;  ///< one a family, from the mean direction, in the sheet
  std::string used_for, source, assumed;

  std::shared_ptr<const ElasticLaw> elastic_law() const { return make_law(law, parameters); }
  SolidLaw solid_law() const { return {elastic_law(), volumetric, split}; }
  /// What a shell takes: the incompressible or the compressible plane-stress law.
  std::shared_ptr<const PlaneLaw> plane_law() const;
  /// The families in a sheet whose mean direction is (1, 0).
  PlaneFibres plane_fibres() const;
};

class MaterialLibrary {
 public:
  /// InputError naming label, material, key, what was found and what is expected.
  MaterialLibrary(const std::string& toml, const std::string& label);
  static const MaterialLibrary& built_in();

  const std::vector<MaterialSet>& sets() const { return sets_; }
  /// InputError with "did you mean" on an unknown name.
  const MaterialSet& find(const std::string& name) const;

 private:
  std::vector<MaterialSet> sets_;
  std::string label_;
};

}  // namespace valsalva::materials
