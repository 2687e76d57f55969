// study_coupling: the benchmarks of docs/verification/coupling.md that take longer than a test may.
//   study_coupling fsi <cells across> <mean mm/s> <solid density g/mm3> <shear Pa> <end s> [key=value ...]
//   study_coupling waves | spins | membranes <steps> | diastole <h mm> <end s> | separation <h mm> <end s>
//   study_coupling bar <cells across> <kernel> <end s>
//     keys: length, ramp, kernel, sampled (0, 1), along, across, wall, csv (file)
#include <chrono>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>

#include "core/errors.hpp"
#include "core/mpi.hpp"
#include "exact_cases.hpp"
#include "studies.hpp"
#include "turek_hron.hpp"

namespace {

using namespace valsalva;

int fsi(int argc, char** argv) {
  if (argc < 7) throw InputError("study_coupling fsi: five numbers are expected, see the head of study.cpp");
  turek::Channel channel;
  channel.cells_across = std::stoi(argv[2]);
  channel.mean_mm_per_s = std::stod(argv[3]);
  channel.bar.density = std::stod(argv[4]);
  channel.bar.shear_Pa = std::stod(argv[5]);
  const double end = std::stod(argv[6]);
  std::string csv;
  for (int i = 7; i < argc; ++i) {
    const std::string word = argv[i], value = word.substr(word.find('=') + 1),
                      key = word.substr(0, word.find('='));
    if (key == "length") {
      channel.length_mm = std::stod(value);
    } else if (key == "ramp") {
      channel.ramp_s = std::stod(value);
    } else if (key == "kernel") {
      channel.kernel = value;
    } else if (key == "sampled") {
      channel.sampled = value == "1";
    } else if (key == "along") {
      channel.bar.along = std::stoi(value);
    } else if (key == "across") {
      channel.bar.across = std::stoi(value);
    } else if (key == "wall") {
      channel.wall = fluid::wall_from(value);
    } else if (key == "csv") {
      csv = value;
    } else {
      throw InputError("study_coupling: unknown key '{}'", key);
    }
  }
  std::ofstream table;
  if (!csv.empty()) table.open(csv);
  table << "time_s,tip_down_mm,tip_across_mm,drag_N_per_m,lift_N_per_m,dt_s,critical_s\n";
  turek::Case run(channel);
  std::printf("%d cells across, %zu points of coupling\n", channel.cells_across,
              run.bar().coupling_points().size());
  std::vector<double> time, down, across, drag, lift;
  const auto begin = std::chrono::steady_clock::now();
  double next = 0, show = 0;
  while (run.time_s() < end) {
    const turek::Reading now = run.step();
    if (now.time_s < next) continue;
    next = now.time_s + 5e-3;
    time.push_back(now.time_s);
    down.push_back(now.tip_down_mm);
    across.push_back(now.tip_across_mm);
    drag.push_back(now.drag_N_per_m);
    lift.push_back(now.lift_N_per_m);
    table << now.time_s << ',' << now.tip_down_mm << ',' << now.tip_across_mm << ',' << now.drag_N_per_m
          << ',' << now.lift_N_per_m << ',' << now.dt_s << ',' << now.critical_s << std::endl;
    if (now.time_s < show) continue;
    show = now.time_s + 0.05 * end;
    std::printf(
        "t %.3f  A %.4f %.4f mm  drag %.3f (bar %.3f) lift %.3f N/m  max %.4g mm/s  dt %.3g of %.3g s  steps "
        "%ld  %.0f s\n",
        now.time_s, now.tip_down_mm, now.tip_across_mm, now.drag_N_per_m, now.bar_pull_N_per_m,
        now.lift_N_per_m, now.max_speed, now.dt_s, now.critical_s, run.system().steps(),
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    std::fflush(stdout);
  }
  for (const auto& [name, values] : std::map<std::string, const std::vector<double>*>{
           {"A down", &down}, {"A across", &across}, {"drag", &drag}, {"lift", &lift}}) {
    const turek::Oscillation o = turek::oscillation(time, *values, 0.8 * end);
    std::printf("%-9s last fifth: %.4f +- %.4f, %.3f Hz (%d periods)\n", name.c_str(), o.mean, o.amplitude,
                o.frequency_Hz, o.periods);
  }
  return 0;
}

int waves() {
  std::printf("kernel coupling shell n error period exact damping exact steps ms\n");
  for (const char* kernel : {"ib4", "cbs43", "bspline3"})
    for (int way = 0; way < 3; ++way)
      for (int n : {16, 32, 64}) {
        if (way == 2 && std::string(kernel) != "ib4") continue;
        const exact::Wave wave{n, kernel, way == 1, way == 2};
        const exact::WaveResult got = exact::wave(wave);
        std::printf("%s %s %s %d %.4f %.5f %.5f %.4f %.4f %ld %.2f\n", kernel,
                    wave.sampled ? "points" : "nodes", wave.kirchhoff ? "kirchhoff" : "cst", n, got.error,
                    got.period, got.exact_period, got.damping, got.exact_damping, got.steps,
                    1e3 * got.seconds_a_step);
        std::fflush(stdout);
      }
  return 0;
}

int spins() {
  std::printf("kernel density n error rate exact strain turned_rad steps\n");
  for (const char* kernel : {"ib4", "cbs43", "bspline3"})
    for (double density : {1.0, 3.0})
      for (int n : {4, 8, 16}) {
        if (density != 1 && std::string(kernel) != "ib4") continue;
        const exact::SpinResult got = exact::spin({n, density, kernel, true});
        std::printf("%s %g %d %.4f %.4f %.4f %.4f %.3f %ld\n", kernel, density, n, got.error, got.rate_at_end,
                    got.exact_at_end, got.largest_strain, got.turned_rad, got.steps);
        std::fflush(stdout);
      }
  return 0;
}

int membranes(long steps) {
  std::printf("kernel nodes_h points_h points leak pressure speed time_s dt_s ms\n");
  for (const char* kernel : {"ib4", "cbs43", "cbs32", "bspline3"})
    for (const auto& [nodes, sampling] : {std::pair{1.0, 0.0}, {1.0, 0.5}, {0.5, 0.0}, {0.5, 0.25}}) {
      const exact::MembraneResult got = exact::membrane({1, nodes, sampling, kernel, steps});
      std::printf("%s %g %g %zu %.3e %.5f %.3f %.3f %.2e %.3f\n", kernel, nodes, sampling, got.points,
                  got.leak, got.pressure_ratio, got.largest_speed, got.time_s, got.dt_s,
                  1e3 * got.seconds_a_step);
      std::fflush(stdout);
    }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  mpi::Session session(argc, argv);
  try {
    if (argc > 1 && std::string(argv[1]) == "fsi") return fsi(argc, argv);
    if (argc > 1 && std::string(argv[1]) == "waves") return waves();
    if (argc > 1 && std::string(argv[1]) == "spins") return spins();
    if (argc > 2 && std::string(argv[1]) == "membranes") return membranes(std::stol(argv[2]));
    if (argc > 3 && std::string(argv[1]) == "diastole")
      return study_diastole(std::stod(argv[2]), std::stod(argv[3]));
    if (argc > 3 && std::string(argv[1]) == "separation")
      return study_separation(std::stod(argv[2]), std::stod(argv[3]));
    if (argc > 4 && std::string(argv[1]) == "bar")
      return study_bar(std::stoi(argv[2]), argv[3], std::stod(argv[4]));
    throw InputError(
        "study_coupling: expected waves, spins, membranes, diastole, separation, bar or fsi; see study.cpp");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
