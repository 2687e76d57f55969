#include "anatomy_state.hpp"

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

geometry::GridSdf grid_of(const state::State& segment, const std::string& name) {
  const state::Array& array = segment.array(name);
  if (array.shape.size() != 3)
    throw InputError("{}: {} has {} dimensions; expected 3 (nz, ny, nx)", segment.source, name,
                     array.shape.size());
  geometry::GridSdf grid;
  for (int d = 0; d < 3; ++d) grid.dimensions[d] = static_cast<int>(array.shape[2 - d]);
  const auto origin = numbers(segment, "levelset/origin_mm", 3);
  grid.origin = Vec3(origin[0], origin[1], origin[2]);
  grid.spacing = segment.array("levelset/spacing_mm").number("levelset/spacing_mm");
  if (!(grid.spacing > 0))
    throw InputError("{}: levelset/spacing_mm is {}; expected a positive length", segment.source,
                     grid.spacing);
  grid.values = array.floats(name);
  return grid;
}

}  // namespace

AnatomyState anatomy_of(const state::State& segment) {
  AnatomyState anatomy;
  const state::Mesh& lumen = segment.mesh("lumen");
  anatomy.surface = {lumen.points, lumen.triangles("lumen of " + segment.source)};
  anatomy.lumen = grid_of(segment, "levelset/lumen");
  if (segment.has_array("levelset/calcium")) anatomy.calcium = grid_of(segment, "levelset/calcium");
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
