#include "anatomy_state.hpp"

#include "bodies/level_set.hpp"
#include "core/errors.hpp"

namespace valsalva::mesher {
namespace {

std::vector<double> numbers(const state::State& segment, const std::string& name, std::size_t count) {
  const auto& values = segment.array(name).doubles(name);
  if (values.size() != count)
    throw InputError("{}: {} has {} values; expected {}: rerun valsalva-segment", segment.source, name,
                     values.size(), count);
  return values;
}

}  // namespace

AnatomyState anatomy_of(const state::State& segment) {
  AnatomyState anatomy;
  const state::Mesh& lumen = segment.mesh("lumen");
  anatomy.surface = {lumen.points, lumen.triangles("lumen of " + segment.source)};
  anatomy.lumen = bodies::read_level_set(segment, "lumen");
  if (segment.has_array("levelset/calcium")) anatomy.calcium = bodies::read_level_set(segment, "calcium");
  const auto angles = numbers(segment, "anatomy/commissure_angles_rad", 3);
  anatomy.commissure_angles_rad = {angles[0], angles[1], angles[2]};
  const auto z = numbers(segment, "anatomy/z_mm", 6);
  anatomy.lower_cut_mm = z[0];
  anatomy.junction_mm = z[4];
  anatomy.upper_cut_mm = z[5];
  if (!(z[0] < 0 && 0 < z[4] && z[4] < z[5]))
    throw InputError(
        "{}: anatomy/z_mm has lower cut {}, junction {}, upper cut {} mm; expected lower cut < 0 < junction "
        "< upper cut",
        segment.source, z[0], z[4], z[5]);
  anatomy.annulus_diameter_mm =
      segment.array("anatomy/annulus_diameter_mm").number("anatomy/annulus_diameter_mm");
  return anatomy;
}

void copy_anatomy(const state::State& segment, state::State& out) {
  for (const auto& [name, array] : segment.restart)
    if (name.starts_with("levelset/") || name.starts_with("anatomy/")) out.restart[name] = array;
}

}  // namespace valsalva::mesher
