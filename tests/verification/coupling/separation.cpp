// What keeps the leaflets of a closed valve apart: the kernel alone, the contact repulsion, the standoff, or
// both. A valve in a tube closes and holds; then the distance of nodes to the surfaces of other leaflets,
// what crosses, the leak and the step.
#include <chrono>
#include <cstdio>

#include "contact/collision_mesh.hpp"
#include "contact/distance.hpp"
#include "contact/intersections.hpp"
#include "studies.hpp"
#include "valve_rig.hpp"

namespace valsalva {

namespace {

struct Apart {
  double nearest_mm = 1e300;
  std::size_t crossings = 0;
};

Apart apart(const test::ValveMesh& mesh, const contact::CollisionMesh& collision, const Points& x) {
  Apart found;
  found.crossings = contact::crossings(collision, x).size();
  for (std::size_t a = 0; a < x.size(); ++a) {
    if (mesh.attached[a]) continue;
    for (const Triangle& t : mesh.shell.triangles) {
      if (mesh.leaflet[t[0]] == mesh.leaflet[a]) continue;
      if (mesh.attached[t[0]] || mesh.attached[t[1]] || mesh.attached[t[2]]) continue;
      found.nearest_mm =
          std::min(found.nearest_mm, contact::point_triangle(x[a], x[t[0]], x[t[1]], x[t[2]]).distance);
    }
  }
  return found;
}

}  // namespace

int study_separation(double h, double end_s) {
  std::printf("repulsion_kPa standoff_h nearest_mm crossings leak_mL_per_s steps seconds\n");
  for (const double standoff : {0.0, 1.3}) {
    for (const double pressure_kPa : {0.0, 200.0}) {
      test::ValveRig rig(h, {{1e3 * pressure_kPa, 0.6 * h}, standoff * h});
      contact::CollisionMesh collision(rig.mesh.shell.reference);
      const std::vector<double> thin(rig.mesh.shell.reference.size(), 0.17);
      collision.add_shell({"leaflets", 0}, 0, rig.mesh.shell.triangles, thin);
      const auto begin = std::chrono::steady_clock::now();
      const double still_s = 0.6 * end_s;
      rig.run_to(still_s, [](const coupling::ImmersedStep&) {});
      Apart worst;
      double volume = 0, look_s = still_s;
      rig.run_to(end_s, [&](const coupling::ImmersedStep& step) {
        volume += rig.flow->flow_through(fluid::End::high) * step.dt_s;
        if (rig.time_s < look_s) return;
        look_s += (end_s - still_s) / 20;
        const Apart now = apart(rig.mesh, collision, rig.system->shell()->x());
        worst.nearest_mm = std::min(worst.nearest_mm, now.nearest_mm);
        worst.crossings = std::max(worst.crossings, now.crossings);
      });
      std::printf("%g %g %.4f %zu %.3f %ld %.1f\n", pressure_kPa, standoff, worst.nearest_mm, worst.crossings,
                  volume / 1e3 / (end_s - still_s), rig.system->steps(),
                  std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace valsalva
