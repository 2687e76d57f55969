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
  std::vector<double>
      gap_mm;  ///< of free nodes to the free triangles of other leaflets, ascending, below `within`
  std::size_t crossings = 0;  ///< free edges through free triangles

  double quantile(double share) const {
    return gap_mm.empty() ? 0 : gap_mm[static_cast<std::size_t>(share * (gap_mm.size() - 1))];
  }
};

struct FreeSurface {
  std::vector<Triangle> triangles;  ///< without those that hang on the wall, where leaflets share a line
  std::vector<int> leaflet;         ///< of each triangle
  contact::CollisionMesh collision;

  explicit FreeSurface(const test::ValveMesh& mesh) : collision(mesh.shell.reference) {
    for (const Triangle& t : mesh.shell.triangles) {
      if (mesh.attached[t[0]] || mesh.attached[t[1]] || mesh.attached[t[2]]) continue;
      triangles.push_back(t);
      leaflet.push_back(mesh.leaflet[t[0]]);
    }
    const std::vector<double> thin(mesh.shell.reference.size(), 0.17);
    collision.add_shell({"leaflets", 0}, 0, triangles, thin);
  }
};

Apart apart(const test::ValveMesh& mesh, const FreeSurface& surface, const Points& x, double within) {
  Apart found;
  found.crossings = contact::crossings(surface.collision, x).size();
  for (std::size_t a = 0; a < x.size(); ++a) {
    if (mesh.attached[a]) continue;
    double nearest = within;
    for (std::size_t n = 0; n < surface.triangles.size(); ++n) {
      const Triangle& t = surface.triangles[n];
      if (surface.leaflet[n] == mesh.leaflet[a] || (x[t[0]] - x[a]).norm() > 3 * within) continue;
      nearest = std::min(nearest, contact::point_triangle(x[a], x[t[0]], x[t[1]], x[t[2]]).distance);
    }
    if (nearest < within) found.gap_mm.push_back(nearest);
  }
  std::sort(found.gap_mm.begin(), found.gap_mm.end());
  return found;
}

}  // namespace

int study_separation(double h, double end_s) {
  std::printf(
      "repulsion_kPa standoff_h near_nodes least_mm lowest_5_percent_mm median_mm crossings leak_mL_per_s "
      "steps seconds\n");
  for (const double standoff : {0.0, 1.3}) {
    for (const double pressure_kPa : {0.0, 200.0}) {
      test::ValveRig rig(h, {{1e3 * pressure_kPa, 0.6 * h}, standoff * h});
      const FreeSurface surface(rig.mesh);
      const auto begin = std::chrono::steady_clock::now();
      const double still_s = 0.6 * end_s;
      rig.run_to(still_s, [](const coupling::ImmersedStep&) {});
      const std::size_t at_rest = apart(rig.mesh, surface, rig.mesh.shell.reference, h).crossings;
      double volume = 0, look_s = still_s, least_mm = h;
      std::size_t crossings = 0;
      Apart now;
      rig.run_to(end_s, [&](const coupling::ImmersedStep& step) {
        volume -= rig.flow->flow_through(fluid::End::high) * step.dt_s;
        if (rig.time_s < look_s) return;
        look_s += (end_s - still_s) / 20;
        now = apart(rig.mesh, surface, rig.system->shell()->x(), h);
        least_mm = std::min(least_mm, now.quantile(0));
        crossings = std::max(crossings, now.crossings - std::min(at_rest, now.crossings));
      });
      std::printf("%g %g %zu %.4f %.4f %.4f %zu %.3f %ld %.1f\n", pressure_kPa, standoff, now.gap_mm.size(),
                  least_mm, now.quantile(0.05), now.quantile(0.5), crossings,
                  volume / 1e3 / (end_s - still_s), rig.system->steps(),
                  std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace valsalva
