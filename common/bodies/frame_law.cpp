#include "bodies/frame_law.hpp"

#include "core/errors.hpp"
#include "core/units.hpp"

namespace valsalva::bodies {

structure::BeamMaterial frame_material(const Case& scene) {
  structure::BeamMaterial material{scene.real("device.frame_youngs_modulus_GPa") * units::pa_per_GPa,
                                   scene.real("device.frame_poisson"),
                                   scene.real("device.frame_density_g_per_mm3")};
  if (scene.text("device.frame_law") == "superelastic") {
    const int fibres = static_cast<int>(scene.integer("device.frame_fibres"));
    material.superelastic = std::make_shared<materials::Superelastic>(
        materials::superelastic_set(scene.text("device.frame_alloy")));
    material.fibres = {fibres, fibres, 2};
  }
  return material;
}

void write_fibres(const structure::FibreHistory& history, state::State& to) {
  if (history.fibre.empty()) return;
  std::vector<double> martensite, stress;
  for (const materials::SuperelasticState& fibre : history.fibre) {
    martensite.push_back(fibre.martensite);
    stress.push_back(fibre.stress_Pa);
  }
  to.restart["frame/martensite"] = state::Array::of(std::move(martensite));
  to.restart["frame/fibre_stress_Pa"] = state::Array::of(std::move(stress));
  to.restart["frame/dissipated_nJ"] = state::Array::scalar(history.dissipated_nJ);
}

structure::FibreHistory read_fibres(const state::State& from, const structure::BeamNetwork& network) {
  structure::FibreHistory history = network.rest();
  if (history.fibre.empty()) return history;
  const auto entry = [&](const std::string& name) -> const std::vector<double>& {
    const std::vector<double>& values = from.array(name).doubles(name);
    if (values.size() != history.fibre.size())
      throw InputError("{}: '{}' has {} values; expected one a fibre, {}: device.frame_fibres has changed",
                       from.source, name, values.size(), history.fibre.size());
    return values;
  };
  if (!from.has_array("frame/martensite"))
    throw InputError(
        "{}: there is no 'frame/martensite': it was written with device.frame_law = \"linear\"; crimp the "
        "device with the same law",
        from.source);
  const std::vector<double>&martensite = entry("frame/martensite"), &stress = entry("frame/fibre_stress_Pa");
  for (std::size_t i = 0; i < history.fibre.size(); ++i) history.fibre[i] = {martensite[i], stress[i]};
  history.dissipated_nJ = from.array("frame/dissipated_nJ").number("frame/dissipated_nJ");
  return history;
}

}  // namespace valsalva::bodies
