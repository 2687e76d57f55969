// The device's frame as it stands in a state file: mesh "frame" (lines) with point data `reference`, cell
// data `width_mm` (circumferential) and `depth_mm` (radial); restart entry "frame/rotation" (n x 4): unit
// quaternions w x y z from the reference to the current nodal frame. Lengths mm.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "state/state.hpp"
#include "structure/beam.hpp"

namespace valsalva::bodies {

/// The stress-free frame; the depth axis points away from the z axis. InputError names what is missing.
structure::BeamMesh read_frame(const state::State& from);

/// The mesh of a state, at `points`; `mesh.depth_axis` is not kept.
state::Mesh frame_mesh(const Points& points, const structure::BeamMesh& mesh);

/// One a node. InputError unless there are `nodes` of them.
std::vector<Eigen::Quaterniond> read_rotations(const state::State& from, std::size_t nodes);

state::Array rotation_array(std::span<const Eigen::Quaterniond> rotations);

}  // namespace valsalva::bodies
