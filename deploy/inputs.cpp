#include "inputs.hpp"

#include <cmath>

#include "core/errors.hpp"

namespace valsalva::deploy {
namespace {

const state::Array& data(const std::map<std::string, state::Array>& from, const std::string& name,
                         const std::string& body, const state::State& file) {
  const auto it = from.find(name);
  if (it == from.end())
    throw InputError(
        "{}: the mesh '{}' has no data '{}'; expected what docs/architecture.md lists: rerun the stage "
        "'{}'",
        file.source, body, name, file.stage);
  return it->second;
}

std::vector<Edge> pairs(const state::Array& array, const std::string& what) {
  const std::vector<std::int64_t>& flat = array.integers(what);
  if (flat.size() % 2) throw InputError("{}: {} integers; expected pairs", what, flat.size());
  std::vector<Edge> out;
  for (std::size_t i = 0; i < flat.size(); i += 2)
    out.push_back({static_cast<int>(flat[i]), static_cast<int>(flat[i + 1])});
  return out;
}

Points zero_or(const state::State& file, const std::string& name, std::size_t count) {
  if (!file.has_array(name)) return Points(count, Vec3::Zero());
  Points points = file.array(name).points(name);
  if (points.size() != count)
    throw InputError("{}: '{}' has {} entries; expected {}", file.source, name, points.size(), count);
  return points;
}

FrameBody read_frame(const state::State& crimp, const Parameters& p) {
  const state::Mesh& mesh = crimp.mesh("frame");
  structure::BeamMesh beams;
  beams.reference = data(mesh.point_data, "reference", "frame", crimp).points("frame/reference");
  beams.elements = mesh.lines("frame");
  beams.width_mm = data(mesh.cell_data, "width_mm", "frame", crimp).doubles("frame/width_mm");
  beams.depth_mm = data(mesh.cell_data, "depth_mm", "frame", crimp).doubles("frame/depth_mm");
  beams.depth_axis = structure::radial_directions(beams.reference, beams.elements);
  FrameBody frame;
  frame.network = std::make_shared<structure::BeamNetwork>(std::move(beams), p.frame);
  frame.points = mesh.points;
  frame.velocity = zero_or(crimp, "frame/velocity", frame.points.size());
  frame.angular_velocity = zero_or(crimp, "frame/angular_velocity", frame.points.size());
  const std::vector<double>& q = crimp.array("frame/rotation").doubles("frame/rotation");
  if (q.size() != 4 * frame.points.size())
    throw InputError("{}: 'frame/rotation' has {} values; expected four a node, {}", crimp.source, q.size(),
                     4 * frame.points.size());
  for (std::size_t a = 0; a < frame.points.size(); ++a)
    frame.rotation.push_back(
        Eigen::Quaterniond(q[4 * a], q[4 * a + 1], q[4 * a + 2], q[4 * a + 3]).normalized());
  return frame;
}

ShellBody read_shell(const state::State& file, const std::string& name, const Tissue& tissue, double factor,
                     bool native) {
  const state::Mesh& mesh = file.mesh(name);
  ShellBody body;
  body.name = name;
  body.points = mesh.points;
  body.velocity = zero_or(file, name + "/velocity", mesh.points.size());
  structure::ShellMesh shell;
  shell.triangles = mesh.triangles(name);
  shell.reference = data(mesh.point_data, "reference", name, file).points(name + "/reference");
  shell.thickness_mm = data(mesh.point_data, "thickness_mm", name, file).doubles(name + "/thickness_mm");
  shell.fibre1 = data(mesh.cell_data, "fibre1", name, file).points(name + "/fibre1");
  shell.fibre2 = data(mesh.cell_data, "fibre2", name, file).points(name + "/fibre2");
  shell.stiffness_factor.assign(shell.triangles.size(), factor);
  if (mesh.cell_data.count("stiffness_factor")) {
    const std::vector<double>& local =
        mesh.cell_data.at("stiffness_factor").doubles(name + "/stiffness_factor");
    for (std::size_t e = 0; e < local.size(); ++e) shell.stiffness_factor[e] *= local[e];
  }
  body.mounted =
      native ? mesh.points : data(mesh.point_data, "mounted", name, file).points(name + "/mounted");
  for (std::int64_t flag : data(mesh.point_data, "attached", name, file).integers(name + "/attached"))
    body.attached.push_back(flag != 0);
  body.shell =
      std::make_shared<structure::Shell>(std::move(shell), std::make_shared<materials::Hgo>(tissue.law),
                                         structure::Bending{tissue.bending_modulus_Pa, 0.5});
  body.density = tissue.density;
  return body;
}

geometry::GridSdf read_wall(const state::State& mesher) {
  const state::Array& values = mesher.array("levelset/lumen");
  if (values.shape.size() != 3)
    throw InputError("{}: 'levelset/lumen' has {} dimensions; expected 3 (nz, ny, nx)", mesher.source,
                     values.shape.size());
  geometry::GridSdf wall;
  wall.dimensions = {static_cast<int>(values.shape[2]), static_cast<int>(values.shape[1]),
                     static_cast<int>(values.shape[0])};
  wall.values = values.floats("levelset/lumen");
  const std::vector<double>& origin = mesher.array("levelset/origin_mm").doubles("levelset/origin_mm");
  if (origin.size() != 3)
    throw InputError("{}: 'levelset/origin_mm' has {} values; expected 3", mesher.source, origin.size());
  wall.origin = Vec3(origin[0], origin[1], origin[2]);
  wall.spacing = mesher.array("levelset/spacing_mm").number("levelset/spacing_mm");
  if (!(wall.spacing > 0))
    throw InputError("{}: 'levelset/spacing_mm' is {}; expected a positive number", mesher.source,
                     wall.spacing);
  return wall;
}

}  // namespace

Inputs read_inputs(const std::filesystem::path& crimp, const std::filesystem::path& mesher,
                   const Parameters& p) {
  Inputs in;
  in.crimp = state::read_final(crimp, "crimp");
  in.mesher = state::read_final(mesher, "mesher");
  in.frame = read_frame(in.crimp, p);
  for (const char* name : {"leaflets", "skirt"}) {
    if (!in.crimp.has_mesh(name)) continue;
    in.tissue.push_back(read_shell(in.crimp, name, p.device, 1, false));
    const std::string ties = std::string("ties/") + name;
    in.ties.push_back(pairs(in.crimp.array(ties), ties));
  }
  if (in.mesher.has_mesh("native_leaflets"))
    in.native = read_shell(in.mesher, "native_leaflets", p.native, p.stenosis_factor, true);
  in.wall = read_wall(in.mesher);
  return in;
}

}  // namespace valsalva::deploy
