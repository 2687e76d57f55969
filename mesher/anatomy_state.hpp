// What the mesher takes from segment's state, checked.
#pragma once

#include <array>
#include <optional>

#include "geometry/grid_sdf.hpp"
#include "geometry/mesh.hpp"
#include "state/state.hpp"

namespace valsalva::mesher {

struct AnatomyState {
  geometry::TriMesh surface;
  geometry::GridSdf lumen;
  std::optional<geometry::GridSdf> calcium;
  std::array<double, 3> commissure_angles_rad{};
  double lower_cut_mm = 0, junction_mm = 0, upper_cut_mm = 0;
  double annulus_diameter_mm = 0;
};

/// InputError that names the entry when one is missing or makes no sense.
AnatomyState anatomy_of(const state::State& segment);

/// Copies levelset/* and anatomy/* for the later stages.
void copy_anatomy(const state::State& segment, state::State& out);

}  // namespace valsalva::mesher
