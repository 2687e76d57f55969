// valsalva-stent: makes the device. A frame (library entry, parameters or centreline graph file) as a beam
// network, leaflets and skirt with their fibres, and the ties by which they are sewn to it.
//
//   valsalva-stent CASE.toml
//   valsalva-stent CASE.toml --set device.size_mm=29 --fidelity standard
//   valsalva-stent CASE.toml --set device.frame=graph --set device.graph_file=my_frame.json
#include <cmath>

#include "bodies/frame.hpp"
#include "bodies/shell.hpp"
#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/provenance.hpp"
#include "core/stage.hpp"
#include "device.hpp"
#include "scene/scene.hpp"
#include "state/checkpoint.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::stent;
using state::Array;

bool size_comes_from_segment(const Case& scene) {
  return scene.real("device.size_mm") == 0 && scene.text("device.frame") != "graph";
}

state::Mesh state_mesh(const Frame& frame) {
  state::Mesh mesh =
      bodies::frame_mesh(frame.nodes, {frame.nodes, frame.beams, frame.width_mm, frame.depth_mm, {}});
  std::vector<std::int64_t> crossing(frame.nodes.size(), 0);
  std::fill_n(crossing.begin(), frame.crossings, 1);
  mesh.point_data["crossing"] = Array::of(std::move(crossing));
  return mesh;
}

state::Mesh state_mesh(const Tissue& tissue, double thickness_mm) {
  const structure::ShellMesh shell{
      tissue.reference, tissue.triangles, std::vector<double>(tissue.points.size(), thickness_mm),
      tissue.fibre1,    tissue.fibre2,    {}};
  return bodies::shell_mesh(tissue.points, shell, tissue.attached, tissue.part);
}

void put(state::State& out, const Assembly& a, double thickness_mm) {
  out.meshes["frame"] = state_mesh(a.frame);
  out.restart["device/nominal_size_mm"] = Array::scalar(a.nominal_size_mm);
  out.restart["device/inflow_z_mm"] = Array::scalar(0);
  out.restart["device/outflow_z_mm"] = Array::scalar(a.measures.height_mm);
  out.restart["device/waist_radius_mm"] = Array::scalar(a.measures.waist_diameter_mm / 2);
  if (!a.crown) return;
  out.meshes["leaflets"] = state_mesh(a.leaflets, thickness_mm);
  out.meshes["skirt"] = state_mesh(a.skirt, thickness_mm);
  out.restart["ties/leaflets"] = bodies::tie_array(a.leaflets.ties);
  out.restart["ties/skirt"] = bodies::tie_array(a.skirt.ties);
  out.restart["device/skirt_edge_z_mm"] = Array::scalar(0);
  out.restart["device/nadir_z_mm"] = Array::scalar(a.crown->nadir_mm);
  out.restart["device/commissure_z_mm"] = Array::scalar(a.crown->commissure_mm());
  out.restart["device/commissure_angles_rad"] =
      Array::of(std::vector<double>(a.commissures.begin(), a.commissures.end()));
}

void add_checks(Summary& summary, const Assembly& a, const Parameters& parameters) {
  if (!a.crown) return;
  const auto at_most = [&](const std::string& name, double value, double limit) {
    summary.checks[name] = {value, limit, value <= limit};
  };
  const auto at_least = [&](const std::string& name, double value, double limit) {
    summary.checks[name] = {value, limit, value >= limit};
  };
  const LeafletMeasures& l = a.leaflet_measures;
  at_most("mounting_strain_max", l.mounting_strain, 0.05);
  at_least("leaflet_min_angle_deg", l.smallest_angle_deg, 15);
  at_least("orifice_radius_mm", l.orifice_radius_mm, parameters.design.thickness_mm);
}

void run(StageContext& context) {
  std::optional<double> recommended;
  if (size_comes_from_segment(context.scene)) {
    const state::State parent = state::read_final(context.parent_state("segment"), "segment");
    const std::string entry = "anatomy/recommended_device_size_mm";
    recommended = parent.array(entry).number(entry);
  }
  const Parameters parameters = read_parameters(context.scene, recommended);
  const Assembly assembly = assemble(parameters);

  Summary& summary = context.summary;
  summary.metrics = metrics_of(assembly);
  add_checks(summary, assembly, parameters);
  if (parameters.graph)
    summary.inputs[parameters.graph->string()] = sha256_of_path(*parameters.graph);
  else
    summary.notes["device"] = fmt::format(
        "{}: proportions are assumed from published descriptions, not a maker's drawing (docs/stent.md)",
        parameters.device.name);
  if (recommended) summary.notes["size"] = fmt::format("{:g} mm, as segment recommends", *recommended);

  state::State out = state::begin(context, 0, 0);
  put(out, assembly, parameters.design.thickness_mm);
  out.final = true;
  state::save(context, out);

  const FrameMeasures& m = assembly.measures;
  log::info("frame {}: {} nodes, {} beams; inflow {:.2f}, waist {:.2f}, outflow {:.2f}, height {:.2f} mm",
            parameters.device.name, assembly.frame.nodes.size(), assembly.frame.beams.size(),
            m.inflow_diameter_mm, m.waist_diameter_mm, m.outflow_diameter_mm, m.height_mm);
  if (assembly.crown)
    log::info("leaflets: {} triangles, free edge {:.2f} mm; skirt: {} triangles; ties: {} and {}",
              assembly.leaflets.triangles.size(), assembly.leaflet_measures.free_edge_mm,
              assembly.skirt.triangles.size(), assembly.leaflets.ties.size(), assembly.skirt.ties.size());
}

/// What can be refused before anything is read or written.
void check(const Case& scene) {
  if (!scene.has("device"))
    throw InputError("{}: the scene has no [device] table; there is no device to make",
                     scene.file().string());
  if (size_comes_from_segment(scene)) return;
  const Parameters parameters = read_parameters(scene, std::nullopt);
  make_frame(parameters);
  if (parameters.tissue && !parameters.graph)
    crown_of_rows(parameters.device.frame, parameters.device.nadir_mm, parameters.device.commissure_mm);
}

Estimate estimate(const Case& scene, int) {
  // Draping dominates: steps grow as 1/edge, nodes as 1/edge^2. Measured at 0.5 mm.
  const double edge = scene.real("device.leaflet_edge_mm");
  return {1.0 + 2.0 * std::pow(0.5 / edge, 3), 100 + 10 * std::pow(0.5 / edge, 2),
          "geometry: nodes lie on the prescribed surface to rounding; the proportions of library devices are "
          "assumed (docs/stent.md)"};
}

}  // namespace

int main(int argc, char** argv) {
  return stage_main(argc, argv,
                    {"stent",
                     "Makes the device: frame, leaflets, skirt and the ties between them",
                     "valsalva-stent CASE.toml --set device.size_mm=29",
                     declare_all,
                     {"case", "device"},
                     run,
                     estimate,
                     check});
}
