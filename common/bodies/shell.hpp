// A shell (`leaflets`, `skirt`, `native_leaflets`) as it stands in a state file: mesh of triangles with point
// data `reference` (stress-free), `thickness_mm`, `attached` (1 on the edge that is clamped or sewn), cell
// data `leaflet` (0, 1, 2; skirt 3), `fibre1`, `fibre2` (unit, tangent to the reference) and, where tissue is
// calcified, `stiffness_factor`. Sewn ones have the restart entry "ties/<body>": n x 2 integers, tissue node
// and frame node. Lengths mm.
#pragma once

#include <string>

#include "state/state.hpp"
#include "structure/shell.hpp"

namespace valsalva::bodies {

/// The stress-free shell; `factor` multiplies the stiffness everywhere, on top of the state's own
/// `stiffness_factor`. InputError names what is missing.
structure::ShellMesh read_shell(const state::State& from, const std::string& name, double factor = 1);

/// Of each node: is it on the attached edge?
std::vector<bool> read_attached(const state::State& from, const std::string& name);

/// The mesh of a state, at `points`; attached: a node, leaflet: a triangle. `shell.stiffness_factor` is
/// written where it is not empty.
state::Mesh shell_mesh(const Points& points, const structure::ShellMesh& shell,
                       std::vector<std::int64_t> attached, std::vector<std::int64_t> leaflet);

/// InputError when a node is not one of the tissue's or the frame's.
std::vector<Edge> read_ties(const state::State& from, const std::string& name, int tissue_nodes,
                            int frame_nodes);

state::Array tie_array(const std::vector<Edge>& ties);

}  // namespace valsalva::bodies
