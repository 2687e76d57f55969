// The pressure of a step: the direct solver against conjugate gradients on the fluid's cells.
//
//   study_pressure [cells...]     one JSON object a line: {name, value, unit}, processor time of this rank
//
// `cube`: a box of walls open at both ends of z. `tube`: a tube along z that fills a quarter of its box, the
// walls penalised (direct) or left out (krylov). A rough flow is advanced 12 steps; the last 8 count.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

struct Result {
  double step_ms, iterations;
};

Result measure(int n, bool tube, const std::optional<KrylovSettings>& krylov) {
  Grid grid;
  grid.cells = {n, n, n};
  grid.h = 32.0 / n;
  grid.origin = Vec3(-16, -16, -16);
  FlowParameters parameters;
  parameters.krylov = krylov;
  Flow flow(MPI_COMM_WORLD, grid, {}, parameters);
  const double radius = 32 * std::sqrt(0.25 / M_PI);
  if (tube) flow.solids().set_lumen([=](const Vec3& x) { return std::hypot(x[0], x[1]) - radius; });
  flow.set_velocity([](int d, const Vec3& x) { return 100 * std::sin(0.4 * x[(d + 1) % 3] + d); });
  const double dt = 0.3 * grid.h / 300;
  double iterations = 0, start = 0;
  constexpr int warm = 4, counted = 8;
  for (int step = 0; step < warm + counted; ++step) {
    if (step == warm) start = static_cast<double>(std::clock());
    flow.set_end_pressure(End::low, 10.0 * step);
    flow.step(dt);
    if (step >= warm) iterations += flow.pressure_iterations();
  }
  const double spent = (static_cast<double>(std::clock()) - start) / CLOCKS_PER_SEC;
  return {1e3 * spent / counted, iterations / counted};
}

}  // namespace

int main(int argc, char** argv) {
  mpi::Session session(argc, argv);
  std::vector<int> sizes;
  for (int a = 1; a < argc; ++a) sizes.push_back(std::atoi(argv[a]));
  if (sizes.empty()) sizes = {32, 64, 128};
  using enum KrylovSettings::Preconditioner;
  for (const int n : sizes) {
    for (const bool tube : {false, true}) {
      const std::string box = (tube ? "tube_" : "cube_") + std::to_string(n);
      const auto say = [&](const std::string& name, const Result& result, double reference) {
        if (mpi::rank(MPI_COMM_WORLD) != 0) return;
        std::printf(
            "{\"name\": \"pressure_%s_%s\", \"value\": %.4g, \"unit\": \"ms\", \"reference\": %.4g, "
            "\"ratio\": "
            "%.3g, \"iterations\": %.1f}\n",
            box.c_str(), name.c_str(), result.step_ms, reference, result.step_ms / reference,
            result.iterations);
        std::fflush(stdout);
      };
      const Result direct = measure(n, tube, {});
      say("direct", direct, direct.step_ms);
      for (const double tolerance : {1e-8, 1e-5})
        say("multigrid_" + std::string(tolerance < 1e-6 ? "1e-8" : "1e-5"),
            measure(n, tube, KrylovSettings{.tolerance = tolerance}), direct.step_ms);
      say("aggregation_1e-8", measure(n, tube, KrylovSettings{.preconditioner = aggregation}),
          direct.step_ms);
    }
  }
}
