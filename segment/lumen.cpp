#include "lumen.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>

#include "calcium.hpp"
#include "core/errors.hpp"
#include "core/log.hpp"
#include "geometry/centreline.hpp"
#include "geometry/level_set.hpp"
#include "lumen_field.hpp"

namespace valsalva::segment {
namespace {

using geometry::GridSdf;

constexpr double margin_mm = 8;  // real data beyond the cuts, for the morphology
constexpr double ends_mm = 20;   // straight continuation while distances are taken, so that no end is felt
constexpr double kept_mm = 6;    // of which so much stays in the result, on every side
constexpr double least_upper_cut_mm = 20;
constexpr double most_oblique = 1.6;  // area of the upper cut over that of the normal section
constexpr double widest_annulus_mm = 42, widest_section_mm2 = 2400;  // beyond any patient's
constexpr double reach_mm = 9;  // distances are right up to here, and every radius is smaller
constexpr double corner_mm = 2, largest_parting_mm = 8.5;
constexpr double least_upright = 0.6;  // cosine between the vessel and the axis at the upper cut

double median(std::vector<double> values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string text_of(const Vec3& p) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm LPS", p.x(), p.y(), p.z());
}

std::string threshold_words(const Statistics& found) {
  return found.lumen_threshold > 0
             ? fmt::format("anatomy.lumen_threshold_HU (now {:.0f})", found.lumen_threshold)
             : std::string("anatomy.labels");
}

/// Of all the lumen at one height.
double area_at(const GridSdf& distance, double z) {
  const auto [nx, ny, nz] = distance.dimensions;
  const int k = std::clamp(int(std::lround((z - distance.origin.z()) / distance.spacing)), 0, nz - 1);
  double samples = 0;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) samples += distance.at(i, j, k) < 0;
  return samples * distance.spacing * distance.spacing;
}

/// Where the vessel can be cut by z = const, at most `wanted`.
double upper_cut(const GridSdf& lumen, double wanted, std::string& note) {
  geometry::CentrelineOptions options;
  const auto line = geometry::follow(lumen, Vec3::Zero(), Vec3::UnitZ(), options);
  double reached = 0;
  for (const auto& p : line) {
    if (p.arc_mm > 15 && p.tangent.z() < least_upright) {
      note = fmt::format("the aorta leans by more than {:.0f} degrees from z = {:.0f} mm on",
                         std::acos(least_upright) * 180 / 3.14159265358979, p.position.z());
      break;
    }
    const geometry::Plane level = geometry::Plane::at(p.position, Vec3::UnitZ());
    const geometry::Loop loop =
        geometry::loop_at_origin(geometry::section(lumen, level, options.half_width_mm, options.lattice_mm));
    if (loop.empty() || geometry::area(loop) > most_oblique * p.section.area_mm2) {
      note = fmt::format("a horizontal cut is no round disc from z = {:.0f} mm on", p.position.z());
      break;
    }
    reached = std::max(reached, p.position.z());
    if (reached >= wanted) return wanted;
  }
  if (note.empty()) note = fmt::format("the lumen can be followed up to z = {:.0f} mm only", reached);
  return std::floor(reached);
}

/// What is found of the vessel at one opening radius; `leak` says what is wrong with it, empty when nothing
/// is.
struct Attempt {
  GridSdf distance;
  double z_upper_mm = 0;
  std::string cut_note, leak;
};

Attempt attempt(const GridSdf& body, double parting_mm, const Frame& frame, const std::vector<Vec3>& seeds,
                const LumenOptions& options) {
  const geometry::Plane plane = geometry::Plane::at(Vec3::Zero(), Vec3::UnitZ());
  Attempt result;
  GridSdf& distance = result.distance;
  distance = parted(body, parting_mm, parting_mm > options.opening_mm ? corner_mm : 0, seeds);
  if (parting_mm > options.opening_mm) distance = parted(distance, options.opening_mm, 0, seeds);
  const geometry::Loop loop =
      geometry::loop_at_origin(geometry::section(distance, plane, options.half_width_mm, options.spacing_mm));
  if (loop.empty()) {
    result.cut_note = "there is no lumen at the annulus";
    return result;
  }
  const double width = geometry::caliper(loop).greatest_mm;
  if (width > widest_annulus_mm) {
    result.leak =
        fmt::format("the section at the annulus plane is {:.0f} mm wide, expected {:.0f} mm at most", width,
                    widest_annulus_mm);
    return result;
  }
  limit_to_channel(distance, loop, options.channel_margin_mm);
  distance = parted(geometry::redistanced(distance, reach_mm), options.opening_mm, 0, seeds);
  // Only now are leaflets filled: before, the closing would bridge the thin walls between neighbours.
  if (options.closing_mm > 0) distance = closed(distance, options.closing_mm);
  result.z_upper_mm = upper_cut(distance, options.upper_cut_mm, result.cut_note);
  continue_straight(distance, -options.lower_cut_mm, result.z_upper_mm);
  distance = geometry::redistanced(geometry::component_at(distance, {Vec3::Zero()}), reach_mm);
  Vec3 where;
  if (touches_side(distance, -options.lower_cut_mm, result.z_upper_mm, &where))
    result.leak = fmt::format(
        "the lumen reaches the side of the working box at {}, {:.0f} mm above the annulus; its "
        "volume is {:.0f} mL",
        text_of(frame.to_scanner(where)), where.z(), geometry::volume_inside(distance) / 1000);
  else
    for (double z = 0; z <= result.z_upper_mm; z += 2) {
      const double area = area_at(distance, z);
      if (area > widest_section_mm2)
        result.leak =
            fmt::format("the section {:.0f} mm above the annulus has {:.0f} mm2, expected {:.0f} mm2 at most",
                        z, area, widest_section_mm2);
    }
  return result;
}

/// From the raw field on the working grid to the open-ended lumen.
/// seeds: points on both sides of the valve, so that leaflets that nearly touch do not part the vessel.
Lumen finish(const GridSdf& field, const Frame& frame, const std::vector<Vec3>& seeds,
             const LumenOptions& options, const Statistics& found) {
  std::vector<Vec3> inside{Vec3::Zero()};
  for (const Vec3& seed : seeds) inside.push_back(frame.from_scanner(seed));
  const GridSdf body = geometry::redistanced(field, reach_mm);
  // Walls thinner than a voxel let neighbours run together: part them at the smallest radius that does it.
  Attempt best;
  double parting = options.opening_mm;
  for (;; parting += 1.5) {
    best = attempt(body, parting, frame, inside, options);
    if (best.leak.empty() || parting + 1.5 > largest_parting_mm) break;
    log::info("opening by {:.1f} mm: {}", parting, best.leak);
  }
  if (!best.leak.empty())
    throw InputError(
        "segmentation leaks: {}, also when necks up to {:.0f} mm are cut; raise {}, move "
        "anatomy.annulus_centre_mm, turn anatomy.annulus_normal or lower anatomy.upper_cut_mm (now {:g})",
        best.leak, 2 * parting, threshold_words(found), options.upper_cut_mm);
  if (best.z_upper_mm < least_upper_cut_mm)
    throw InputError(
        "segmentation is empty: {}, expected {:.0f} mm of lumen above the annulus {} at least; lower {}, "
        "or move anatomy.annulus_centre_mm",
        best.cut_note, least_upper_cut_mm, text_of(frame.origin), threshold_words(found));
  Lumen lumen;
  lumen.frame = frame;
  lumen.statistics = found;
  lumen.cut_note = best.cut_note;
  lumen.parting_mm = parting;
  lumen.z_lower_mm = -options.lower_cut_mm;
  lumen.z_upper_mm = best.z_upper_mm;
  GridSdf distance = std::move(best.distance);
  const double before = geometry::volume_inside(distance);
  if (options.smoothing_mm > 0) distance = geometry::smoothed(distance, options.smoothing_mm);
  lumen.smoothing_volume_change_pct = 100 * (geometry::volume_inside(distance) / before - 1);
  continue_straight(distance, lumen.z_lower_mm, lumen.z_upper_mm);
  lumen.distance = geometry::redistanced(distance);
  return lumen;
}

/// Keeps what a fluid box and a wall need around the lumen.
void trim(Lumen& lumen) {
  const GridSdf& field = lumen.distance;
  const auto [nx, ny, nz] = field.dimensions;
  std::array<int, 3> low{nx, ny, 0}, high{0, 0, nz - 1};
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        if (field.at(i, j, k) < kept_mm) {
          low = {std::min(low[0], i), std::min(low[1], j), 0};
          high = {std::max(high[0], i), std::max(high[1], j), nz - 1};
        }
  low[2] = std::max(0, int((lumen.z_lower_mm - kept_mm - field.origin.z()) / field.spacing));
  high[2] = std::min(nz - 1, int(std::ceil((lumen.z_upper_mm + kept_mm - field.origin.z()) / field.spacing)));
  lumen.distance = geometry::cropped(field, low, high);
  if (lumen.calcium) lumen.calcium = geometry::cropped(*lumen.calcium, low, high);
}

template <class Function>
GridSdf working_grid(const LumenOptions& options, Function&& value) {
  const double w = options.half_width_mm;
  return geometry::sample(Vec3(-w, -w, -options.lower_cut_mm - ends_mm),
                          Vec3(w, w, options.upper_cut_mm + ends_mm), options.spacing_mm, value);
}

}  // namespace

Statistics statistics_of(const Image& image, const std::vector<Vec3>& seeds, const LumenOptions& options) {
  constexpr double radius_mm = 4, step_mm = 0.8;
  std::vector<double> values;
  for (const Vec3& seed : seeds) {
    if (!image.contains(seed))
      throw InputError(
          "anatomy.seeds_mm: the seed {} lies outside the image; give a point inside the contrast-filled "
          "lumen (check anatomy.coordinates)",
          text_of(seed));
    std::vector<double> around;
    for (double z = -radius_mm; z <= radius_mm; z += step_mm)
      for (double y = -radius_mm; y <= radius_mm; y += step_mm)
        for (double x = -radius_mm; x <= radius_mm; x += step_mm)
          if (x * x + y * y + z * z <= radius_mm * radius_mm)
            around.push_back(image.sample(seed + Vec3(x, y, z)));
    const double here = median(around);
    const double least = options.lumen_threshold.value_or(150);
    if (here < least)
      throw InputError(
          "segmentation is empty: around the seed {} the image has {:.0f} HU, expected more than {:.0f} "
          "(contrast-filled blood); move anatomy.seeds_mm or anatomy.annulus_centre_mm, or lower "
          "anatomy.lumen_threshold_HU",
          text_of(seed), here, least);
    values.insert(values.end(), around.begin(), around.end());
  }
  Statistics found;
  found.blood = median(values);
  for (double& value : values) value = std::abs(value - found.blood);
  found.noise = 1.4826 * median(values);
  std::vector<double> tissue;
  for (float value : image.values)
    if (value > 0 && value < found.blood / 2) tissue.push_back(value);
  found.tissue = tissue.empty() ? 0 : median(tissue);
  found.lumen_threshold = options.lumen_threshold.value_or((found.blood + found.tissue) / 2);
  found.calcium_threshold =
      options.calcium_threshold.value_or(found.blood + std::max(6 * found.noise, 200.0));
  return found;
}

Lumen lumen_of_contrast(const Image& image, const Frame& frame, const std::vector<Vec3>& seeds,
                        const LumenOptions& options) {
  Image part =
      cropped(image, frame.origin, 1.5 * std::max(options.half_width_mm, options.upper_cut_mm + ends_mm));
  const Statistics found = statistics_of(part, seeds, options);
  log::info("blood {:.0f} HU, noise {:.0f}, soft tissue {:.0f}; lumen above {:.0f}, calcium above {:.0f}",
            found.blood, found.noise, found.tissue, found.lumen_threshold, found.calcium_threshold);
  for (float& value : part.values) value = std::min(value, float(options.metal_threshold));
  denoise(part, std::max(2.5 * found.noise, 1.0), options.denoise_steps);

  const GridSdf brightness =
      working_grid(options, [&](const Vec3& x) { return part.sample(frame.to_scanner(x)); });
  // Calcium and metal cannot pull the edge: what is brighter than blood counts as blood.
  GridSdf field = brightness;
  const double contrast = found.blood - found.lumen_threshold;
  for (float& value : field.values)
    value = float(options.spacing_mm * std::clamp((found.lumen_threshold - value) / contrast, -1.0, 1.0));
  const double low = -options.lower_cut_mm - margin_mm, high = options.upper_cut_mm + margin_mm;
  continue_straight(field, low, high);
  Lumen lumen = finish(field, frame, seeds, options, found);
  lumen.calcium = calcium_of(brightness, lumen.distance,
                             {found.calcium_threshold, options.metal_threshold, options.min_calcium_mm3});
  trim(lumen);
  return lumen;
}

Lumen lumen_of_labels(const Image& image, const Frame& frame, const std::vector<double>& labels,
                      const LumenOptions& options) {
  Image part =
      cropped(image, frame.origin, 1.5 * std::max(options.half_width_mm, options.upper_cut_mm + ends_mm));
  bool any = false;
  for (float& value : part.values) {
    const bool inside = std::find(labels.begin(), labels.end(), double(value)) != labels.end();
    any |= inside;
    value = inside ? 1 : 0;
  }
  if (!any)
    throw InputError(
        "segmentation is empty: none of anatomy.labels occurs near the annulus {}; correct the labels or "
        "the annulus plane",
        text_of(frame.origin));
  GridSdf field = working_grid(options, [&](const Vec3& x) {
    return options.spacing_mm * (1 - 2 * part.sample(frame.to_scanner(x)));
  });
  continue_straight(field, -options.lower_cut_mm - margin_mm, options.upper_cut_mm + margin_mm);
  Lumen lumen = finish(field, frame, {}, options, {});
  trim(lumen);
  return lumen;
}

Lumen lumen_of_field(const std::function<double(const Vec3&)>& inside, const Frame& frame,
                     const LumenOptions& options) {
  GridSdf field = working_grid(options, [&](const Vec3& x) { return inside(frame.to_scanner(x)); });
  Lumen lumen = finish(field, frame, {}, options, {});
  trim(lumen);
  return lumen;
}

Frame interface_of(const Image& labels, double upstream, double downstream) {
  std::vector<Vec3> touching;
  const auto [nx, ny, nz] = labels.size;
  for (int k = 1; k + 1 < nz; ++k)
    for (int j = 1; j + 1 < ny; ++j)
      for (int i = 1; i + 1 < nx; ++i) {
        if (labels.at(i, j, k) != float(downstream)) continue;
        for (const auto& step :
             {std::array{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
          if (labels.at(i + step[0], j + step[1], k + step[2]) == float(upstream))
            touching.push_back(labels.position(Vec3(i, j, k) + 0.5 * Vec3(step[0], step[1], step[2])));
      }
  if (touching.size() < 50)
    throw InputError(
        "anatomy.annulus_labels: labels {} and {} touch in {} voxel faces, expected 50 at least; correct "
        "the labels or give anatomy.annulus_centre_mm and anatomy.annulus_normal",
        upstream, downstream, touching.size());
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : touching) centre += p / double(touching.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : touching) spread += (p - centre) * (p - centre).transpose();
  Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
  // Downstream is where the downstream label lies near the plane.
  double side = 0;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (labels.at(i, j, k) != float(downstream)) continue;
        const Vec3 away = labels.position(Vec3(i, j, k)) - centre;
        if (away.norm() < 15) side += away.dot(normal);
      }
  return Frame::at(centre, side < 0 ? Vec3(-normal) : normal);
}

Frame annulus_from_seeds(const Image& image, const std::vector<Vec3>& seeds, const LumenOptions& options) {
  if (seeds.size() < 2)
    throw InputError(
        "anatomy.seeds_mm: found {} seed, expected two at least (first upstream, last downstream of the "
        "valve), or anatomy.annulus_centre_mm and anatomy.annulus_normal",
        seeds.size());
  const Vec3 along = seeds.back() - seeds.front();
  const Frame rough = Frame::at(seeds.front(), along);
  const Image part = cropped(image, seeds.front() + along / 2, along.norm() + 40);
  const Statistics found = statistics_of(part, seeds, options);
  LumenOptions coarse = options;
  coarse.spacing_mm = 0.8;
  coarse.lower_cut_mm = 5;
  coarse.upper_cut_mm = along.norm();
  GridSdf field = working_grid(coarse, [&](const Vec3& x) {
    return (found.lumen_threshold - part.sample(rough.to_scanner(x))) / found.lumen_threshold;
  });
  const GridSdf lumen = parted(geometry::redistanced(field, reach_mm), options.opening_mm, 0,
                               {Vec3::Zero(), rough.from_scanner(seeds.back())});
  const auto line = geometry::follow(lumen, Vec3::Zero(), Vec3::UnitZ(), {});
  if (line.size() < 15)
    throw InputError(
        "segmentation is empty: from the upstream seed the lumen can be followed for {} mm only; move "
        "anatomy.seeds_mm or lower anatomy.lumen_threshold_HU (now {:.0f})",
        line.size(), found.lumen_threshold);
  const auto smaller = [](const auto& a, const auto& b) { return a.section.area_mm2 < b.section.area_mm2; };
  const auto widest = std::max_element(line.begin() + 10, line.end(), smaller);
  const auto narrowest = std::min_element(line.begin(), widest, smaller);
  return Frame::at(rough.to_scanner(narrowest->position), rough.axes * narrowest->tangent);
}

}  // namespace valsalva::segment
