// A whole device: frame, leaflets, skirt and their ties, and what is reported of it.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/case.hpp"
#include "crown.hpp"
#include "library.hpp"
#include "tissue.hpp"

namespace valsalva::stent {

/// What the case asks for, defaults of the library filled in.
struct Parameters {
  Device device;  ///< nadir and commissure height 0 with a graph: relative to its height
  std::optional<std::filesystem::path> graph;
  int beams_per_strut = 4;
  bool tissue = true;
  TissueDesign design;
};

/// recommended_size_mm: segment's, used only when the case leaves device.size_mm at 0.
/// InputError names the key.
Parameters read_parameters(const Case& scene, std::optional<double> recommended_size_mm);

struct Assembly {
  double nominal_size_mm = 0;
  Frame frame;
  FrameMeasures measures;
  double closed_diameter_mm = 0;  ///< outer, all struts of a row side by side; 0: not known (graph)
  std::optional<Crown> crown;
  std::array<double, 3> commissures{};  ///< angles, rad
  Tissue leaflets, skirt;               ///< empty without tissue
  LeafletMeasures leaflet_measures;
};

Frame make_frame(const Parameters& parameters);
Assembly assemble(const Parameters& parameters);

/// Metrics by the names of docs/architecture.md, and further ones of the tissue.
std::map<std::string, double> metrics_of(const Assembly& assembly);

}  // namespace valsalva::stent
