// Time of one coupled step (fluid, leaflets with nodes half a cell apart, coupling, stability limit), on the
// ranks it is started with: a valve of 25 mm in a tube, box 32 x 32 x 60 mm (numbers of cells with small factors, as the
// stage takes them).
//
//   bench_cycle_ranks      one JSON object a line: {name, value, unit, reference, ratio, ranks}
//
// The reference is what the scheme's prototype took on two threads (ms a step: 6.6, 12.3, 29.4 at 1, 0.75 and
// 0.5 mm), whose leaflets had a quarter fewer nodes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "core/units.hpp"
#include "coupling/immersed_flow.hpp"
#include "synthetic_valve.hpp"

using namespace valsalva;

namespace {

struct Level {
  const char* name;
  double h, reference_ms;
};

double milliseconds_per_step(double h, int steps) {
  const fluid::Grid grid{{static_cast<int>(32 / h), static_cast<int>(32 / h), static_cast<int>(60 / h)},
                         Vec3(-16, -16, -20),
                         h};
  fluid::Flow flow(MPI_COMM_WORLD, grid, {}, {});
  flow.solids().set_lumen([](const Vec3& x) { return std::hypot(x.x(), x.y()) - 12.5; });
  test::SyntheticValve valve;
  valve.spacing_mm = 0.6 * h;  // nodes at half a cell where the columns are closest
  const test::ValveMesh mesh = test::synthetic_valve(valve);
  flow.solids().mark_segments(flow.solids().add_body("ring"), mesh.shell.reference, mesh.attachment, 0.8 * h);
  auto shell = std::make_unique<coupling::ImmersedShell>(
      MPI_COMM_WORLD, test::pericardial_shell(mesh), mesh.shell.reference, mesh.shell.reference,
      mesh.attached, mesh.leaflet, coupling::Spacing{{2e5, 0.6 * h}, 1.3 * h});
  coupling::ImmersedFlow system(flow, std::move(shell), {});
  double start = 0;
  for (int n = 0; n < steps + 8; ++n) {
    if (n == 8) {  // after the first estimate of the limit
      MPI_Barrier(MPI_COMM_WORLD);
      start = MPI_Wtime();
    }
    flow.set_end_pressure(fluid::End::high, 10 * units::pa_per_mmHg * std::min(1.0, n / 100.0));
    system.step(1);
  }
  return 1e3 * mpi::max(MPI_COMM_WORLD, MPI_Wtime() - start) / steps;
}

}  // namespace

int main(int argc, char** argv) {
  mpi::Session session(argc, argv);
  for (const Level& level :
       {Level{"draft", 1.0, 6.6}, Level{"standard", 0.75, 12.3}, Level{"fine", 0.5, 29.4}}) {
    // The best of three, so that a busy machine disturbs less.
    double best = 1e300;
    for (int repeat = 0; repeat < 3; ++repeat)
      best = std::min(best, milliseconds_per_step(level.h, level.h < 0.6 ? 16 : 40));
    if (mpi::rank(MPI_COMM_WORLD) == 0)
      std::printf(
          "{\"name\": \"coupled_step_%s\", \"value\": %.4g, \"unit\": \"ms\", \"reference\": %.4g, "
          "\"ratio\": %.4g, \"ranks\": %d}\n",
          level.name, best, level.reference_ms, best / level.reference_ms, mpi::size(MPI_COMM_WORLD));
  }
  return 0;
}
