#include "device.hpp"

#include "bodies/frame.hpp"
#include "bodies/shell.hpp"
#include "materials/hgo.hpp"

namespace valsalva::crimp {
namespace {

TissueBody read_tissue(const state::State& stent, const std::string& name, const Parameters& p,
                       int frame_nodes) {
  const auto shell = std::make_shared<structure::Shell>(bodies::read_shell(stent, name),
                                                        std::make_shared<materials::Hgo>(p.tissue_law),
                                                        structure::Bending{p.bending_modulus_Pa, 0.5});
  return {name, shell, stent.mesh(name).points, bodies::read_ties(stent, name, shell->nodes(), frame_nodes)};
}

}  // namespace

Device read_device(const state::State& stent, const Parameters& p) {
  Device device;
  device.frame = std::make_shared<structure::BeamNetwork>(bodies::read_frame(stent), p.frame);
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
