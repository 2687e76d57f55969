// The bodies of a deployment as one mechanical system, in two acts.
//
//   opening    the native leaflets alone: pressure from below, then the nose of the delivery system
//   expansion  the crimped device and the opened native leaflets: release, expansion, settling
//
// Both are explicit dynamics (structure/integrator.hpp) with contact between bodies, with the wall's level
// set and with the sheath (contact/). Attached edges of native leaflets are held: the wall is rigid.
#pragma once

#include <memory>

#include "contact/body_contact.hpp"
#include "contact/tool_contact.hpp"
#include "contact/wall_contact.hpp"
#include "inputs.hpp"
#include "loads.hpp"
#include "placement.hpp"
#include "structure/beam.hpp"
#include "structure/integrator.hpp"
#include "structure/shell_term.hpp"
#include "structure/tie.hpp"

namespace valsalva::deploy {

/// When what happens, in simulated time since the start of the first act.
struct Schedule {
  double opened_s = 0;    ///< end of the first act; 0 without native leaflets
  double clear_s = 0;     ///< nothing is in the sheath any more; the start of the second act without sheath
  double expanded_s = 0;  ///< pressure, hold and release damping begin to go
  double unloaded_s = 0;  ///< they are gone
  double end_s = 0;
};

Schedule schedule(const Inputs& in, const Placement& placement, const Parameters& p);

class Simulation {
 public:
  static Simulation opening(const Inputs& in, const Placement& placement, const Parameters& p);
  /// native_now: the native leaflets' positions at the end of the first act.
  static Simulation expansion(const Inputs& in, const Placement& placement, const Parameters& p,
                              const Points& native_now);

  void step();
  double time_s() const { return system_->state.time_s; }
  const structure::System& system() const { return *system_; }
  structure::Integrator& integrator() { return *integrator_; }
  const structure::Integrator& integrator() const { return *integrator_; }
  bool has(const std::string& body) const { return system_->has_body(body); }
  Points points(const std::string& body) const;
  Points velocities(const std::string& body) const;

  /// Null while the device is not there.
  const structure::BeamTerm* struts() const { return struts_.get(); }
  const contact::BodyContact& contact() const { return *contact_; }
  /// Overlap with the wall, the largest of all bodies, beyond the contact radius.
  double wall_penetration_mm() const;
  const contact::WallContact* frame_wall() const { return frame_wall_.get(); }
  const contact::WallContact* tissue_wall() const { return tissue_wall_.get(); }
  double dilator_penetration_mm() const { return dilator_ ? dilator_->penetration_mm(system_->state) : 0; }
  double hold_force_uN() const { return hold_ ? hold_->force_uN(system_->state) : 0; }
  /// Contact forces of the native leaflets on the other bodies, per node of the system.
  Points native_on_device() const;

 private:
  Simulation() = default;
  void add_native(const Inputs& in, const Points& x);
  void add_device(const Inputs& in, const Parameters& p);
  void add_contact(const Inputs& in, const Parameters& p, bool device);
  void add_wall(const Inputs& in, const Parameters& p, bool device);
  void start(const Parameters& p, double damping);

  std::unique_ptr<structure::System> system_ = std::make_unique<structure::System>();
  std::vector<std::shared_ptr<structure::ForceTerm>> terms_;
  std::shared_ptr<structure::BeamTerm> struts_;
  std::shared_ptr<contact::BodyContact> contact_;
  std::shared_ptr<contact::WallContact> frame_wall_, tissue_wall_;
  std::shared_ptr<Dilator> dilator_;
  std::shared_ptr<HeightHold> hold_;
  std::unique_ptr<structure::Integrator> integrator_;
  std::function<double(double)> damping_;
  double step_s_ = 0;
  contact::Law law_ = contact::Law::barrier;
};

}  // namespace valsalva::deploy
