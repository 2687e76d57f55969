#include "assembly/march.hpp"

#include <cmath>
#include <limits>

#include "assembly/march_solvers.hpp"
#include "core/errors.hpp"
#include "structure/integrator.hpp"

namespace valsalva::assembly {

using structure::Snapshot;

Snapshot save_system(const Scene& scene) {
  structure::Integrator carrier(*scene.system, scene.terms, {});
  return carrier.save();
}

void restore_system(Scene& scene, const Snapshot& snapshot) {
  structure::Integrator carrier(*scene.system, scene.terms, {});
  carrier.restore(snapshot);
}

void March::start_from(const Snapshot& equilibrium, double stored_nJ) {
  VALSALVA_ASSERT(steps_ == 0);
  structure::Configuration& now = scene_.system->state;
  const Points v = now.v, spin = now.angular_velocity;
  restore_system(scene_, equilibrium);
  now.v = v;
  now.angular_velocity = spin;
  now.time_s = 0;
  stored_at_start_ = stored_nJ;
}

Snapshot March::save() const {
  Snapshot s = save_solver();
  s["march"] = {static_cast<double>(steps_)};
  return s;
}

void March::restore(const Snapshot& snapshot) {
  const auto own = snapshot.find("march");
  if (own == snapshot.end() || own->second.size() != 1)
    throw InputError("the state holds no scene without fluid: it was written with another case");
  restore_solver(snapshot);
  steps_ = static_cast<long>(own->second[0]);
}

std::unique_ptr<March> make_march(const Case& scene, Scene& built) {
  const Settings s(scene);
  const bool newton = s.solver == "static" || s.solver == "implicit";
  if (newton && !built.rigid.empty())
    throw InputError(
        "{}: dynamics.solver = \"{}\" with the free rigid body '{}', whose six degrees of freedom are not "
        "among "
        "its unknowns; expected \"explicit\" or \"quasi_static\", or a stiff solid in its place",
        scene.file().string(), s.solver, built.rigid.front()->name());
  if (s.solver == "explicit") return explicit_march(s, built);
  if (s.solver == "quasi_static") return relaxation_march(s, built);
  if (s.solver == "static") return static_march(s, built);
  return implicit_march(s, built);
}

std::unique_ptr<March> make_search(const Case& scene, Scene& built) {
  return static_march(Settings(scene), built);
}

double stable_step_s(const Scene& scene) {
  structure::StiffnessBound bound;
  bound.reset(scene.system->nodes(), scene.system->rotational_nodes());
  for (const auto& term : scene.terms) term->add_stiffness_bound(scene.system->state, bound);
  double largest = 0;
  for (std::size_t a = 0; a < bound.translation.size(); ++a)
    if (!scene.system->held(static_cast<int>(a)))
      largest = std::max(largest, bound.translation[a] / scene.system->mass(static_cast<int>(a)));
  for (std::size_t r = 0; r < bound.rotation.size(); ++r)
    if (!scene.system->held(scene.system->node_of_rotation(static_cast<int>(r))))
      largest = std::max(largest, bound.rotation[r] / scene.system->inertia(static_cast<int>(r)));
  for (const auto& body : scene.rigid) largest = std::max(largest, body->largest_ratio(bound));
  return largest > 0 ? 2 / std::sqrt(largest) : std::numeric_limits<double>::infinity();
}

}  // namespace valsalva::assembly
