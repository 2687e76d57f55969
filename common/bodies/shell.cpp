#include "bodies/shell.hpp"

#include "core/errors.hpp"

namespace valsalva::bodies {

using state::Array;

structure::ShellMesh read_shell(const state::State& from, const std::string& name, double factor) {
  const state::Mesh& mesh = from.mesh(name);
  structure::ShellMesh shell;
  shell.reference = from.point_data(name, "reference").points(name + "/reference");
  shell.triangles = mesh.triangles(name);
  shell.thickness_mm = from.point_data(name, "thickness_mm").doubles(name + "/thickness_mm");
  shell.fibre1 = from.cell_data(name, "fibre1").points(name + "/fibre1");
  shell.fibre2 = from.cell_data(name, "fibre2").points(name + "/fibre2");
  shell.stiffness_factor.assign(shell.triangles.size(), factor);
  if (mesh.cell_data.count("stiffness_factor")) {
    const auto& local = from.cell_data(name, "stiffness_factor").doubles(name + "/stiffness_factor");
    for (std::size_t e = 0; e < local.size(); ++e) shell.stiffness_factor[e] *= local[e];
  }
  return shell;
}

std::vector<bool> read_attached(const state::State& from, const std::string& name) {
  std::vector<bool> attached;
  for (const std::int64_t flag : from.point_data(name, "attached").integers(name + "/attached"))
    attached.push_back(flag != 0);
  return attached;
}

state::Mesh shell_mesh(const Points& points, const structure::ShellMesh& shell,
                       std::vector<std::int64_t> attached, std::vector<std::int64_t> leaflet) {
  state::Mesh mesh = state::Mesh::of_triangles(points, shell.triangles);
  mesh.point_data["reference"] = Array::of(shell.reference);
  mesh.point_data["thickness_mm"] = Array::of(shell.thickness_mm);
  mesh.point_data["attached"] = Array::of(std::move(attached));
  mesh.cell_data["leaflet"] = Array::of(std::move(leaflet));
  mesh.cell_data["fibre1"] = Array::of(shell.fibre1);
  mesh.cell_data["fibre2"] = Array::of(shell.fibre2);
  if (!shell.stiffness_factor.empty()) mesh.cell_data["stiffness_factor"] = Array::of(shell.stiffness_factor);
  return mesh;
}

std::vector<Edge> read_ties(const state::State& from, const std::string& name, int tissue_nodes,
                            int frame_nodes) {
  const std::string entry = "ties/" + name;
  const auto& flat = from.array(entry).integers(entry);
  if (flat.size() % 2)
    throw InputError("{}: '{}' has {} integers; expected pairs", from.source, entry, flat.size());
  std::vector<Edge> ties;
  for (std::size_t i = 0; i < flat.size(); i += 2) {
    if (flat[i] < 0 || flat[i] >= tissue_nodes || flat[i + 1] < 0 || flat[i + 1] >= frame_nodes)
      throw InputError("{}: '{}' sews node {} to frame node {}; expected below {} and {}", from.source, entry,
                       flat[i], flat[i + 1], tissue_nodes, frame_nodes);
    ties.push_back({static_cast<int>(flat[i]), static_cast<int>(flat[i + 1])});
  }
  return ties;
}

Array tie_array(const std::vector<Edge>& ties) {
  std::vector<std::int64_t> flat;
  for (const auto& [tissue, frame] : ties) flat.insert(flat.end(), {tissue, frame});
  Array array = Array::of(std::move(flat));
  array.shape = {ties.size(), 2};
  return array;
}

}  // namespace valsalva::bodies
