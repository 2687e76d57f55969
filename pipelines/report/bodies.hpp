// The bodies of a state as coloured surfaces, the same for still pictures and for the interactive view.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/grid_sdf.hpp"
#include "render/shapes.hpp"
#include "state/state.hpp"

namespace valsalva::report {

struct Body {
  std::string id;     ///< the mesh's name in the state
  std::string label;  ///< as readers see it
  Surface surface;
};

/// Bodies of the state in drawing order; meshes that are not drawn (wall tetrahedra, centreline) are left
/// out. Struts become tubes of the section's mean radius (0.18 mm where the mesh has no section).
std::vector<Body> bodies_of(const state::State& state, int tube_sides = 8);

const Body* find_body(const std::vector<Body>& bodies, const std::string& id);

/// The moving valve's mesh name: `leaflets`, or `native_leaflets` where there is no device. Empty: neither.
std::string valve_of(const state::State& state);

/// Numbers of an array of any type.
std::vector<double> values_of(const state::Array& array);

/// The lumen's level set, when the state holds one.
std::optional<geometry::GridSdf> lumen_level_set(const state::State& state);

/// The stored frames of a beat (restart group `frames` of cycle).
struct Beat {
  std::vector<double> time_s;
  std::vector<Points> valve;   ///< nodes of the moving valve, frame by frame
  std::size_t nx = 0, nz = 0;  ///< samples of the slice, the plane y = origin.y
  Vec3 origin = Vec3::Zero(), spacing = Vec3::Ones();
  std::vector<std::vector<double>> speed_cm_per_s;  ///< frame by frame, x fastest
  std::vector<std::vector<double>> pressure_mmHg;   ///< may be empty

  /// The frames to show. Open: the fastest flow among those where the leaflets stand wide. Closed: the
  /// largest pressure drop from the top of the slice to its bottom. By shape alone (widest, narrowest)
  /// without slices.
  std::size_t open = 0, closed = 0;
};

/// Nothing when the state has no frames; InputError when their shapes do not agree.
std::optional<Beat> beat_of(const state::State& state);

}  // namespace valsalva::report
