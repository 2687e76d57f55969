#include "output.hpp"

#include "bodies/frame.hpp"
#include "bodies/frame_law.hpp"
#include "core/errors.hpp"
#include "state/checkpoint.hpp"

namespace valsalva::deploy {
namespace {

using state::Array;

constexpr const char* prefix = "deploy/snapshot/";

state::Mesh shell_now(const state::State& parent, const ShellBody& body, const Simulation& s) {
  state::Mesh mesh = parent.mesh(body.name);
  if (!s.has(body.name)) {
    mesh.points = body.points;
    return mesh;
  }
  mesh.points = s.points(body.name);
  mesh.point_data.erase("velocity");
  const int offset = s.system().body(body.name).offset;
  std::vector<double> stress, stretch;
  for (int e = 0; e < body.shell->elements(); ++e) {
    const structure::ElementState now = body.shell->element_state(s.system().state.x, e, offset);
    stress.push_back(now.von_mises_Pa);
    stretch.push_back(now.stretch_major);
  }
  mesh.cell_data["von_mises_Pa"] = Array::of(std::move(stress));
  mesh.cell_data["stretch_major"] = Array::of(std::move(stretch));
  return mesh;
}

void copy_entries(const state::State& from, state::State& to) {
  for (const auto& [name, array] : from.restart)
    if (!name.starts_with("integrator/") && name != "crimp/history") to.restart[name] = array;
  for (const auto& [name, text] : from.texts) to.texts[name] = text;
}

}  // namespace

state::State snapshot(const StageContext& context, const Simulation& s, const Inputs& in, Act act, long step,
                      const History& history, double largest_ratio) {
  state::State out = state::begin(context, s.time_s(), step);
  copy_entries(in.mesher, out);
  copy_entries(in.crimp, out);
  for (const char* name : {"lumen", "wall"})
    if (in.mesher.has_mesh(name)) out.meshes[name] = in.mesher.mesh(name);
  for (const ShellBody& body : in.tissue) out.meshes[body.name] = shell_now(in.crimp, body, s);
  if (in.native) out.meshes[in.native->name] = shell_now(in.mesher, *in.native, s);
  state::Mesh frame = in.crimp.mesh("frame");
  const bool placed = s.has("frame");
  frame.point_data.erase("velocity");
  frame.points = placed ? s.points("frame") : in.frame.points;
  out.meshes["frame"] = std::move(frame);
  if (placed) {
    const structure::Body& body = s.system().body("frame");
    out.restart["frame/rotation"] = bodies::rotation_array(
        std::span(s.system().state.rotation).subspan(body.rotation_offset, body.count));
    bodies::write_fibres(s.struts()->history(), out);
    const Points& spin = s.system().state.angular_velocity;
    out.restart["frame/angular_velocity"] = Array::of(
        Points(spin.begin() + body.rotation_offset, spin.begin() + body.rotation_offset + body.count));
  }
  for (const structure::Body& body : s.system().bodies())
    out.restart[body.name + "/velocity"] = Array::of(s.velocities(body.name));
  for (const auto& [name, values] : s.integrator().save())
    if (!values.empty()) out.restart[prefix + name] = Array::of(values);
  out.restart["deploy/act"] = Array::scalar(static_cast<double>(act));
  out.restart["deploy/largest_energy_ratio"] = Array::scalar(largest_ratio);
  if (history.rows() > 0) out.restart["deploy/history"] = Array::of(history.values());
  return out;
}

void add_results(state::State& out, const Measures& m, const Placement& placement) {
  out.restart["deploy/contact_force_uN"] = Array::of(m.frame_force_uN);
  out.restart["deploy/friction_capacity_uN"] = Array::of(m.friction_capacity_uN);
  out.restart["deploy/implant_depth_mm"] = Array::scalar(m.implant_depth_mm);
  out.restart["deploy/tilt_deg"] = Array::scalar(placement.tilt_deg);
  state::Mesh& frame = out.meshes["frame"];
  frame.point_data["contact_force_uN"] = Array::of(m.frame_force_uN);
  frame.point_data["friction_capacity_uN"] = Array::of(m.friction_capacity_uN);
}

Restored restored_from(const state::State& state, History& history) {
  Restored r;
  r.act = static_cast<Act>(static_cast<int>(state.array("deploy/act").number("deploy/act")));
  r.step = static_cast<long>(state.step);
  r.largest_ratio = state.array("deploy/largest_energy_ratio").number("deploy/largest_energy_ratio");
  for (const auto& [name, array] : state.restart)
    if (name.rfind(prefix, 0) == 0) r.snapshot[name.substr(std::string(prefix).size())] = array.doubles(name);
  if (state.has_array("deploy/history"))
    history.restore(state.array("deploy/history").doubles("deploy/history"));
  return r;
}

}  // namespace valsalva::deploy
