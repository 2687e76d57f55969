// Signed distances as they stand in a state file: restart entry "levelset/<name>" (float, nz ny nx; negative
// inside), on the grid of "levelset/origin_mm" (3) and "levelset/spacing_mm".
#pragma once

#include <string>

#include "geometry/grid_sdf.hpp"
#include "state/state.hpp"

namespace valsalva::bodies {

/// "levelset/<name>". InputError names the file, the entry, what was found and what is expected.
geometry::GridSdf read_level_set(const state::State& from, const std::string& name);

/// All level sets of a state share one grid: the entries of origin and spacing are written with each.
void put_level_set(state::State& to, const std::string& name, const geometry::GridSdf& grid);

}  // namespace valsalva::bodies
