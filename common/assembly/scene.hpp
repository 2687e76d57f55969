// A scene without fluid, composed from a case file: bodies, supports, loads, ties, contact, probes.
// docs/case-file.md lists the tables.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assembly/body.hpp"
#include "assembly/rigid_surface.hpp"
#include "assembly/supports.hpp"
#include "assembly/volume_load.hpp"
#include "contact/body_contact.hpp"
#include "core/case.hpp"

namespace valsalva::assembly {

class Entry;

/// What loads and motions do over the run: what the case says, or grow from nothing to what they are at time
/// 0.
enum class Course { whole, to_start };

struct Scene {
  std::unique_ptr<structure::System> system;  ///< at its start: the reference shapes
  std::vector<BuiltBody> bodies;
  std::map<std::string, std::vector<int>> nodes;  ///< sets, as nodes of the system
  std::vector<Support> supports;
  std::vector<std::shared_ptr<structure::ForceTerm>> terms;
  std::vector<std::shared_ptr<structure::ForceTerm>> loads;          ///< those of the terms that are loads
  std::vector<std::shared_ptr<contact::BodyContact>> body_contacts;  ///< those that need the step guard
  std::map<std::string, std::shared_ptr<structure::ForceTerm>>
      named;                                      ///< bodies, ties, tethers, contact pairs
  std::map<std::string, std::string> first_body;  ///< of a contact pair
  std::map<std::string, std::shared_ptr<RigidSurfaceContact>> surfaces;  ///< contact with rigid surfaces
  std::map<std::string, std::shared_ptr<VolumeLoad>> volumes;
  std::vector<std::shared_ptr<structure::RigidBody>> rigid;           ///< that move freely
  double contact_reach_mm = std::numeric_limits<double>::infinity();  ///< least contact distance of bodies
  double end_s = 1;
  Course course = Course::whole;

  /// The factor of a load or motion over time: the entry's table, `standard` where it has none.
  TimeTable factor_of(const Entry& entry, const TimeTable& standard) const;

  /// InputError with `what` when the name is taken.
  void add_term(const std::string& name, std::shared_ptr<structure::ForceTerm> term, const std::string& what);
  const BuiltBody& body_of(int node) const;

  const BuiltBody& body(const std::string& name, const std::string& what) const;
  const std::vector<int>& set(const std::string& name, const std::string& what) const;
};

/// Stress-free shapes of bodies, by name, where they are not those of their meshes.
using References = std::map<std::string, Points>;

/// InputError that names the file, the entry, the key, what was found and what is expected. end_s: end of the
/// run in a scene with fluid; otherwise [dynamics] says so.
Scene compose(const Case& scene, const References& references = {}, std::optional<double> end_s = {},
              Course course = Course::whole);

/// Of nodes that are not held, rotations and free rigid bodies, nJ.
double kinetic_of(const Scene& scene);

}  // namespace valsalva::assembly
