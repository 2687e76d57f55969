#include "device.hpp"

#include "core/errors.hpp"

namespace valsalva::crimp {
namespace {

const state::Array& data(const std::map<std::string, state::Array>& from, const std::string& name,
                         const std::string& body, const state::State& file) {
  const auto found = from.find(name);
  if (found == from.end())
    throw InputError(
        "{}: the mesh '{}' has no data '{}'; expected what docs/architecture.md lists: rerun 'stent'",
        file.source, body, name);
  return found->second;
}

TissueBody read_tissue(const state::State& stent, const std::string& name, const Parameters& p,
                       int frame_nodes) {
  const state::Mesh& mesh = stent.mesh(name);
  structure::ShellMesh shell;
  shell.reference = data(mesh.point_data, "reference", name, stent).points(name + "/reference");
  shell.triangles = mesh.triangles(name);
  shell.thickness_mm = data(mesh.point_data, "thickness_mm", name, stent).doubles(name + "/thickness_mm");
  shell.fibre1 = data(mesh.cell_data, "fibre1", name, stent).points(name + "/fibre1");
  shell.fibre2 = data(mesh.cell_data, "fibre2", name, stent).points(name + "/fibre2");
  TissueBody body{name, nullptr, mesh.points, {}};
  body.shell =
      std::make_shared<structure::Shell>(std::move(shell), std::make_shared<materials::Hgo>(p.tissue_law),
                                         structure::Bending{p.bending_modulus_Pa, 0.5});
  const std::string entry = "ties/" + name;
  const auto& flat = stent.array(entry).integers(entry);
  for (std::size_t i = 0; i + 1 < flat.size(); i += 2) {
    if (flat[i] < 0 || flat[i] >= body.shell->nodes() || flat[i + 1] < 0 || flat[i + 1] >= frame_nodes)
      throw InputError("{}: '{}' sews node {} to frame node {}; expected below {} and {}", stent.source,
                       entry, flat[i], flat[i + 1], body.shell->nodes(), frame_nodes);
    body.ties.push_back({static_cast<int>(flat[i]), static_cast<int>(flat[i + 1])});
  }
  return body;
}

}  // namespace

Device read_device(const state::State& stent, const Parameters& p) {
  const state::Mesh& mesh = stent.mesh("frame");
  structure::BeamMesh beams;
  beams.reference = data(mesh.point_data, "reference", "frame", stent).points("frame/reference");
  beams.elements = mesh.lines("frame");
  beams.width_mm = data(mesh.cell_data, "width_mm", "frame", stent).doubles("frame/width_mm");
  beams.depth_mm = data(mesh.cell_data, "depth_mm", "frame", stent).doubles("frame/depth_mm");
  beams.depth_axis = structure::radial_directions(beams.reference, beams.elements);
  Device device;
  device.frame = std::make_shared<structure::BeamNetwork>(std::move(beams), p.frame);
  for (const char* name : {"leaflets", "skirt"})
    if (stent.has_mesh(name)) device.tissue.push_back(read_tissue(stent, name, p, device.frame->nodes()));
  return device;
}

structure::System make_system(const Device& device, const Parameters& p) {
  structure::System system;
  const auto& frame = *device.frame;
  system.add_rotational_body("frame", frame.mesh().reference, frame.lumped_mass(),
                             std::vector<Eigen::Quaterniond>(frame.nodes(), Eigen::Quaterniond::Identity()),
                             frame.lumped_inertia());
  for (const auto& body : device.tissue)
    system.add_body(body.name, body.mounted, body.shell->lumped_mass(p.tissue_density));
  return system;
}

std::vector<std::shared_ptr<structure::ForceTerm>> elastic_terms(const Device& device, const Parameters& p,
                                                                 const structure::System& system) {
  std::vector<std::shared_ptr<structure::ForceTerm>> terms;
  terms.push_back(std::make_shared<structure::BeamTerm>(device.frame, system.body("frame")));
  for (const auto& body : device.tissue) {
    terms.push_back(std::make_shared<structure::ShellTerm>(body.shell, system.body(body.name)));
    terms.push_back(std::make_shared<structure::TieTerm>(
        "ties of " + body.name,
        structure::ties_in_reference(body.mounted, device.frame->mesh().reference, body.ties,
                                     system.body(body.name), system.body("frame"), p.tie_uN_per_mm),
        system));
  }
  return terms;
}

}  // namespace valsalva::crimp
