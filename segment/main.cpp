// valsalva-segment: from an image to the annulus frame, the level set of the lumen and its measurements.
#include "anatomy.hpp"
#include "bodies/level_set.hpp"
#include "core/errors.hpp"
#include "core/log.hpp"
#include "core/provenance.hpp"
#include "core/stage.hpp"
#include "geometry/level_set.hpp"
#include "geometry/surface.hpp"
#include "phantom/from_case.hpp"
#include "pictures.hpp"
#include "root.hpp"
#include "scene/scene.hpp"
#include "state/checkpoint.hpp"

namespace {

using namespace valsalva;
using geometry::GridSdf;
using segment::Anatomy;
using segment::Lumen;
using segment::Root;

std::filesystem::path input_of(StageContext& context) {
  const Case& scene = context.scene;
  if (scene.text("anatomy.kind") != "phantom") {
    const auto path = scene.resolve(scene.text("anatomy.image"));
    if (!std::filesystem::exists(path))
      throw InputError("anatomy.image: {} does not exist; supply this file, or set anatomy.image to your own",
                       path.string());
    return path;
  }
  const auto path = context.run.file("phantom.nrrd");
  const segment::Phantom phantom = segment::phantom_of(scene);
  if (mpi::rank(context.comm) == 0) segment::write_image(path, phantom.image);
  MPI_Barrier(context.comm);
  context.summary.extra["phantom"] = {{"calcium_mm3", phantom.calcium_mm3},
                                      {"root_annulus_to_junction_mm3", phantom.lumen_mm3}};
  return path;
}

/// The lumen between its cuts, with caps.
geometry::TriMesh closed_surface(const Lumen& lumen) {
  GridSdf capped = lumen.distance;
  std::size_t n = 0;
  for (int k = 0; k < capped.dimensions[2]; ++k) {
    const double z = capped.origin.z() + k * capped.spacing;
    const float beyond = float(std::max(lumen.z_lower_mm - z, z - lumen.z_upper_mm));
    for (int m = 0; m < capped.dimensions[0] * capped.dimensions[1]; ++m, ++n)
      capped.values[n] = std::max(capped.values[n], beyond);
  }
  return geometry::zero_surface(capped);
}

nlohmann::json json_of(const geometry::SectionFigures& f, double z) {
  return {{"z_mm", z},
          {"area_mm2", f.area_mm2},
          {"perimeter_mm", f.perimeter_mm},
          {"min_diameter_mm", f.least_mm},
          {"max_diameter_mm", f.greatest_mm},
          {"area_diameter_mm", f.area_diameter_mm()},
          {"perimeter_diameter_mm", f.perimeter_diameter_mm()}};
}

void fill_summary(Summary& summary, const Anatomy& anatomy, const Root& root, double volume_mm3,
                  double calcium_mm3) {
  const Lumen& lumen = anatomy.lumen;
  const segment::DeviceSize size = segment::recommended_device(root.annulus.perimeter_mm);
  summary.metrics["annulus_area_mm2"] = root.annulus.area_mm2;
  summary.metrics["annulus_perimeter_mm"] = root.annulus.perimeter_mm;
  summary.metrics["annulus_diameter_mm"] = root.annulus.perimeter_diameter_mm();
  summary.metrics["lvot_diameter_mm"] = root.lvot.area_diameter_mm();
  summary.metrics["sinus_diameter_mm"] = root.sinus.area_diameter_mm();
  summary.metrics["stj_diameter_mm"] = root.junction.area_diameter_mm();
  summary.metrics["calcium_volume_mm3"] = calcium_mm3;
  summary.metrics["lumen_volume_mL"] = volume_mm3 / 1000;
  summary.metrics["recommended_device_size_mm"] = size.nominal_mm;

  const double perimeter = root.annulus.perimeter_mm;
  const double out = std::max({0.0, 56.5 - perimeter, perimeter - 94.2});
  summary.checks["annulus_perimeter_outside_device_range_mm"] = {out, 0, size.in_range};
  const double change = std::abs(lumen.smoothing_volume_change_pct);
  summary.checks["smoothing_volume_change_pct"] = {change, 0.5, change <= 0.5};
  if (lumen.statistics.noise > 0) {
    const double ratio = (lumen.statistics.blood - lumen.statistics.tissue) / lumen.statistics.noise;
    summary.checks["contrast_to_noise_at_least"] = {ratio, 5, ratio >= 5};
  }
  summary.notes["annulus_plane"] = anatomy.plane_note;
  if (!lumen.cut_note.empty())
    summary.notes["upper_cut"] = fmt::format("cut at {:.0f} mm: {}", lumen.z_upper_mm, lumen.cut_note);
  if (!size.in_range)
    summary.notes["device_size"] =
        "the annulus perimeter lies outside the range of all devices; the nearest is given";
  if (root.lobe_mm < 0.3)
    summary.notes["commissures"] = fmt::format(
        "the sinuses show three lobes of {:.2f} mm only: the commissure angles are uncertain", root.lobe_mm);
  summary.notes["diameters"] =
      "annulus_diameter_mm from the perimeter; lvot, sinus and stj diameters from the area; least and "
      "greatest "
      "diameters in sections";
  summary.extra["sections"] = {{"annulus", json_of(root.annulus, 0)},
                               {"lvot", json_of(root.lvot, root.z_lvot_mm)},
                               {"sinus", json_of(root.sinus, root.z_sinus_mm)},
                               {"stj", json_of(root.junction, root.z_junction_mm)}};
  summary.extra["wall_strictness"] = lumen.wall_strictness;
  summary.extra["cuts_mm"] = {lumen.z_lower_mm, lumen.z_upper_mm};
  summary.extra["thresholds_HU"] = {{"blood", lumen.statistics.blood},
                                    {"noise", lumen.statistics.noise},
                                    {"soft_tissue", lumen.statistics.tissue},
                                    {"lumen", lumen.statistics.lumen_threshold},
                                    {"calcium", lumen.statistics.calcium_threshold}};
  summary.extra["sinus_lobe_mm"] = root.lobe_mm;
  summary.extra["commissure_angles_deg"] = nlohmann::json::array();
  for (double angle : root.commissure_angles)
    summary.extra["commissure_angles_deg"].push_back(angle * 180 / 3.14159265358979);
  summary.extra["picture"] = "contours.png";
}

void fill_state(state::State& result, const Lumen& lumen, const Root& root, const geometry::TriMesh& surface,
                const Summary& summary) {
  result.meshes["lumen"] = state::Mesh::of_triangles(surface.points, surface.triangles);
  Points line;
  std::vector<Edge> edges;
  std::vector<double> radius;
  for (const auto& p : root.centreline) {
    if (!line.empty()) edges.push_back({int(line.size()) - 1, int(line.size())});
    line.push_back(p.position);
    radius.push_back(p.section.area_diameter_mm() / 2);
  }
  result.meshes["centreline"] = state::Mesh::of_lines(line, edges);
  result.meshes["centreline"].point_data["radius_mm"] = state::Array::of(radius);

  bodies::put_level_set(result, "lumen", lumen.distance);
  if (lumen.calcium) {
    bodies::put_level_set(result, "calcium", *lumen.calcium);
    const geometry::TriMesh calcium = geometry::zero_surface(*lumen.calcium);
    result.meshes["calcium"] = state::Mesh::of_triangles(calcium.points, calcium.triangles);
  }
  std::vector<double> matrix(16, 0.0);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) matrix[4 * r + c] = lumen.frame.axes(r, c);
    matrix[4 * r + 3] = lumen.frame.origin[r];
  }
  matrix[15] = 1;
  result.restart["anatomy/to_scanner"] = state::Array::of(matrix, {4, 4});
  const auto& angles = root.commissure_angles;
  result.restart["anatomy/commissure_angles_rad"] =
      state::Array::of(std::vector<double>(angles.begin(), angles.end()));
  result.restart["anatomy/z_mm"] = state::Array::of(std::vector<double>{
      lumen.z_lower_mm, root.z_lvot_mm, 0.0, root.z_sinus_mm, root.z_junction_mm, lumen.z_upper_mm});
  for (const auto& [name, value] : summary.metrics)
    result.restart["anatomy/" + name] = state::Array::scalar(value);
}

void run(StageContext& context) {
  if (context.resume && !context.run.states().empty() && state::resume(context)->final) {
    log::info("segment: the final state is there already; nothing to do");
    return;
  }
  const auto input = input_of(context);
  context.summary.inputs[input.string()] = sha256_of_path(input);
  const Anatomy anatomy = segment::anatomy_of(context.scene, input);
  const Lumen& lumen = anatomy.lumen;
  const Root root = segment::measure_root(lumen.distance, lumen.z_lower_mm, lumen.z_upper_mm,
                                          context.scene.real("anatomy.lvot_below_mm"));
  const geometry::TriMesh surface = closed_surface(lumen);
  const double volume = geometry::enclosed_volume(surface);
  const double calcium = lumen.calcium ? geometry::volume_inside(*lumen.calcium) : 0;
  fill_summary(context.summary, anatomy, root, volume, calcium);
  log::info(
      "annulus {:.1f} x {:.1f} mm, perimeter {:.1f} mm; sinuses {:.1f}, junction {:.1f} mm; cuts {:.0f} to "
      "{:.0f} mm",
      root.annulus.greatest_mm, root.annulus.least_mm, root.annulus.perimeter_mm,
      root.sinus.area_diameter_mm(), root.junction.area_diameter_mm(), lumen.z_lower_mm, lumen.z_upper_mm);

  state::State result = state::begin(context, 0, 0);
  fill_state(result, lumen, root, surface, context.summary);
  result.final = true;
  if (mpi::rank(context.comm) == 0) {
    segment::PictureOptions options;
    options.z_sinus_mm = root.z_sinus_mm;
    options.wall_mm = context.scene.real("mesh.wall_thickness_mm");
    options.window_low = anatomy.window_low;
    options.window_high = anatomy.window_high;
    segment::write_contours(context.run.file("contours.png"), lumen, anatomy.brightness, options);
  }
  state::save(context, result);
}

Estimate estimate(const Case& scene, int) {
  const double voxels =
      std::pow(2 * scene.real("anatomy.half_width_mm") / scene.real("anatomy.level_set_mm"), 2) *
      (scene.real("anatomy.lower_cut_mm") + scene.real("anatomy.upper_cut_mm") + 40) /
      scene.real("anatomy.level_set_mm");
  return {5 + 2.5e-6 * voxels, 200 + 1e-4 * voxels,
          "diameters to about half an image voxel; the measured errors are in docs/results/segment.md"};
}

}  // namespace

int main(int argc, char** argv) {
  return stage_main(argc, argv,
                    {"segment",
                     "Finds the aortic root in an image",
                     "valsalva-segment pipelines/cases/demo.toml\n",
                     declare_all,
                     {"anatomy", "phantom"},
                     run,
                     estimate,
                     segment::check_anatomy});
}
