#include "dry_state.hpp"

#include "assembly/probes.hpp"
#include "core/units.hpp"

namespace valsalva::cycle {
namespace {

using state::Array;

const std::string prefix = "scene/";

state::Mesh mesh_of(const assembly::BuiltBody& body, const Points& x) {
  if (body.kind == assembly::Kind::beams) return state::Mesh::of_lines(x, body.mesh.lines);
  if (body.kind != assembly::Kind::solid) return state::Mesh::of_triangles(x, body.mesh.triangles);
  state::Mesh mesh;
  mesh.points = x;
  mesh.offsets.push_back(0);
  for (const assembly::SolidCell& cell : body.mesh.solids) {
    mesh.connectivity.insert(mesh.connectivity.end(), cell.nodes.begin(), cell.nodes.end());
    mesh.offsets.push_back(static_cast<std::int64_t>(mesh.connectivity.size()));
    mesh.types.push_back(static_cast<std::uint8_t>(cell.shape));
  }
  return mesh;
}

}  // namespace

void add_bodies(state::State& out, const assembly::Scene& scene) {
  const structure::Configuration& now = scene.system->state;
  for (const assembly::BuiltBody& body : scene.bodies) {
    const Points x = body.places(now), &rest = body.mesh.points;
    Points displacement(x.size());
    for (std::size_t a = 0; a < x.size(); ++a) displacement[a] = x[a] - rest[a];
    state::Mesh mesh = mesh_of(body, x);
    mesh.point_data["reference"] = Array::of(rest);
    mesh.point_data["displacement"] = Array::of(displacement);
    mesh.point_data["velocity"] =
        Array::of(Points(now.v.begin() + body.at.begin(), now.v.begin() + body.at.end()));
    assembly::ElementField field = assembly::element_field(body, now);
    if (!field.stretch.empty()) mesh.cell_data["stretch"] = Array::of(field.stretch);
    for (double& stress : field.von_mises_Pa) stress /= units::pa_per_kPa;
    if (!field.von_mises_Pa.empty()) mesh.cell_data["von_mises_kPa"] = Array::of(field.von_mises_Pa);
    for (auto& [name, layer] : field.layers) {
      std::vector<std::size_t> shape{layer.values.size() / layer.components};
      if (layer.components > 1) shape.push_back(layer.components);
      mesh.cell_data[name] = Array::of(std::move(layer.values), std::move(shape));
    }
    out.meshes[body.name] = std::move(mesh);
  }
}

void add_snapshot(state::State& out, const structure::Snapshot& snapshot) {
  for (const auto& [name, values] : snapshot)
    if (!values.empty()) out.restart[prefix + name] = Array::of(values);
}

structure::Snapshot snapshot_of(const state::State& s) {
  structure::Snapshot snapshot;
  for (const auto& [name, array] : s.restart)
    if (name.starts_with(prefix)) snapshot[name.substr(prefix.size())] = array.doubles(name);
  return snapshot;
}

}  // namespace valsalva::cycle
