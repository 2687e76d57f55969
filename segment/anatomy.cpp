#include "anatomy.hpp"

#include <algorithm>
#include <memory>

#include "annulus_plane.hpp"
#include "core/errors.hpp"
#include "geometry/level_set.hpp"
#include "geometry/measure.hpp"
#include "geometry/repair.hpp"
#include "surface_file.hpp"

namespace valsalva::segment {
namespace {

constexpr double seed_below_mm = 8, seed_above_mm = 25;

Vec3 to_lps(const Case& scene, const std::vector<double>& numbers, std::size_t first = 0) {
  const double turn = scene.text("anatomy.coordinates") == "RAS" ? -1 : 1;
  return {turn * numbers[first], turn * numbers[first + 1], numbers[first + 2]};
}

LumenOptions options_of(const Case& scene) {
  LumenOptions options;
  options.spacing_mm = scene.real("anatomy.level_set_mm");
  options.lower_cut_mm = scene.real("anatomy.lower_cut_mm");
  options.upper_cut_mm = scene.real("anatomy.upper_cut_mm");
  options.half_width_mm = scene.real("anatomy.half_width_mm");
  options.channel_margin_mm = scene.real("anatomy.channel_margin_mm");
  options.closing_mm = scene.real("anatomy.closing_mm");
  options.opening_mm = scene.real("anatomy.opening_mm");
  options.smoothing_mm = scene.real("anatomy.smoothing_mm");
  options.denoise_steps = int(scene.integer("anatomy.denoise_steps"));
  if (scene.is_set("anatomy.lumen_threshold_HU"))
    options.lumen_threshold = scene.real("anatomy.lumen_threshold_HU");
  if (scene.is_set("anatomy.calcium_threshold_HU"))
    options.calcium_threshold = scene.real("anatomy.calcium_threshold_HU");
  options.metal_threshold = scene.real("anatomy.metal_threshold_HU");
  options.min_calcium_mm3 = scene.real("anatomy.min_calcium_mm3");
  return options;
}

bool plane_given(const Case& scene) {
  return !scene.reals("anatomy.annulus_centre_mm").empty();
}

Frame given_plane(const Case& scene) {
  return Frame::at(to_lps(scene, scene.reals("anatomy.annulus_centre_mm")),
                   to_lps(scene, scene.reals("anatomy.annulus_normal")));
}

std::vector<Vec3> seeds_of(const Case& scene) {
  const std::vector<double>& numbers = scene.reals("anatomy.seeds_mm");
  std::vector<Vec3> seeds;
  for (std::size_t n = 0; n < numbers.size(); n += 3) seeds.push_back(to_lps(scene, numbers, n));
  return seeds;
}

/// The origin moves to the centroid of the annulus section; the plane stays.
void recentre(Lumen& lumen) {
  const geometry::Plane plane = geometry::Plane::at(Vec3::Zero(), Vec3::UnitZ());
  const geometry::Loop loop = geometry::loop_at_origin(geometry::section(lumen.distance, plane, 40, 0.25));
  const Vec3 centre = plane.point(geometry::centroid(loop));
  lumen.distance.origin -= centre;
  if (lumen.calcium) lumen.calcium->origin -= centre;
  lumen.frame.origin = lumen.frame.to_scanner(centre);
}

Anatomy from_ct(const Case& scene, const std::filesystem::path& input) {
  const auto image = std::make_shared<const Image>(read_image(input));
  const LumenOptions options = options_of(scene);
  Anatomy anatomy;
  std::vector<Vec3> seeds = seeds_of(scene);
  Frame frame;
  if (plane_given(scene)) {
    frame = given_plane(scene);
    anatomy.plane_note = "given in the case";
    if (!image->contains(frame.origin))
      throw InputError(
          "anatomy.annulus_centre_mm: the point lies outside the image {}; check anatomy.coordinates "
          "(LPS or RAS)",
          input.string());
    if (seeds.empty())
      seeds = {frame.to_scanner({0, 0, -seed_below_mm}), frame.to_scanner({0, 0, seed_above_mm})};
  } else {
    frame = annulus_from_seeds(*image, seeds, options);
    anatomy.plane_note = "narrowest section between the seeds";
  }
  anatomy.lumen = lumen_of_contrast(*image, frame, seeds, options);
  recentre(anatomy.lumen);
  anatomy.brightness = [image, at = anatomy.lumen.frame](const Vec3& x) {
    return image->sample(at.to_scanner(x));
  };
  return anatomy;
}

Anatomy from_labels(const Case& scene, const std::filesystem::path& input) {
  const auto image = std::make_shared<const Image>(read_image(input));
  Anatomy anatomy;
  Frame frame;
  if (plane_given(scene)) {
    frame = given_plane(scene);
    anatomy.plane_note = "given in the case";
  } else {
    const auto& pair = scene.reals("anatomy.annulus_labels");
    frame = interface_of(*image, pair[0], pair[1]);
    anatomy.plane_note = "fitted to where the labels of ventricle and aorta touch";
  }
  anatomy.lumen = lumen_of_labels(*image, frame, scene.reals("anatomy.labels"), options_of(scene));
  recentre(anatomy.lumen);
  anatomy.brightness = [image, at = anatomy.lumen.frame](const Vec3& x) {
    return image->sample(at.to_scanner(x));
  };
  anatomy.window_low = 0;
  anatomy.window_high = *std::max_element(image->values.begin(), image->values.end());
  return anatomy;
}

Anatomy from_surface(const Case& scene, const std::filesystem::path& input) {
  const geometry::RepairedSurface repaired =
      geometry::repair_closed_surface(read_surface(input), {}, input.string());
  LumenOptions options = options_of(scene);
  options.closing_mm = options.opening_mm = 0;  // a surface means what it shows
  Anatomy anatomy;
  anatomy.plane_note = "given in the case";
  Vec3 low = repaired.mesh.points.front(), high = low;
  for (const Vec3& p : repaired.mesh.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  // The surface's own caps must not close the vessel inside the cuts.
  geometry::GridSdf shape;
  shape.spacing = options.spacing_mm;
  shape.origin = low - Vec3::Constant(6);
  for (int d = 0; d < 3; ++d) shape.dimensions[d] = int((high[d] - low[d] + 12) / shape.spacing) + 1;
  const geometry::GridSdf field = geometry::signed_distance(repaired.mesh, shape);
  anatomy.lumen = lumen_of_field([&](const Vec3& x) { return field.value(x); }, given_plane(scene), options);
  recentre(anatomy.lumen);
  anatomy.brightness = [distance = anatomy.lumen.distance](const Vec3& x) {
    return distance.value(x) < 0 ? 1.0 : 0.0;
  };
  anatomy.window_low = 0;
  anatomy.window_high = 1.5;
  return anatomy;
}

void expect_triple(const Case& scene, const char* key) {
  const std::size_t length = scene.reals(key).size();
  if (length != 0 && length != 3) throw InputError("{}: {} numbers, expected three", key, length);
}

}  // namespace

void check_anatomy(const Case& scene) {
  const std::string& kind = scene.text("anatomy.kind");
  expect_triple(scene, "anatomy.annulus_centre_mm");
  expect_triple(scene, "anatomy.annulus_normal");
  if (scene.reals("anatomy.seeds_mm").size() % 3 != 0)
    throw InputError("anatomy.seeds_mm: {} numbers, expected three a seed",
                     scene.reals("anatomy.seeds_mm").size());
  const bool normal = !scene.reals("anatomy.annulus_normal").empty();
  if (plane_given(scene) != normal)
    throw InputError(
        "{}: is missing; the annulus plane needs both anatomy.annulus_centre_mm and "
        "anatomy.annulus_normal",
        normal ? "anatomy.annulus_centre_mm" : "anatomy.annulus_normal");
  if (normal && !(to_lps(scene, scene.reals("anatomy.annulus_normal")).norm() > 1e-6))
    throw InputError("anatomy.annulus_normal: is zero; expected a direction from ventricle to aorta");
  if (kind == "surface" && !plane_given(scene))
    throw InputError(
        "anatomy.annulus_centre_mm: is missing; a surface needs the annulus plane, give "
        "anatomy.annulus_centre_mm and anatomy.annulus_normal");
  if ((kind == "ct" || kind == "phantom") && !plane_given(scene) &&
      scene.reals("anatomy.seeds_mm").size() < 6)
    throw InputError(
        "anatomy.seeds_mm: neither two seeds nor an annulus plane are given; give anatomy.annulus_centre_mm "
        "and anatomy.annulus_normal, or a seed in the outflow tract and one in the ascending aorta");
  if (kind == "labels" && scene.reals("anatomy.labels").empty())
    throw InputError("anatomy.labels: is empty; expected the labels of the lumen, for instance [3, 6]");
  if (kind == "labels" && !plane_given(scene) && scene.reals("anatomy.annulus_labels").size() != 2)
    throw InputError(
        "anatomy.annulus_labels: {} labels, expected two (ventricle, aorta), or an annulus plane",
        scene.reals("anatomy.annulus_labels").size());
  if (kind != "phantom" && scene.text("anatomy.image").empty())
    throw InputError("anatomy.image: is missing; expected the path of the {}",
                     kind == "surface" ? "surface" : "image");
}

Anatomy anatomy_of(const Case& scene, const std::filesystem::path& input) {
  const std::string& kind = scene.text("anatomy.kind");
  if (kind == "labels") return from_labels(scene, input);
  if (kind == "surface") return from_surface(scene, input);
  return from_ct(scene, input);
}

}  // namespace valsalva::segment
