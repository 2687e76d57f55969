// Deformable bodies in a scene of fluid: [[body]] and the tables that go with it, as in a scene without fluid
// (assembly/scene.hpp), coupled to the flow as [coupling] says (coupling/immersed_structure.hpp).
//
// Force and moment (about c) of the fluid on a body, from what else acts on it,
//   F = d/dt sum m (1-H) v  -  sum (1-H) f          m: all of its mass, f: forces of all terms on its nodes,
//   M = d/dt sum (x-c) x m (1-H) v  -  sum (x-c) x (1-H) f             H: projectors on held directions
// (its elasticity cancels in the sums; on held nodes the support answers). d/dt: over the last step.
//
// Where the fluid has a body force, it is taken off the nodes by the volume that they displace: the body
// force acts on fluid only, and a body's weight is a load of its own.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "assembly/probes.hpp"
#include "assembly/scene.hpp"
#include "coupling/immersed_flow.hpp"
#include "flow_scene/expression.hpp"
#include "flow_scene/frame.hpp"
#include "flow_scene/obstacles.hpp"
#include "flow_scene/turned_body.hpp"

namespace valsalva::flow_scene {

class Bodies {
 public:
  /// Null for a case without [[body]]. InputError that names file, entry and key.
  static std::unique_ptr<Bodies> of(const Case& scene, const Obstacles& obstacles);

  /// Puts the bodies into the flow, which stands at its start with its obstacles. cfl: limit of the steps;
  /// flow_step_s: what the flow allows or the case wants to see, which ties to excess mass need not exceed;
  /// smallest_s: a step below it is an alarm; beyond: up to which sides they may reach. The flow must outlive
  /// the steps.
  void immerse(const Case& scene, fluid::Flow& flow, const Frame& frame, double cfl, double flow_step_s,
               double smallest_s, const coupling::Surroundings& beyond);

  const assembly::Scene& scene() const { return scene_; }
  bool has(const std::string& name) const;
  /// Where nodes that couple are at the start.
  Points places() const;
  coupling::ImmersedFlow& system() { return *system_; }
  const coupling::ImmersedStructure& structure() const { return body_->structure(); }

  /// One step from start_s; hooks.set_ends need not move supports.
  coupling::ImmersedStep step(double start_s, double at_most, coupling::StepHooks hooks);

  const std::vector<std::string>& columns() const { return probes_->columns(); }
  std::vector<double> values() const { return probes_->values(scene_, assembly::kinetic_of(scene_)); }
  /// Of the fluid on a body, about a point: micronewton, micronewton mm.
  Obstacles::Load load_on(const std::string& name, const Vec3& about) const;
  /// Of what they have beyond the fluid's density, g mm/s.
  Vec3 excess_momentum() const { return structure().excess_momentum(); }
  /// Figures for the summary.
  std::map<std::string, double> metrics() const;

  /// Beside the system's.
  std::vector<double> save() const;
  void restore(const std::vector<double>& saved);

 private:
  struct Motion {
    Vec3 momentum = Vec3::Zero(), angular = Vec3::Zero();  // angular: about the origin
  };
  explicit Bodies(const Case& scene);
  Motion motion_of(const assembly::BuiltBody& body) const;
  std::vector<Motion> motions() const;
  void displace(const Case& scene);
  void check_places(const fluid::Flow& flow, const Frame& frame, const coupling::Surroundings& beyond);
  double auto_tie_rate(double flow_step_s) const;

  std::string file_;
  assembly::Scene scene_;
  std::shared_ptr<structure::ForceTerm> displaced_;  // null: the fluid has no body force
  std::unique_ptr<assembly::Drive> drive_;
  std::unique_ptr<assembly::Probes> probes_;
  std::unique_ptr<coupling::ImmersedFlow> system_;
  TurnedBody* body_ = nullptr;
  std::vector<std::uint8_t> couples_;
  Vec3 low_ = Vec3::Zero(), high_ = Vec3::Zero();  // room of the nodes that couple
  std::vector<Motion> rate_;                       // of each body, over the last step
  double density_ratio_ = 1, largest_slip_ = 0, tie_rate_ = 0, critical_s_ = 0;
  std::size_t points_ = 0;
  long repeats_ = 0, slowed_ = 0;
};

}  // namespace valsalva::flow_scene
