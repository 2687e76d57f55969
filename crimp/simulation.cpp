#include "simulation.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/errors.hpp"
#include "tissue_damping.hpp"

namespace valsalva::crimp {
namespace {

constexpr double far_mm = 1e4;  // the crimper is longer than any device

double outer_radius_of_frame(const structure::BeamNetwork& frame) {
  double outer = 0;
  const auto& mesh = frame.mesh();
  for (std::size_t e = 0; e < mesh.elements.size(); ++e)
    for (int node : mesh.elements[e])
      outer = std::max(outer,
                       std::hypot(mesh.reference[node][0], mesh.reference[node][1]) + 0.5 * mesh.depth_mm[e]);
  return outer;
}

std::vector<double> tissue_radii(const structure::Shell& shell, double fraction) {
  std::vector<double> radii = shell.mesh().thickness_mm;
  for (double& r : radii) r *= 0.5 * fraction;
  return radii;
}

// Sewn nodes stay. The engine's sequence is fixed by the standard, and so is the way from it to [-1, 1].
void displace(const Device& device, double length_mm, structure::System& system) {
  std::mt19937 random(20220901);
  const auto next = [&] { return 2.0 * static_cast<double>(random()) / 4294967295.0 - 1.0; };
  for (const auto& body : device.tissue) {
    std::vector<bool> sewn(body.mounted.size(), false);
    for (const auto& tie : body.ties) sewn[tie[0]] = true;
    const int offset = system.body(body.name).offset;
    for (std::size_t i = 0; i < sewn.size(); ++i) {
      const Vec3 shift(next(), next(), next());
      if (!sewn[i]) system.state.x[offset + i] += length_mm / std::sqrt(3.0) * shift;
    }
  }
}

}  // namespace

contact::CollisionMesh collision_mesh(const Device& device, const structure::System& system,
                                      double fraction) {
  Points reference(system.nodes());
  const auto place = [&](const std::string& body, const Points& points) {
    std::copy(points.begin(), points.end(), reference.begin() + system.body(body).offset);
  };
  place("frame", device.frame->mesh().reference);
  for (const auto& body : device.tissue) place(body.name, body.mounted);
  contact::CollisionMesh mesh(std::move(reference));
  const auto& beams = device.frame->mesh();
  std::vector<double> strut;
  for (std::size_t e = 0; e < beams.elements.size(); ++e)
    strut.push_back(0.5 * std::min(beams.width_mm[e], beams.depth_mm[e]));
  mesh.add_beams({"frame", 0}, system.body("frame").offset, beams.elements, strut);
  for (const auto& body : device.tissue)
    mesh.add_shell({body.name, 0}, system.body(body.name).offset, body.shell->mesh().triangles,
                   tissue_radii(*body.shell, fraction));
  return mesh;
}

std::vector<contact::SurfaceNode> frame_surface(const Device& device, const structure::System& system) {
  std::vector<contact::SurfaceNode> nodes;
  const auto& beams = device.frame->mesh();
  const int offset = system.body("frame").offset;
  for (int a = 0; a < device.frame->nodes(); ++a) nodes.push_back({offset + a, 0, 0});
  for (std::size_t e = 0; e < beams.elements.size(); ++e) {
    const auto& [a, b] = beams.elements[e];
    const double area = 0.5 * beams.width_mm[e] * (beams.reference[b] - beams.reference[a]).norm();
    for (int n : {a, b}) {
      nodes[n].radius_mm = std::max(nodes[n].radius_mm, 0.5 * beams.depth_mm[e]);
      nodes[n].area_mm2 += area;
    }
  }
  return nodes;
}

std::vector<contact::SurfaceNode> tissue_surface(const Device& device, const structure::System& system,
                                                 double fraction) {
  std::vector<contact::SurfaceNode> nodes;
  for (const auto& body : device.tissue) {
    const auto radii = tissue_radii(*body.shell, fraction), areas = body.shell->lumped_area();
    for (int a = 0; a < body.shell->nodes(); ++a)
      nodes.push_back({system.body(body.name).offset + a, radii[a], areas[a]});
  }
  return nodes;
}

Simulation::Simulation(Device device, const Parameters& p)
    : device_(std::move(device)),
      p_(p),
      system_(make_system(device_, p)),
      crimper_(outer_radius_of_frame(*device_.frame), 0.5 * p.target_diameter_mm, p.speed_mm_per_s,
               p.ramp_s) {
  if (outer_radius_of_frame(*device_.frame) < 0.5 * p.target_diameter_mm)
    throw InputError(
        "crimp.diameter_mm = {}: the frame's outer diameter is only {:.3f} mm; there is nothing to crimp",
        p.target_diameter_mm, 2 * outer_radius_of_frame(*device_.frame));
  displace(device_, p.asymmetry_mm, system_);
  auto terms = elastic_terms(device_, p, system_);
  struts_ = std::static_pointer_cast<const structure::BeamTerm>(terms.front());
  bodies_ = std::make_shared<contact::BodyContact>(
      contact::Candidates(collision_mesh(device_, system_, p.thickness_fraction), p.candidates), p.law);
  const contact::BodyPairSettings with_struts{true, 0, p.strut_modulus_Pa};
  for (const auto& body : system_.bodies()) bodies_->candidates().set_pair("frame", body.name, with_struts);
  const auto motion = [this](double t) {
    return contact::ToolPosition{crimper_.radius_mm(t), -far_mm, far_mm, 0};
  };
  constexpr double rim_mm = 1;  // far away, never met
  const auto tool = [&](const std::string& name, std::vector<contact::SurfaceNode> nodes, double stiffness) {
    tools_.push_back(std::make_shared<contact::ToolContact>(
        name, motion, rim_mm, std::move(nodes),
        contact::SurfaceParameters{stiffness, p.crimper_friction, stiffness}));
  };
  terms.push_back(bodies_);
  tool("crimper on frame", frame_surface(device_, system_), p.crimper_frame_Pa_per_mm);
  tool("crimper on tissue", tissue_surface(device_, system_, p.thickness_fraction),
       p.crimper_tissue_Pa_per_mm);
  terms.insert(terms.end(), tools_.begin(), tools_.end());
  for (const auto& body : device_.tissue)
    if (p.tissue_damping_per_s > 0)
      terms.push_back(std::make_shared<TissueDamping>(
          "damping of " + body.name, body.shell->mesh().triangles, body.shell->lumped_mass(p.tissue_density),
          system_.body(body.name).offset, p.tissue_damping_per_s));
  structure::IntegratorSettings settings;
  settings.step_s = p.step_s;
  settings.scaling_interval = p.scaling_interval;
  settings.damping_per_s = p.damping_per_s;
  integrator_.emplace(system_, std::move(terms), settings);
}

void Simulation::step() {
  const double radius = crimper_radius_mm(), force = radial_force_uN();
  integrator_->set_damping(closed() ? p_.settle_damping_per_s : p_.damping_per_s);
  integrator_->step();
  slowed_ += bodies_->limit_velocities(system_, p_.step_s);
  work_ += force * (radius - crimper_radius_mm());
}

double Simulation::radial_force_uN() const {
  double sum = 0;
  for (const auto& tool : tools_) sum += tool->radial_force_uN(system_.state);
  return sum;
}

double Simulation::crimper_overlap_mm() const {
  double most = 0;
  for (const auto& tool : tools_) most = std::max(most, tool->penetration_mm(system_.state));
  return most;
}

bool Simulation::settled() const {
  return closed() && integrator_->energies().ratio() < p_.settled_ratio;
}

bool Simulation::done() const {
  return settled() || system_.state.time_s >= longest_s();
}

structure::Snapshot Simulation::save() const {
  structure::Snapshot all = integrator_->save();
  all["crimping"] = {work_, static_cast<double>(slowed_)};
  return all;
}

void Simulation::restore(const structure::Snapshot& snapshot) {
  const auto own = snapshot.find("crimping");
  if (own == snapshot.end() || own->second.size() != 2)
    throw InputError("the state to resume from has no entry 'crimping'; start the stage anew");
  work_ = own->second[0];
  slowed_ = static_cast<long>(own->second[1]);
  integrator_->restore(snapshot);
}

}  // namespace valsalva::crimp
