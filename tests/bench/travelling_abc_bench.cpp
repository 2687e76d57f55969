// The travelling Arnold-Beltrami-Childress flow at equal error (docs/verification/fluid-abc.md): unit
// periodic box, rho = 1, mu = 1e-3,
//   u = 1 + a (cos 2pi(y-t) + sin 2pi(z-t)), v = 1 + a (sin 2pi(x-t) + cos 2pi(z-t)),
//   w = 1 + a (cos 2pi(x-t) + sin 2pi(y-t)), a = e^(-4 pi^2 nu t)
//
//   bench_fluid_abc_ranks [scheme n steps end]     scheme: upwind3, centred4, centred2 (AB2, order 2), the
//       same with _rk3, centred4_order4, conserving4_order4 (RK3, order 4); one JSON object a line
//
// Without arguments: the runs that reach the errors of IBAMR 0.19, whose times on two ranks are the reference
// of the ratio. Error: sqrt(mean over faces of (u - exact)^2).
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <numbers>
#include <string>

#include "fluid/flow.hpp"
#include "travelling_abc.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

constexpr double pi = std::numbers::pi, viscosity = 1e-3;

double exact(int d, const Vec3& x, double t) {
  return test::travelling_abc(d, x, t, viscosity);
}

struct Result {
  double error, seconds, processor, cfl, largest;
};

Result run(const std::string& scheme, int n, int steps, double end) {
  Grid grid;
  grid.cells = {n, n, n};
  grid.h = 1.0 / n;
  Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
  FlowParameters parameters;
  parameters.density = 1;
  parameters.viscosity = viscosity;
  const bool fourth = scheme.ends_with("_order4"), runge_kutta = fourth || scheme.ends_with("_rk3");
  parameters.order = fourth ? 4 : 2;
  parameters.convection = convection_from(scheme.substr(0, scheme.find('_')));
  MPI_Barrier(MPI_COMM_WORLD);
  const double start = MPI_Wtime();  // with the set-up
  const std::clock_t processor = std::clock();
  Flow flow(MPI_COMM_WORLD, grid, boundaries, parameters);
  flow.set_velocity([](int d, const Vec3& x) { return exact(d, x, 0); });
  const double dt = end / steps;
  for (int step = 0; step < steps; ++step) runge_kutta ? flow.step_rk3(dt) : flow.step(dt);
  Result result{};
  result.processor = mpi::max(MPI_COMM_WORLD, static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC);
  result.seconds = mpi::max(MPI_COMM_WORLD, MPI_Wtime() - start);
  double sum = 0, fastest = 0, largest = 0;
  for (int k = 0; k < flow.slab().planes; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double u = flow.velocity()[0](i, j, k);
        const double off = u - exact(0, grid.position(0, i, j, k + flow.slab().first), end);
        sum += off * off;
        largest = std::max(largest, std::abs(off));
        for (int d = 0; d < 3; ++d) fastest = std::max(fastest, std::abs(flow.velocity()[d](i, j, k)));
      }
    }
  }
  result.error = std::sqrt(mpi::sum(MPI_COMM_WORLD, sum) / std::pow(n, 3));
  result.cfl = dt * mpi::max(MPI_COMM_WORLD, fastest) / grid.h;
  result.largest = mpi::max(MPI_COMM_WORLD, largest);
  return result;
}

void print(const std::string& scheme, int n, int steps, double end, double of_error, double of_time) {
  const Result r = run(scheme, n, steps, end);
  if (mpi::rank(MPI_COMM_WORLD) != 0) return;
  std::printf(
      "{\"name\": \"abc_%s_%d_steps_%d_t_%g\", \"value\": %.4g, \"unit\": \"s\", \"reference\": %g, "
      "\"ratio\": %.4g, \"ranks\": %d, \"error_L2_u\": %.3e, \"error_max_u\": %.3e, \"reference_error\": %g, "
      "\"cfl\": %.3f, \"processor_s\": %.4g}\n",
      scheme.c_str(), n, steps, end, r.seconds, of_time, r.seconds / of_time, mpi::size(MPI_COMM_WORLD),
      r.error, r.largest, of_error, r.cfl, r.processor);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  mpi::Session session(argc, argv);
  if (argc == 5) {
    const double end = std::atof(argv[4]);
    const bool fine = end < 0.075;
    print(argv[1], std::atoi(argv[2]), std::atoi(argv[3]), end, fine ? 1.24e-5 : 2.95e-5, fine ? 44 : 6);
    return 0;
  }
  print("upwind3", 64, 100, 0.05, 1.24e-5, 44);
  print("centred4", 64, 100, 0.05, 1.24e-5, 44);
  print("conserving4_order4", 44, 14, 0.05, 1.24e-5, 44);
  print("centred4_order4", 64, 20, 0.05, 1.24e-5, 44);
  print("centred4_order4", 20, 6, 0.05, 1.24e-5, 44);
  print("centred4_order4", 20, 12, 0.1, 2.95e-5, 6);
  print("centred4_order4", 32, 20, 0.1, 2.95e-5, 6);
}
