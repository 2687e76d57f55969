#include "bodies/level_set.hpp"

#include "core/errors.hpp"

namespace valsalva::bodies {

geometry::GridSdf read_level_set(const state::State& from, const std::string& name) {
  const std::string entry = "levelset/" + name;
  const state::Array& values = from.array(entry);
  if (values.shape.size() != 3)
    throw InputError("{}: '{}' has {} dimensions; expected 3 (nz, ny, nx); rerun the stage '{}'", from.source,
                     entry, values.shape.size(), from.stage);
  geometry::GridSdf grid;
  for (int d = 0; d < 3; ++d) grid.dimensions[d] = static_cast<int>(values.shape[2 - d]);
  grid.values = values.floats(entry);
  const auto& origin = from.array("levelset/origin_mm").doubles("levelset/origin_mm");
  if (origin.size() != 3)
    throw InputError("{}: 'levelset/origin_mm' has {} values; expected 3; rerun the stage '{}'", from.source,
                     origin.size(), from.stage);
  grid.origin = Vec3(origin[0], origin[1], origin[2]);
  grid.spacing = from.array("levelset/spacing_mm").number("levelset/spacing_mm");
  if (!(grid.spacing > 0))
    throw InputError("{}: 'levelset/spacing_mm' is {}; expected a positive length; rerun the stage '{}'",
                     from.source, grid.spacing, from.stage);
  return grid;
}

void put_level_set(state::State& to, const std::string& name, const geometry::GridSdf& grid) {
  const auto [nx, ny, nz] = grid.dimensions;
  to.restart["levelset/" + name] =
      state::Array::of(grid.values, {std::size_t(nz), std::size_t(ny), std::size_t(nx)});
  to.restart["levelset/origin_mm"] =
      state::Array::of(std::vector<double>{grid.origin.x(), grid.origin.y(), grid.origin.z()});
  to.restart["levelset/spacing_mm"] = state::Array::scalar(grid.spacing);
}

}  // namespace valsalva::bodies
