// The bar of Turek and Hron's benchmark in fluid at rest under an even load of 1 Pa across, let go at t = 0.
// It swings about the deflection q L^4 / (8 D) of the beam, D = 4 G t^3/12 (plane strain, incompressible).
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "structure/dead_load.hpp"
#include "studies.hpp"
#include "turek_hron.hpp"

namespace valsalva {

int study_bar(int cells_across, const std::string& kernel, double end_s) {
  constexpr double thickness = 20, length = 350, load_Pa = 1, density = 1e-3;
  const double h = 410.0 / cells_across;
  turek::Bar shape;
  shape.slab_mm = 3 * h;
  shape.shear_Pa = 0.416667e6;
  fluid::Boundaries boundaries;
  boundaries.side = {{{fluid::Side::slip, fluid::Side::slip},
                      {fluid::Side::periodic, fluid::Side::periodic},
                      {fluid::Side::slip, fluid::Side::slip}}};
  fluid::FlowParameters parameters;
  parameters.density = density;
  parameters.viscosity = 1;
  fluid::Flow flow(MPI_COMM_SELF,
                   fluid::Grid{{cells_across, 3, static_cast<int>(std::ceil(800 / h))}, Vec3::Zero(), h},
                   boundaries, parameters);
  flow.solids().set_lumen([](const Vec3& x) { return 50 - std::hypot(x.x() - 200, x.z() - 200); });
  turek::BuiltBar bar = turek::build(shape);
  const Vec3 acceleration(load_Pa / (density * thickness), 0, 0);
  bar.terms.push_back(std::make_shared<structure::DeadLoadTerm>(
      "load", structure::weight_of(*bar.system, bar.body, acceleration), Points{},
      [](double) { return 1.0; }));
  const Vec3 start = bar.system->state.x[bar.tip];
  coupling::ImmersedStructureSettings settings;
  settings.cells = coupling::cells_of(bar.solid->mesh());
  settings.sampling_mm = 0.6 * h;
  coupling::ImmersedFlowSettings coupled;
  coupled.kernel = coupling::kernel_from(kernel);
  coupled.limits.largest_s = 5e-3;
  coupling::ImmersedFlow run(flow,
                             std::make_unique<coupling::ImmersedStructure>(
                                 std::move(bar.system), bar.terms, bar.solid->mesh().reference, settings),
                             coupled);
  const double bending = 4 * shape.shear_Pa * std::pow(thickness, 3) / 12;
  const double rest = load_Pa * std::pow(length, 4) / (8 * bending);
  double largest = 0, next = 0;
  for (double t = 0; t < end_s;) {
    t += run.step(1).dt_s;
    const Vec3 moved = run.body()->x()[bar.tip] - start;
    largest = std::max(largest, moved.x());
    if (t < next) continue;
    next += 0.1;
    std::printf("t %.2f s: tip %.4f mm across, %.4f along; largest %.4f (beam at rest %.4f)\n", t, moved.x(),
                moved.z(), largest, rest);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace valsalva
