#include "simulation.hpp"

#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "structure/pressure.hpp"

namespace valsalva::deploy {
namespace {

using structure::Body;

double smooth(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

/// 1 until `from`, smoothly to 0 at `to`.
double fade(double time, double from, double to) {
  return 1 - smooth((time - from) / (to - from));
}

std::vector<double> half_thickness(const structure::Shell& shell, double fraction) {
  std::vector<double> radius = shell.mesh().thickness_mm;
  for (double& r : radius) r *= 0.5 * fraction;
  return radius;
}

std::vector<double> strut_radius(const structure::BeamNetwork& network) {
  std::vector<double> radius;
  for (int e = 0; e < network.elements(); ++e)
    radius.push_back(0.5 * std::min(network.mesh().width_mm[e], network.mesh().depth_mm[e]));
  return radius;
}

/// Half of every adjacent strut's length times its width.
std::vector<double> strut_area(const structure::BeamNetwork& network) {
  std::vector<double> area(network.nodes(), 0.0);
  const auto& mesh = network.mesh();
  for (int e = 0; e < network.elements(); ++e) {
    const double length = (mesh.reference[mesh.elements[e][1]] - mesh.reference[mesh.elements[e][0]]).norm();
    for (int a : mesh.elements[e]) area[a] += 0.5 * length * mesh.width_mm[e];
  }
  return area;
}

/// Nodes of a shell that meet the wall. A node fitted closer to the wall than its half thickness keeps its
/// distance; attached nodes and those that start inside the wall belong to it.
std::vector<contact::SurfaceNode> shell_surface(const ShellBody& body, const Body& at,
                                                const geometry::GridSdf* wall) {
  std::vector<contact::SurfaceNode> nodes;
  const std::vector<double> area = body.shell->lumped_area();
  for (int a = 0; a < at.count; ++a) {
    double radius = 0.5 * body.shell->mesh().thickness_mm[a];
    if (wall) {
      const double room = -wall->value(body.mounted[a]);
      if (body.attached[a] || room <= 0) continue;
      radius = std::min(radius, room);
    }
    nodes.push_back({at.offset + a, radius, area[a]});
  }
  return nodes;
}

}  // namespace

Schedule schedule(const Inputs& in, const Placement& placement, const Parameters& p) {
  Schedule s;
  s.opened_s = in.native ? p.open_ramp_s + p.open_hold_s : 0;
  const double travel = placement.high_mm - placement.low_mm + 3;
  s.clear_s = s.opened_s + (p.sheath ? travel / p.sheath_speed : 0);
  s.expanded_s = p.sheath ? s.clear_s + 0.3 * p.expand_s : s.opened_s + p.expand_s;
  s.unloaded_s = s.expanded_s + 0.5 * p.settle_s;
  s.end_s = s.expanded_s + p.settle_s;
  return s;
}

void Simulation::add_native(const Inputs& in, const Points& x) {
  const ShellBody& native = *in.native;
  const Body body = system_->add_body(native.name, x, native.shell->lumped_mass(native.density));
  for (int a = 0; a < body.count; ++a)
    if (native.attached[a]) system_->hold(body.offset + a);
  terms_.push_back(std::make_shared<structure::ShellTerm>(native.shell, body));
}

void Simulation::add_device(const Inputs& in, const Parameters& p) {
  const FrameBody& frame = in.frame;
  const Body struts = system_->add_rotational_body("frame", frame.points, frame.network->lumped_mass(),
                                                   frame.rotation, frame.network->lumped_inertia());
  struts_ = std::make_shared<structure::BeamTerm>(frame.network, struts, frame.fibres);
  terms_.push_back(struts_);
  for (int a = 0; a < struts.count; ++a) {
    system_->state.v[struts.offset + a] = frame.velocity[a];
    system_->state.angular_velocity[struts.rotation_offset + a] = frame.angular_velocity[a];
  }
  for (std::size_t i = 0; i < in.tissue.size(); ++i) {
    const ShellBody& tissue = in.tissue[i];
    const Body body =
        system_->add_body(tissue.name, tissue.points, tissue.shell->lumped_mass(tissue.density));
    std::copy(tissue.velocity.begin(), tissue.velocity.end(), system_->state.v.begin() + body.offset);
    terms_.push_back(std::make_shared<structure::ShellTerm>(tissue.shell, body));
    terms_.push_back(std::make_shared<structure::TieTerm>(
        "ties of " + tissue.name,
        structure::ties_in_reference(tissue.mounted, frame.network->mesh().reference, in.ties[i], body,
                                     struts, p.tie_stiffness),
        *system_));
  }
}

void Simulation::add_contact(const Inputs& in, const Parameters& p, bool device) {
  Points rest = system_->state.x;
  const auto set_rest = [&](const std::string& name, const Points& x) {
    std::copy(x.begin(), x.end(), rest.begin() + system_->body(name).offset);
  };
  if (device) {
    set_rest("frame", in.frame.network->mesh().reference);
    for (const ShellBody& tissue : in.tissue) set_rest(tissue.name, tissue.mounted);
  }
  if (in.native) set_rest(in.native->name, in.native->mounted);
  contact::CollisionMesh mesh(rest);
  law_ = p.law;
  if (device) {
    const Body& struts = system_->body("frame");
    mesh.add_beams({"frame", 0}, struts.offset, in.frame.network->mesh().elements,
                   strut_radius(*in.frame.network));
    for (const ShellBody& tissue : in.tissue) {
      const Body& body = system_->body(tissue.name);
      mesh.add_shell({tissue.name, 0}, body.offset, tissue.shell->mesh().triangles,
                     half_thickness(*tissue.shell, p.thickness_fraction));
    }
  }
  if (in.native)
    mesh.add_shell({in.native->name, 1}, system_->body(in.native->name).offset,
                   in.native->shell->mesh().triangles, half_thickness(*in.native->shell, 1));
  contact::Candidates candidates(std::move(mesh), p.candidates);
  // Struts move apart from each other, and the device's leaflets lie inside frame and skirt.
  if (device) candidates.set_pair("frame", "frame", {false});
  if (device && in.native && has("leaflets")) candidates.set_pair("leaflets", in.native->name, {false});
  if (in.native) candidates.set_pair(in.native->name, in.native->name, {true, p.native_self_distance});
  contact_ = std::make_shared<contact::BodyContact>(std::move(candidates), p.law);
  terms_.push_back(contact_);
}

void Simulation::add_wall(const Inputs& in, const Parameters& p, bool device) {
  std::vector<contact::SurfaceNode> tissue;
  if (in.native) {
    const auto own = shell_surface(*in.native, system_->body(in.native->name), &in.wall);
    tissue.insert(tissue.end(), own.begin(), own.end());
  }
  if (device) {
    if (const ShellBody* skirt = find(in.tissue, "skirt")) {
      const auto own = shell_surface(*skirt, system_->body("skirt"), nullptr);
      tissue.insert(tissue.end(), own.begin(), own.end());
    }
    std::vector<contact::SurfaceNode> struts;
    const std::vector<double> area = strut_area(*in.frame.network);
    const auto& depth = in.frame.network->mesh().depth_mm;
    const double radius = 0.5 * *std::max_element(depth.begin(), depth.end());
    const Body& body = system_->body("frame");
    for (int a = 0; a < body.count; ++a) struts.push_back({body.offset + a, radius, area[a]});
    const contact::SurfaceParameters stiff{p.wall_stiffness, p.friction, p.wall_stiffness};
    frame_wall_ = std::make_shared<contact::WallContact>("wall and frame", in.wall, std::move(struts), stiff);
    terms_.push_back(frame_wall_);
  }
  const contact::SurfaceParameters soft{p.tissue_wall_stiffness, p.friction, p.tissue_wall_stiffness};
  tissue_wall_ = std::make_shared<contact::WallContact>("wall and tissue", in.wall, std::move(tissue), soft);
  terms_.push_back(tissue_wall_);
}

void Simulation::start(const Parameters& p, double damping) {
  structure::IntegratorSettings settings;
  settings.step_s = p.step_s;
  settings.damping_per_s = damping;
  settings.scaling_interval = 1;  // fibres stiffen within a few steps when the device is let go
  step_s_ = p.step_s;
  integrator_ = std::make_unique<structure::Integrator>(*system_, terms_, settings);
}

Simulation Simulation::opening(const Inputs& in, const Placement& placement, const Parameters& p) {
  Simulation s;
  s.add_native(in, in.native->points);
  s.add_contact(in, p, false);
  s.add_wall(in, p, false);
  const Body& body = s.system_->body(in.native->name);
  s.terms_.push_back(std::make_shared<structure::PressureTerm>(
      "opening pressure", in.native->shell->mesh().triangles, body,
      [=](double t) { return p.open_pressure_Pa * smooth(t / p.open_ramp_s); }));
  const double full = placement.radius_mm + 0.3;
  s.dilator_ = std::make_shared<Dilator>(
      shell_surface(*in.native, body, nullptr), placement.to_world * Vec3::Zero(),
      placement.to_world.rotation() * Vec3::UnitZ(), p.tissue_wall_stiffness,
      [=](double t) { return full * smooth((t - 0.3 * p.open_ramp_s) / (0.7 * p.open_ramp_s)); });
  s.terms_.push_back(s.dilator_);
  s.damping_ = [=](double) { return p.open_damping; };
  s.start(p, p.open_damping);
  return s;
}

Simulation Simulation::expansion(const Inputs& in, const Placement& placement, const Parameters& p,
                                 const Points& native_now) {
  Simulation s;
  const Schedule when = schedule(in, placement, p);
  s.system_->state.time_s = when.opened_s;
  s.add_device(in, p);
  if (in.native) s.add_native(in, native_now);
  s.add_contact(in, p, true);
  s.add_wall(in, p, true);
  const auto holding = [=](double t) { return fade(t, when.expanded_s, when.unloaded_s); };
  if (in.native)
    s.terms_.push_back(std::make_shared<structure::PressureTerm>(
        "opening pressure", in.native->shell->mesh().triangles, s.system_->body(in.native->name),
        [=](double t) { return p.open_pressure_Pa * holding(t); }));
  if (p.hold_stiffness > 0) {
    std::vector<int> pushed = inflow_nodes(in.frame), watched = pushed;
    for (int& a : pushed) a += s.system_->body("frame").offset;
    const ShellBody* skirt = find(in.tissue, "skirt");
    if (skirt) watched = skirt_edge_nodes(*skirt);
    for (int& a : watched) a += s.system_->body(skirt ? "skirt" : "frame").offset;
    s.hold_ = std::make_shared<HeightHold>(pushed, watched, -p.depth_mm, p.hold_stiffness, holding);
    s.terms_.push_back(s.hold_);
  }
  if (p.sheath) {
    if (placement.tilt_deg > 0.01)
      throw InputError(
          "deploy.release = \"sheath\": the device has to be tilted by {:.1f} degrees to fit the lumen, "
          "and the sheath runs along z; use deploy.release = \"all_at_once\"",
          placement.tilt_deg);
    const std::vector<double> area = strut_area(*in.frame.network);
    const auto& depth = in.frame.network->mesh().depth_mm;
    const double radius = 0.5 * *std::max_element(depth.begin(), depth.end());
    const Body& body = s.system_->body("frame");
    std::vector<contact::SurfaceNode> struts;
    for (int a = 0; a < body.count; ++a) struts.push_back({body.offset + a, radius, area[a]});
    const double inside = placement.radius_mm + p.sheath_clearance, bottom = placement.low_mm - 2;
    const double top = placement.high_mm + 1000;
    const auto motion = [=](double t) {
      const double drawn = p.sheath_speed * (t - when.opened_s);
      return contact::ToolPosition{inside, bottom + drawn, top + drawn, drawn};
    };
    s.terms_.push_back(std::make_shared<contact::ToolContact>(
        "sheath", motion, 1.0, std::move(struts), contact::SurfaceParameters{p.wall_stiffness, 0, 0}));
  }
  s.damping_ = [=](double t) {
    return p.settle_damping +
           (p.release_damping - p.settle_damping) * fade(t, when.expanded_s, when.unloaded_s);
  };
  s.start(p, p.release_damping);
  return s;
}

void Simulation::step() {
  integrator_->set_damping(damping_(time_s()));
  integrator_->step();
  contact_->limit_velocities(*system_, step_s_);
}

Points Simulation::points(const std::string& body) const {
  const Body& b = system_->body(body);
  return {system_->state.x.begin() + b.begin(), system_->state.x.begin() + b.end()};
}

Points Simulation::velocities(const std::string& body) const {
  const Body& b = system_->body(body);
  return {system_->state.v.begin() + b.begin(), system_->state.v.begin() + b.end()};
}

double Simulation::wall_penetration_mm() const {
  double worst = tissue_wall_->penetration_mm(system_->state);
  if (frame_wall_) worst = std::max(worst, frame_wall_->penetration_mm(system_->state));
  return worst;
}

Points Simulation::native_on_device() const {
  structure::Forces forces;
  forces.reset(system_->nodes(), system_->rotational_nodes());
  contact::Candidates pairs = contact_->candidates();
  const auto& bodies = pairs.mesh().bodies();
  for (const auto& one : bodies)
    for (const auto& other : bodies)
      if (one.group == other.group) pairs.set_pair(one.name, other.name, {false});
  contact::BodyContact between(std::move(pairs), law_);
  between.begin_step(system_->state, step_s_);
  between.add_forces(system_->state, forces);
  return forces.force;
}

}  // namespace valsalva::deploy
