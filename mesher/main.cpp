// valsalva-mesher: from segment's lumen to the meshes that later stages compute on. The closed surface
// repaired and remeshed, the wall as tetrahedra, and the native leaflets fitted to the root where the scene
// has [native].
//
//   valsalva-mesher CASE.toml
//   valsalva-mesher CASE.toml --fidelity fine --set mesh.wall_thickness_mm=1.5
//   valsalva-mesher CASE.toml --from runs/CASE/segment/state_000000.h5
#include <algorithm>
#include <cmath>

#include "bodies/shell.hpp"
#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/stage.hpp"
#include "geometry/surface_intersections.hpp"
#include "lumen_meshes.hpp"
#include "native_leaflets.hpp"
#include "scene/scene.hpp"
#include "state/checkpoint.hpp"

namespace {

using namespace valsalva;
using namespace valsalva::mesher;
using state::Array;

LumenOptions lumen_options(const Case& scene) {
  return {scene.real("mesh.surface_edge_mm"), scene.real("mesh.wall_thickness_mm"),
          static_cast<int>(scene.integer("mesh.wall_layers")), scene.real("mesh.max_hole_perimeter_mm")};
}

/// The published lengths are of casts under pressure; leaflets as stiff as stenotic ones keep theirs.
double closed_stretch(const Case& scene) {
  const double given = scene.real("native.closed_stretch");
  if (given == 0) return scene.real("native.stenosis_factor") > 10 ? 1 : 1.05;
  if (given < 1)
    throw InputError("{}: native.closed_stretch = {} is below 1; expected 0 or a number in [1, 1.3]",
                     scene.file().string(), given);
  return given;
}

LeafletProportions proportions_of(const Case& scene, const AnatomyState& anatomy) {
  LeafletProportions p;
  p.annulus_diameter_mm = anatomy.annulus_diameter_mm;
  p.junction_z_mm = anatomy.junction_mm;
  p.commissure_height_factor = scene.real("native.commissure_height_factor");
  p.free_edge_factor = scene.real("native.free_edge_factor");
  p.coaptation_height_factor = scene.real("native.coaptation_height_factor");
  p.free_edge_excess = scene.real("native.free_edge_excess");
  p.closed_stretch = closed_stretch(scene);
  p.free_edge_peak_factor = scene.real("native.free_edge_peak_factor");
  p.commissure_gap_mm = scene.real("native.commissure_gap_mm");
  p.attachment_inset_mm = scene.real("native.attachment_inset_mm");
  return p;
}

ThicknessMap thickness_of(const Case& scene) {
  return {scene.real("native.belly_thickness_mm"), scene.real("native.nodule_thickness_mm"),
          scene.real("native.nodule_radius_mm"), scene.real("native.rim_thickness_mm"),
          scene.real("native.rim_width_mm")};
}

void at_most(Summary& summary, const std::string& name, double value, double limit) {
  summary.checks[name] = {value, limit, value <= limit};
}
void at_least(Summary& summary, const std::string& name, double value, double limit) {
  summary.checks[name] = {value, limit, value >= limit};
}

void put_lumen(state::State& out, Summary& summary, const LumenMeshes& meshes) {
  out.meshes["lumen"] = state::Mesh::of_triangles(meshes.lumen.points, meshes.lumen.triangles);
  out.meshes["wall"] = state::Mesh::of_tetrahedra(meshes.wall.points, meshes.wall.tetrahedra);
  out.meshes["wall"].cell_data["region"] = Array::of(meshes.wall_region);

  auto& metrics = summary.metrics;
  metrics["nodes"] = double(meshes.wall.points.size());
  metrics["elements"] = double(meshes.wall.tetrahedra.size());
  metrics["min_dihedral_deg"] = meshes.quality.min_dihedral_deg;
  metrics["max_aspect"] = meshes.quality.max_aspect;
  metrics["min_scaled_jacobian"] = meshes.quality.min_scaled_jacobian;
  metrics["lumen_volume_error_pct"] = meshes.lumen_volume_error_pct;
  metrics["wall_volume_error_pct"] = meshes.wall_volume_error_pct;
  metrics["volume_error_pct"] = std::max(meshes.lumen_volume_error_pct, meshes.wall_volume_error_pct);
  metrics["lumen_triangles"] = double(meshes.lumen.triangles.size());
  metrics["wall_thinned_nodes"] = double(meshes.thinned_nodes);
  metrics["surface_repairs"] = double(meshes.repairs.size());
  at_least(summary, "min_dihedral_deg", meshes.quality.min_dihedral_deg, 5);
  at_most(summary, "max_aspect", meshes.quality.max_aspect, 15);
  at_least(summary, "min_scaled_jacobian", meshes.quality.min_scaled_jacobian, 0.05);
  at_most(summary, "volume_error_pct", metrics["volume_error_pct"], 2);
  summary.extra["surface_repairs"] = meshes.repairs;
  for (const std::string& repair : meshes.repairs) log::warn("surface: {}", repair);
}

/// Cell data: 1 for tissue, the given factor for triangles within reach of calcium.
std::vector<double> stiffness_factors(const NativeValve& valve, const geometry::GridSdf& calcium,
                                      double reach_mm, double factor) {
  std::vector<double> factors;
  for (const Triangle& t : valve.mesh.triangles) {
    const Vec3 centre = (valve.mesh.points[t[0]] + valve.mesh.points[t[1]] + valve.mesh.points[t[2]]) / 3;
    factors.push_back(calcium.value(centre) < reach_mm ? factor : 1.0);
  }
  return factors;
}

state::Mesh state_mesh(const NativeValve& valve, const std::vector<double>& stiffness_factor) {
  const structure::ShellMesh shell{valve.mesh.points,  valve.mesh.triangles, valve.thickness_mm,
                                   valve.fibres.first, valve.fibres.second,  stiffness_factor};
  return bodies::shell_mesh(valve.mesh.points, shell, {valve.attached.begin(), valve.attached.end()},
                            {valve.leaflet.begin(), valve.leaflet.end()});
}

void report_valve(Summary& summary, const NativeValve& valve, const LeafletProportions& p, double edge_mm) {
  auto& metrics = summary.metrics;
  const auto lengths = geometry::edge_lengths(valve.mesh);
  const auto quality = geometry::quality_of(valve.mesh);
  const auto largest = [](const auto& values) { return *std::max_element(values.begin(), values.end()); };
  metrics["leaflet_nodes"] = double(valve.mesh.points.size());
  metrics["leaflet_triangles"] = double(valve.mesh.triangles.size());
  metrics["leaflet_edge_mean_mm"] = lengths.mean;
  metrics["leaflet_edge_max_mm"] = lengths.longest;
  metrics["leaflet_min_angle_deg"] = quality.min_angle_deg;
  metrics["leaflet_max_aspect"] = quality.max_aspect;
  metrics["leaflet_free_edge_mm"] =
      (valve.free_edge_mm[0] + valve.free_edge_mm[1] + valve.free_edge_mm[2]) / 3;
  metrics["leaflet_length_mm"] = (valve.length_mm[0] + valve.length_mm[1] + valve.length_mm[2]) / 3;
  metrics["leaflet_commissure_height_mm"] = valve.sizes[0].commissure_z_mm;
  metrics["leaflet_mid_radius_mm"] =
      (valve.mid_radius_mm[0] + valve.mid_radius_mm[1] + valve.mid_radius_mm[2]) / 3;
  metrics["leaflet_gauss_curvature_sr"] = largest(valve.gauss_curvature_sr);
  metrics["leaflet_wall_clearance_mm"] = valve.least_clearance_mm;
  metrics["leaflet_attachment_error_mm"] = valve.attachment_error_mm;
  metrics["fibre_unit_error_max"] = fibre_unit_error(valve.mesh, valve.fibres);

  double shortfall = 0;
  for (int k = 0; k < 3; ++k)
    shortfall = std::max({shortfall, 1 - valve.free_edge_mm[k] / valve.sizes[k].free_edge_mm,
                          1 - valve.length_mm[k] / valve.sizes[k].length_mm});
  at_most(summary, "fibre_unit_error_max", metrics["fibre_unit_error_max"], 1e-9);
  at_most(summary, "leaflet_edge_mean_mm", lengths.mean, 1.02 * edge_mm);
  at_least(summary, "leaflet_min_angle_deg", quality.min_angle_deg, 15);
  at_most(summary, "leaflet_size_shortfall", shortfall, 0.05);
  at_most(summary, "leaflet_attachment_error_mm", valve.attachment_error_mm, 0.05);
  at_least(summary, "leaflet_wall_clearance_mm", valve.least_clearance_mm, 0);
  at_most(summary, "leaflet_crossings", double(geometry::self_intersections(valve.mesh).size()), 0);
  summary.notes["native_leaflets"] = fmt::format(
      "fitted to the root by published proportions (docs/mesher.md), not seen in the image; annulus diameter "
      "{:.1f} mm, "
      "half-open stress-free shape",
      p.annulus_diameter_mm);
}

void add_native_valve(state::State& out, StageContext& context, const AnatomyState& anatomy) {
  const Case& scene = context.scene;
  const LeafletProportions p = proportions_of(scene, anatomy);
  const Root root(anatomy.lumen, 0, commissure_height(p));
  const double edge_mm = scene.real("mesh.leaflet_edge_mm");
  const NativeValve valve = fit_native_valve(root, p, thickness_of(scene), anatomy.commissure_angles_rad,
                                             edge_mm, scene.real("native.fibre_angle_deg"), anatomy.lumen);
  std::vector<double> factors;
  if (anatomy.calcium) {
    factors = stiffness_factors(valve, *anatomy.calcium, scene.real("native.calcium_reach_mm"),
                                scene.real("native.calcium_stiffness_factor"));
    context.summary.metrics["leaflet_calcified_fraction"] =
        double(std::count_if(factors.begin(), factors.end(), [](double f) { return f > 1; })) /
        factors.size();
  }
  out.meshes["native_leaflets"] = state_mesh(valve, factors);
  report_valve(context.summary, valve, p, edge_mm);
  log::info(
      "native leaflets: {} triangles, free edge {:.1f} mm, length {:.1f} mm, commissures at z = {:.1f} mm",
      valve.mesh.triangles.size(), context.summary.metrics["leaflet_free_edge_mm"],
      context.summary.metrics["leaflet_length_mm"], valve.sizes[0].commissure_z_mm);
}

void run(StageContext& context) {
  if (context.resume && !context.run.states().empty() && state::resume(context)->final) {
    log::info("mesher: the final state is there already; nothing to do");
    return;
  }
  const state::State segment = state::read_final(context.parent_state("segment"), "segment");
  const AnatomyState anatomy = anatomy_of(segment);
  const LumenMeshes meshes = mesh_lumen(anatomy, lumen_options(context.scene), "lumen of " + segment.source);

  state::State out = state::begin(context, 0, 0);
  copy_anatomy(segment, out);
  put_lumen(out, context.summary, meshes);
  log::info(
      "lumen: {} triangles; wall: {} tetrahedra, smallest dihedral angle {:.1f} degrees, volume error {:.2f} "
      "%",
      meshes.lumen.triangles.size(), meshes.wall.tetrahedra.size(), meshes.quality.min_dihedral_deg,
      context.summary.metrics["volume_error_pct"]);
  if (context.scene.has("native")) add_native_valve(out, context, anatomy);
  for (const auto& [name, check] : context.summary.checks)
    if (!check.pass) log::warn("check {}: {:.4g}, limit {:.4g}", name, check.value, check.limit);
  out.final = true;
  state::save(context, out);
}

Estimate estimate(const Case& scene, int) {
  const double surface = std::pow(1.0 / scene.real("mesh.surface_edge_mm"), 2);
  const double leaflets = scene.has("native") ? std::pow(0.5 / scene.real("mesh.leaflet_edge_mm"), 2) : 0;
  return {
      4 + 4 * surface + 4 * leaflets, 250 + 60 * surface + 40 * leaflets,
      "volumes of lumen and wall within 2 % of the level set (a check of every run); leaflet proportions are "
      "published means, not this patient's"};
}

}  // namespace

int main(int argc, char** argv) {
  return stage_main(argc, argv,
                    {"mesher",
                     "Makes surface, wall and native leaflet meshes",
                     "valsalva-mesher pipelines/cases/demo.toml\n",
                     declare_all,
                     {"mesh", "native"},
                     run,
                     estimate,
                     [](const Case& scene) { closed_stretch(scene); }});
}
