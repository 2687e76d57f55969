#include "device.hpp"

#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "graph_file.hpp"

namespace valsalva::stent {

namespace {

// Of a graph frame's height (assumed, as in the library's 26 mm device).
constexpr double nadir_share = 10.0 / 45, commissure_share = 26.0 / 45;

void override_frame(const Case& scene, Device& device) {
  FrameDesign& frame = device.frame;
  if (const auto cells = scene.integer("device.cells"); cells > 0) frame.cells = static_cast<int>(cells);
  if (const auto& levels = scene.reals("device.level_heights_mm"); !levels.empty()) frame.level_mm = levels;
  if (const auto& pairs = scene.reals("device.profile_mm"); !pairs.empty()) {
    if (pairs.size() % 2 != 0)
      throw InputError("device.profile_mm: {} numbers; expected pairs of height and outer diameter",
                       pairs.size());
    frame.profile_mm.clear();
    for (std::size_t i = 0; i < pairs.size(); i += 2) frame.profile_mm.push_back({pairs[i], pairs[i + 1]});
  }
  if (const double width = scene.real("device.strut_width_mm"); width > 0) frame.width_mm = width;
  if (const double depth = scene.real("device.strut_depth_mm"); depth > 0) frame.depth_mm = depth;
}

}  // namespace

Parameters read_parameters(const Case& scene, std::optional<double> recommended_size_mm) {
  Parameters p;
  p.beams_per_strut = static_cast<int>(scene.integer("device.beams_per_strut"));
  p.tissue = scene.boolean("device.tissue");
  const std::string& kind = scene.text("device.frame");
  double size = scene.real("device.size_mm");
  if (kind == "graph") {
    const std::string& file = scene.text("device.graph_file");
    if (file.empty()) throw InputError("device.graph_file: not given; device.frame = \"graph\" needs one");
    p.graph = scene.resolve(file);
    p.device.name = "graph";
    p.device.nominal_size_mm = size;
  } else {
    if (size == 0 && recommended_size_mm) size = *recommended_size_mm;
    if (size == 0)
      throw InputError(
          "device.size_mm: not given, and no recommendation of segment is at hand; set it (23, 26, 29 "
          "or 34 of the library)");
    p.device = kind == "cylinder" ? cylinder(size) : supra_annular(size);
    override_frame(scene, p.device);
    p.device.frame.beams_per_strut = p.beams_per_strut;
  }
  if (const double z = scene.real("device.nadir_height_mm"); z > 0) p.device.nadir_mm = z;
  if (const double z = scene.real("device.commissure_height_mm"); z > 0) p.device.commissure_mm = z;

  constexpr double rad = std::numbers::pi / 180;
  p.design.thickness_mm = scene.real("device.thickness_mm");
  p.design.gap_mm = scene.real("device.gap_mm");
  p.design.leaflet_edge_mm = scene.real("device.leaflet_edge_mm");
  p.design.skirt_edge_mm = scene.real("device.skirt_edge_mm");
  p.design.free_edge_peak_mm = scene.real("device.free_edge_peak_mm");
  p.design.free_edge_excess = scene.real("device.free_edge_excess");
  p.design.fibre_half_angle = scene.real("device.fibre_angle_deg") * rad;
  p.design.leaflet_mean_fibre = scene.real("device.leaflet_mean_fibre_deg") * rad;
  p.design.skirt_mean_fibre = scene.real("device.skirt_mean_fibre_deg") * rad;
  return p;
}

Frame make_frame(const Parameters& parameters) {
  return parameters.graph ? read_graph(*parameters.graph, parameters.beams_per_strut)
                          : build_frame(parameters.device.frame);
}

Assembly assemble(const Parameters& parameters) {
  Assembly a;
  const Device& device = parameters.device;
  a.frame = make_frame(parameters);
  a.measures = measure(a.frame);
  a.nominal_size_mm = device.nominal_size_mm > 0 ? device.nominal_size_mm : a.measures.inflow_diameter_mm;
  if (!parameters.graph)
    a.closed_diameter_mm =
        closed_diameter_mm(device.frame.cells, device.frame.width_mm, device.frame.depth_mm);
  if (!parameters.tissue) return a;

  if (parameters.graph) {
    const double height = a.measures.height_mm;
    a.crown = crown_without_rows(device.nadir_mm > 0 ? device.nadir_mm : nadir_share * height,
                                 device.commissure_mm > 0 ? device.commissure_mm : commissure_share * height);
  } else {
    a.crown = crown_of_rows(device.frame, device.nadir_mm, device.commissure_mm);
  }
  a.commissures = commissure_angles(a.frame, a.crown->commissure_mm());
  a.leaflets = make_leaflets(*a.crown, a.frame, a.commissures, parameters.design, a.leaflet_measures);
  a.skirt = make_skirt(*a.crown, a.frame, a.commissures, parameters.design);
  return a;
}

std::map<std::string, double> metrics_of(const Assembly& a) {
  std::map<std::string, double> m{{"nodes", static_cast<double>(a.frame.nodes.size())},
                                  {"beams", static_cast<double>(a.frame.beams.size())},
                                  {"springs", static_cast<double>(a.frame.beams.size())},
                                  {"inflow_diameter_mm", a.measures.inflow_diameter_mm},
                                  {"waist_diameter_mm", a.measures.waist_diameter_mm},
                                  {"outflow_diameter_mm", a.measures.outflow_diameter_mm},
                                  {"height_mm", a.measures.height_mm},
                                  {"nominal_size_mm", a.nominal_size_mm}};
  if (a.closed_diameter_mm > 0) m["closed_diameter_mm"] = a.closed_diameter_mm;
  if (!a.crown) return m;
  const LeafletMeasures& l = a.leaflet_measures;
  m["leaflet_nodes"] = static_cast<double>(a.leaflets.points.size());
  m["leaflet_triangles"] = static_cast<double>(a.leaflets.triangles.size());
  m["skirt_nodes"] = static_cast<double>(a.skirt.points.size());
  m["skirt_triangles"] = static_cast<double>(a.skirt.triangles.size());
  m["leaflet_ties"] = static_cast<double>(a.leaflets.ties.size());
  m["skirt_ties"] = static_cast<double>(a.skirt.ties.size());
  m["free_edge_mm"] = l.free_edge_mm;
  m["free_edge_excess"] = l.free_edge_excess;
  m["mounting_strain_max"] = l.mounting_strain;
  m["orifice_radius_mm"] = l.orifice_radius_mm;
  m["leaflet_min_angle_deg"] = l.smallest_angle_deg;
  m["leaflet_mean_edge_mm"] = l.mean_edge_mm;
  m["leaflet_max_edge_mm"] = l.largest_edge_mm;
  return m;
}

}  // namespace valsalva::stent
