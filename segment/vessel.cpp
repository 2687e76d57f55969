#include "vessel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"
#include "core/log.hpp"
#include "geometry/centreline.hpp"
#include "geometry/level_set.hpp"
#include "lumen_field.hpp"

namespace valsalva::segment {
namespace {

using geometry::GridSdf;

constexpr double least_upper_cut_mm = 20;
constexpr double most_oblique = 1.6;   // area of the upper cut over that of the normal section
constexpr double least_compact = 1.5;  // perimeter^2 / (4 pi area); an ellipse of 27 x 20 mm has 1.05
constexpr double outflow_mm = 8;       // so far down the outflow tract is a tube of its own
constexpr double widest_annulus_mm = 42, widest_section_mm2 = 2400;  // beyond any patient's
constexpr double below_cut_mm = 3;  // searched below the lower cut; more would reach round the mitral leaflet
constexpr double grid_margin_mm = 14;
constexpr double corner_mm = 1.5;  // regained at corners and edges after the parting
constexpr double strictness_step = 0.15, most_strict = 0.6;
constexpr double least_upright = 0.6;  // cosine between the vessel and the axis at the upper cut

std::string threshold_words(const Statistics& found) {
  return found.blood > 0 ? fmt::format("anatomy.lumen_threshold_HU (now {:.0f})", found.lumen_threshold)
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
double upper_cut(const GridSdf& lumen, double wanted, double half_width_mm, std::string& note) {
  geometry::CentrelineOptions options;
  const auto line = geometry::follow(lumen, Vec3::Zero(), Vec3::UnitZ(), options);
  double reached = 0;
  for (const auto& p : line) {
    if (p.arc_mm > 15 && p.tangent.z() < least_upright) {
      note = fmt::format("the aorta leans by more than {:.0f} degrees from z = {:.0f} mm on",
                         std::acos(least_upright) * 180 / std::numbers::pi, p.position.z());
      break;
    }
    const geometry::Plane level = geometry::Plane::at(p.position, Vec3::UnitZ());
    const geometry::Loop loop =
        geometry::loop_at_origin(geometry::section(lumen, level, options.half_width_mm, options.lattice_mm));
    if (loop.empty() || geometry::area(loop) > most_oblique * p.section.area_mm2) {
      note = fmt::format("a horizontal cut is no round disc from z = {:.0f} mm on", p.position.z());
      break;
    }
    double edge = 0;
    for (const geometry::Vec2& corner : loop) {
      const Vec3 x = level.point(corner);
      edge = std::max(edge, std::hypot(x.x(), x.y()));
    }
    if (p.position.z() > 0 && edge > guard_radius(p.position.z(), half_width_mm) - 2) {
      note = fmt::format("the aorta leaves the searched space from z = {:.0f} mm on", p.position.z());
      break;
    }
    reached = std::max(reached, p.position.z());
    if (reached >= wanted) return wanted;
  }
  if (note.empty()) note = fmt::format("the lumen can be followed up to z = {:.0f} mm only", reached);
  return std::floor(reached);
}

GridSdf every_second(const GridSdf& field) {
  GridSdf coarse;
  coarse.origin = field.origin;
  coarse.spacing = 2 * field.spacing;
  for (int d = 0; d < 3; ++d) coarse.dimensions[d] = (field.dimensions[d] + 1) / 2;
  for (int k = 0; k < field.dimensions[2]; k += 2)
    for (int j = 0; j < field.dimensions[1]; j += 2)
      for (int i = 0; i < field.dimensions[0]; i += 2) coarse.values.push_back(field.at(i, j, k));
  return coarse;
}

/// The part of the grid, at full height, within `margin_mm` of the body in x and y.
GridSdf around(const GridSdf& field, const GridSdf& body, double margin_mm) {
  Vec3 low = Vec3::Constant(1e9), high = -low;
  for (int k = 0; k < body.dimensions[2]; ++k)
    for (int j = 0; j < body.dimensions[1]; ++j)
      for (int i = 0; i < body.dimensions[0]; ++i)
        if (body.at(i, j, k) < 0) {
          const Vec3 x = body.origin + body.spacing * Vec3(i, j, k);
          low = low.cwiseMin(x);
          high = high.cwiseMax(x);
        }
  std::array<int, 3> first{0, 0, 0}, last{0, 0, field.dimensions[2] - 1};
  for (int d = 0; d < 2; ++d) {
    first[d] = std::max(0, int((low[d] - margin_mm - field.origin[d]) / field.spacing));
    last[d] =
        std::min(field.dimensions[d] - 1, int((high[d] + margin_mm - field.origin[d]) / field.spacing) + 1);
  }
  return geometry::cropped(field, first, last);
}

/// What is found of the vessel when walls are looked for at one threshold; `leak` says what is wrong with it,
/// empty when nothing is.
struct Attempt {
  GridSdf distance;
  double z_upper_mm = 0;
  std::string cut_note, leak;
};

/// body: signed distance at the lumen threshold; strict: the same at the threshold for walls.
Attempt attempt(const GridSdf& body, const GridSdf& strict, const Frame& frame,
                const std::vector<Vec3>& seeds, const LumenOptions& options) {
  const auto annulus_loop = [&](const GridSdf& of) {
    return geometry::loop_at_origin(geometry::section(of, geometry::Plane::at(Vec3::Zero(), Vec3::UnitZ()),
                                                      options.half_width_mm, options.spacing_mm));
  };
  const auto implausible = [](const geometry::Loop& loop) -> std::string {
    if (loop.empty()) return {};
    const double width = geometry::caliper(loop).greatest_mm, length = geometry::perimeter(loop);
    const double compactness = length * length / (4 * std::numbers::pi * geometry::area(loop));
    if (width > widest_annulus_mm)
      return fmt::format("the section at the annulus plane is {:.0f} mm wide, expected {:.0f} mm at most",
                         width, widest_annulus_mm);
    if (compactness > least_compact)
      return fmt::format(
          "the section at the annulus plane has a perimeter of {:.0f} mm around {:.0f} mm2, too long for "
          "an annulus",
          length, geometry::area(loop));
    return {};
  };
  Attempt result;
  GridSdf& distance = result.distance;
  distance = parted(strict, options.opening_mm, seeds);
  Vec3 where;
  if (touches_guard(distance, -outflow_mm, 0, options.half_width_mm, &where)) {
    result.leak = fmt::format("the outflow tract runs into a neighbour at {}, {:.0f} mm below the annulus",
                              text_of(frame.to_scanner(where)), -where.z());
    return result;
  }
  // The edge itself is that of the lumen threshold; only now are leaflets filled: before, the closing would
  // bridge the thin walls between neighbours.
  distance = within(body, distance, corner_mm);
  distance = geometry::redistanced(geometry::component_at(distance, seeds), vessel_reach_mm);
  if (options.closing_mm > 0) distance = closed(distance, options.closing_mm);
  const geometry::Loop loop = annulus_loop(distance);
  result.leak = implausible(loop);
  if (!result.leak.empty()) return result;
  if (loop.empty()) {
    result.cut_note = "there is no lumen at the annulus";
    return result;
  }
  limit_to_channel(distance, loop, options.channel_margin_mm);
  distance = parted(geometry::redistanced(distance, vessel_reach_mm), options.opening_mm, seeds);
  result.z_upper_mm = upper_cut(distance, options.upper_cut_mm, options.half_width_mm, result.cut_note);
  if (touches_guard(distance, 0, result.z_upper_mm, options.half_width_mm, &where))
    result.leak =
        fmt::format("the lumen reaches the side of the searched space at {}, {:.0f} mm above the annulus",
                    text_of(frame.to_scanner(where)), where.z());
  continue_straight(distance, -options.lower_cut_mm, result.z_upper_mm);
  distance = geometry::redistanced(geometry::component_at(distance, {Vec3::Zero()}), vessel_reach_mm);
  for (double z = 0; z <= result.z_upper_mm && result.leak.empty(); z += 2) {
    const double area = area_at(distance, z);
    if (area > widest_section_mm2)
      result.leak =
          fmt::format("the section {:.0f} mm above the annulus has {:.0f} mm2, expected {:.0f} mm2 at most",
                      z, area, widest_section_mm2);
  }
  return result;
}

}  // namespace

std::string text_of(const Vec3& p) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm LPS", p.x(), p.y(), p.z());
}

Lumen vessel_of(GridSdf field, const Frame& frame, const std::vector<Vec3>& seeds,
                const LumenOptions& options, const Statistics& found) {
  std::vector<Vec3> inside{Vec3::Zero()};
  for (const Vec3& seed : seeds) inside.push_back(frame.from_scanner(seed));
  limit_to_guard(field, options.half_width_mm, -options.lower_cut_mm - below_cut_mm);
  // On a coarser grid first: it is faster, and its result says which part of the grid is needed.
  const auto search = [&](const GridSdf& on, double& strictness) {
    const GridSdf body = geometry::redistanced(on, vessel_reach_mm);
    for (;; strictness += strictness_step) {
      GridSdf strict = on;
      for (float& value : strict.values) value += float(strictness * options.spacing_mm);
      Attempt found_here =
          attempt(body, strictness > 0 ? geometry::redistanced(strict, vessel_reach_mm) : body, frame, inside,
                  options);
      if (found_here.leak.empty() || strictness + strictness_step > most_strict) return found_here;
      log::info("walls {:.0f} % of the way from edge to blood: {}", 100 * strictness, found_here.leak);
    }
  };
  double strictness = 0;
  Attempt best = search(every_second(field), strictness);
  if (best.leak.empty() && best.z_upper_mm >= least_upper_cut_mm)
    best = search(around(field, best.distance, grid_margin_mm), strictness);
  if (!best.leak.empty())
    throw InputError(
        "segmentation leaks: {}; raise {}, move anatomy.annulus_centre_mm, turn anatomy.annulus_normal or "
        "lower anatomy.upper_cut_mm (now {:g})",
        best.leak, threshold_words(found), options.upper_cut_mm);
  if (best.z_upper_mm < least_upper_cut_mm)
    throw InputError(
        "segmentation is empty: {}, expected {:.0f} mm of lumen above the annulus {} at least; lower {}, "
        "or move anatomy.annulus_centre_mm",
        best.cut_note, least_upper_cut_mm, text_of(frame.origin), threshold_words(found));
  if (area_at(best.distance, -options.lower_cut_mm) < 0.3 * area_at(best.distance, 0))
    throw InputError(
        "the lumen ends above the lower cut, {:g} mm below the annulus {}; lower anatomy.lower_cut_mm",
        options.lower_cut_mm, text_of(frame.origin));
  Lumen lumen;
  lumen.frame = frame;
  lumen.statistics = found;
  lumen.cut_note = best.cut_note;
  lumen.wall_strictness = strictness;
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

}  // namespace valsalva::segment
