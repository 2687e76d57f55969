// Time of one fluid step against the time of moving memory, on the ranks it is started with.
//
//   bench_fluid_ranks [cells...]     one JSON object a line: {name, value, unit, reference, ratio, ranks}
//
// The reference of a step is the time to move 20 doubles a cell at the bandwidth of a triad measured in the
// same run on the same ranks. Boxes: cubes, and 30 x 30 x 60 mm around a tube at h = 1, 0.75 and 0.5 mm.
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "fluid/flow.hpp"

using namespace valsalva;
using namespace valsalva::fluid;

namespace {

struct Entry {
  std::string name, unit;
  double value, reference;
};

// Bytes a second of a[i] = b[i] + s c[i] over all ranks, counted as 24 bytes an element; best of `repeats`.
double triad_bandwidth(MPI_Comm comm, std::size_t elements, int repeats) {
  std::vector<double> a(elements, 0.0), b(elements, 1.0), c(elements, 2.0);
  double best = 1e30;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    MPI_Barrier(comm);
    const double start = MPI_Wtime();
    const double s = 1 + 1e-9 * repeat;
    for (std::size_t i = 0; i < elements; ++i) a[i] = b[i] + s * c[i];
    std::swap(a, b);
    best = std::min(best, mpi::max(comm, MPI_Wtime() - start));
  }
  if (b[elements / 2] < 0) std::abort();
  return 24.0 * elements * mpi::size(comm) / best;
}

struct Timing {
  double total_s, predict_s;
};

Timing time_of_step(Flow& flow, double dt, int steps) {
  Timing best{1e30, 1e30};
  for (int step = 0; step < steps + 2; ++step) {
    MPI_Barrier(flow.slab().comm);
    const double start = MPI_Wtime();
    flow.predict(dt);
    const double middle = MPI_Wtime();
    flow.project(dt);
    const double total = mpi::max(flow.slab().comm, MPI_Wtime() - start);
    if (step >= 2 && total < best.total_s) best = {total, middle - start};
  }
  return best;
}

// Without what is freed but kept (Open MPI tells malloc to keep all of it), such as the triad's arrays.
double resident_doubles_a_cell(const Grid& grid, MPI_Comm comm) {
  malloc_trim(0);
  std::ifstream status("/proc/self/statm");
  double pages = 0, resident = 0;
  status >> pages >> resident;
  return mpi::sum(comm, resident * 4096 / 8) / grid.all_cells();
}

std::unique_ptr<Flow> cube(int n) {
  Grid grid;
  grid.cells = {n, n, n};
  grid.h = 32.0 / n;
  Boundaries boundaries;
  boundaries.side[0] = boundaries.side[1] = {Side::wall, Side::wall};
  return std::make_unique<Flow>(MPI_COMM_WORLD, grid, boundaries, FlowParameters{});
}

std::unique_ptr<Flow> tube(double h) {
  Grid grid;
  grid.h = h;
  grid.cells = {static_cast<int>(30 / h), static_cast<int>(30 / h), static_cast<int>(60 / h)};
  grid.origin = Vec3(-15, -15, -30);
  auto flow = std::make_unique<Flow>(MPI_COMM_WORLD, grid, Boundaries{}, FlowParameters{});
  flow->solids().set_lumen([](const Vec3& x) { return std::hypot(x[0], x[1]) - 12.5; });
  return flow;
}

void measure(const std::string& name, Flow& flow, double bandwidth, double memory_before,
             std::vector<Entry>& entries) {
  flow.set_velocity([](int d, const Vec3& x) { return 100 * std::sin(0.2 * x[(d + 1) % 3] + d); });
  const double cells = static_cast<double>(flow.grid().all_cells());
  const Timing timing = time_of_step(flow, 1e-6, static_cast<int>(std::clamp(2e7 / cells, 8.0, 100.0)));
  entries.push_back({name + "_step", "ms", 1e3 * timing.total_s, 1e3 * 160 * cells / bandwidth});
  entries.push_back({name + "_predict", "ms", 1e3 * timing.predict_s, 1e3 * 160 * cells / bandwidth});
  entries.push_back({name + "_memory", "doubles/cell",
                     resident_doubles_a_cell(flow.grid(), MPI_COMM_WORLD) - memory_before / cells, 40});
}

}  // namespace

int main(int argc, char** argv) {
  mpi::Session session(argc, argv);
  const int ranks = mpi::size(MPI_COMM_WORLD);
  std::vector<int> sizes;
  for (int a = 1; a < argc; ++a) sizes.push_back(std::atoi(argv[a]));
  if (sizes.empty()) sizes = {64, 128};

  std::vector<Entry> entries;
  Grid one;
  const double before = resident_doubles_a_cell(one, MPI_COMM_WORLD);
  for (double h : {1.0, 0.75, 0.5}) {
    auto flow = tube(h);
    const double bandwidth = triad_bandwidth(MPI_COMM_WORLD, 40'000'000 / 3 / ranks, 5);
    measure("fluid_tube_" + std::to_string(flow->grid().all_cells() / 1000) + "k", *flow, bandwidth, before,
            entries);
  }
  for (int n : sizes) {
    auto flow = cube(n);
    const double bandwidth = triad_bandwidth(MPI_COMM_WORLD, 40'000'000 / 3 / ranks, 5);
    if (n == sizes.front()) entries.push_back({"triad", "GB/s", 1e-9 * bandwidth, 1e-9 * bandwidth});
    measure("fluid_cube_" + std::to_string(n), *flow, bandwidth, before, entries);
  }
  if (mpi::rank(MPI_COMM_WORLD) != 0) return 0;
  for (const Entry& entry : entries) {
    std::printf(
        "{\"name\": \"%s\", \"value\": %.4g, \"unit\": \"%s\", \"reference\": %.4g, \"ratio\": %.3g, "
        "\"ranks\": %d}\n",
        entry.name.c_str(), entry.value, entry.unit.c_str(), entry.reference, entry.value / entry.reference,
        ranks);
  }
}
