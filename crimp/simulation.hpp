// Crimping as explicit dynamics: the device, the crimper that closes about it, contact of everything with
// everything, then rest in the closed crimper.
#pragma once

#include <optional>

#include "contact/body_contact.hpp"
#include "contact/tool_contact.hpp"
#include "crimper.hpp"
#include "device.hpp"
#include "structure/integrator.hpp"

namespace valsalva::crimp {

/// Contact radii. Struts: half the smaller side against tissue and struts, half the depth against the crimper
/// (a strut's outer face). Tissue: half of fraction times thickness.
contact::CollisionMesh collision_mesh(const Device& device, const structure::System& system, double fraction);
/// What meets the crimper: the outer faces of the struts, and tissue.
std::vector<contact::SurfaceNode> frame_surface(const Device& device, const structure::System& system);
std::vector<contact::SurfaceNode> tissue_surface(const Device& device, const structure::System& system,
                                                 double fraction);

class Simulation {
 public:
  Simulation(Device device, const Parameters& p);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  void step();
  bool closed() const { return system_.state.time_s >= crimper_.duration_s(); }
  /// Closed, and at rest or out of time.
  bool done() const;
  bool settled() const;
  /// Longest possible duration, for the progress display.
  double longest_s() const { return crimper_.duration_s() + p_.settle_s; }

  const Device& device() const { return device_; }
  const structure::System& system() const { return system_; }
  const structure::Integrator& integrator() const { return *integrator_; }
  const structure::BeamTerm& struts() const { return *struts_; }
  const contact::BodyContact& body_contact() const { return *bodies_; }
  const Crimper& crimper() const { return crimper_; }
  double crimper_radius_mm() const { return crimper_.radius_mm(system_.state.time_s); }
  /// Sum of the crimper's normal forces on the device.
  double radial_force_uN() const;
  double crimper_overlap_mm() const;
  double crimper_work_nJ() const { return work_; }
  /// How often the step guard slowed a node.
  long slowed() const { return slowed_; }

  structure::Snapshot save() const;
  void restore(const structure::Snapshot& snapshot);

 private:
  Device device_;
  Parameters p_;
  structure::System system_;
  Crimper crimper_;
  std::shared_ptr<const structure::BeamTerm> struts_;
  std::shared_ptr<contact::BodyContact> bodies_;
  std::vector<std::shared_ptr<contact::ToolContact>> tools_;
  std::optional<structure::Integrator> integrator_;
  double work_ = 0;
  long slowed_ = 0;
};

}  // namespace valsalva::crimp
