#include "assembly/prestress.hpp"

#include <algorithm>

#include "assembly/march.hpp"
#include "core/errors.hpp"

namespace valsalva::assembly {

bool wants_prestress(const Case& scene) {
  if (scene.text("dynamics.prestress") == "none") return false;
  for (const Case& body : scene.entries("body"))
    if (body.text("body.kind") == "rigid" && body.text("body.motion") == "free" &&
        scene.text("dynamics.solver") != "quasi_static")
      throw InputError(
          "{}: dynamics.prestress = \"{}\" with the free rigid body '{}': the loaded shape is looked for by "
          "Newton's method, which does not move it; expected solver = \"quasi_static\", or motion = "
          "\"fixed\"",
          scene.file().string(), scene.text("dynamics.prestress"), body.text("body.name"));
  return true;
}

bool loaded_at_the_end(const Case& scene) {
  const std::string& solver = scene.text("dynamics.solver");
  return solver == "static" || solver == "quasi_static";
}

double distance_from_given(const Scene& scene) {
  double most = 0;
  for (const BuiltBody& body : scene.bodies) {
    if (body.kind == Kind::rigid) continue;
    const Points x = body.places(scene.system->state);
    for (std::size_t a = 0; a < x.size(); ++a) most = std::max(most, (x[a] - body.imaged[a]).norm());
  }
  return most;
}

Prestress find_stress_free(const Case& scene, const std::function<void(int, double)>& say) {
  constexpr double smallest_relaxation = 1e-3;
  const double tolerance = scene.real("dynamics.prestress_tolerance_mm");
  const int most = static_cast<int>(scene.integer("dynamics.prestress_iterations"));
  const bool at_end = loaded_at_the_end(scene);
  Prestress best;
  References trial, miss;  // the shape in hand, and by how far its loaded shape misses the given one
  double relaxation = 1;
  for (int k = 1; k <= most; ++k) {
    double error = std::numeric_limits<double>::infinity();
    std::string failure;
    References found;
    structure::Snapshot equilibrium;
    double stored = 0;
    try {
      Scene built = compose(scene, trial, {}, at_end ? Course::whole : Course::to_start);
      const auto march = at_end ? make_march(scene, built) : make_search(scene, built);
      while (!march->finished()) march->step();
      error = distance_from_given(built);
      for (const BuiltBody& body : built.bodies) {
        if (body.kind == Kind::rigid) continue;
        Points& off = found[body.name] = body.places(built.system->state);
        for (std::size_t a = 0; a < off.size(); ++a) off[a] -= body.imaged[a];
        trial[body.name] = body.mesh.points;
      }
      if (!at_end) {
        equilibrium = march->save();
        stored = march->stored_nJ();
      }
    } catch (const Error& e) {
      if (k == 1) throw;
      failure = e.what();
    }
    say(k, error);
    best.iterations = k;
    if (k == 1 || error < best.error_mm) {
      best.error_mm = error;
      best.reference = trial;
      best.equilibrium = std::move(equilibrium);
      best.stored_nJ = stored;
      miss = std::move(found);
      if (error <= tolerance) return best;
      relaxation = std::min(1.0, 1.5 * relaxation);
    } else {
      relaxation /= 2;
      if (relaxation < smallest_relaxation)
        throw NumericalFailure(
            "prestress: the backward displacement does not come nearer than {:.3g} mm to the given shape "
            "(limit "
            "{:.3g} mm) after {} equilibria{}{}; lower the load, or raise dynamics.prestress_tolerance_mm",
            best.error_mm, tolerance, k, failure.empty() ? "" : ": ", failure);
    }
    trial = best.reference;
    for (auto& [name, points] : trial)
      for (std::size_t a = 0; a < points.size(); ++a) points[a] -= relaxation * miss.at(name)[a];
  }
  throw NumericalFailure(
      "prestress: {:.3g} mm from the given shape after {} equilibria (limit {:.3g} mm); raise "
      "dynamics.prestress_iterations or the tolerance",
      best.error_mm, most, tolerance);
}

}  // namespace valsalva::assembly
