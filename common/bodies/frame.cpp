#include "bodies/frame.hpp"

#include "core/errors.hpp"

namespace valsalva::bodies {

structure::BeamMesh read_frame(const state::State& from) {
  structure::BeamMesh mesh;
  mesh.reference = from.point_data("frame", "reference").points("frame/reference");
  mesh.elements = from.mesh("frame").lines("frame");
  mesh.width_mm = from.cell_data("frame", "width_mm").doubles("frame/width_mm");
  mesh.depth_mm = from.cell_data("frame", "depth_mm").doubles("frame/depth_mm");
  mesh.depth_axis = structure::radial_directions(mesh.reference, mesh.elements);
  return mesh;
}

state::Mesh frame_mesh(const Points& points, const structure::BeamMesh& mesh) {
  state::Mesh out = state::Mesh::of_lines(points, mesh.elements);
  out.point_data["reference"] = state::Array::of(mesh.reference);
  out.cell_data["width_mm"] = state::Array::of(mesh.width_mm);
  out.cell_data["depth_mm"] = state::Array::of(mesh.depth_mm);
  return out;
}

std::vector<Eigen::Quaterniond> read_rotations(const state::State& from, std::size_t nodes) {
  const std::vector<double>& q = from.array("frame/rotation").doubles("frame/rotation");
  if (q.size() != 4 * nodes)
    throw InputError("{}: 'frame/rotation' has {} values; expected four a node, {}", from.source, q.size(),
                     4 * nodes);
  std::vector<Eigen::Quaterniond> rotations;
  for (std::size_t a = 0; a < nodes; ++a)
    rotations.push_back(Eigen::Quaterniond(q[4 * a], q[4 * a + 1], q[4 * a + 2], q[4 * a + 3]).normalized());
  return rotations;
}

state::Array rotation_array(std::span<const Eigen::Quaterniond> rotations) {
  std::vector<double> values;
  for (const auto& q : rotations) values.insert(values.end(), {q.w(), q.x(), q.y(), q.z()});
  return state::Array::of(std::move(values), {rotations.size(), 4});
}

}  // namespace valsalva::bodies
