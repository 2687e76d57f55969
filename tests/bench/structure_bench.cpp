// Speed of the structural core.
//
//   bench_structure                   one JSON object a line: {name, value, unit, reference, ratio, ranks};
//                                     `ranks` counts threads, 1 and 2
//   bench_structure once              the same with one thread only
//   bench_structure valve KIND N LAYERS [gamg]          one closed valve by Newton: JSON with unknowns, time,
//                                                       probes
//   bench_structure calculix TYPE N LAYERS FILE         the same valve as CalculiX's input, TYPE C3D8, C3D10,
//                                                       C3D20 ...
//
// The structure runs on threads, not ranks: its bodies are small beside the fluid's grid and every rank of a
// coupled run holds all of them. KIND: tet4, tet10, hex8, hex27, each with -mixed or without. The reference
// of a rate is what the measured memory bandwidth (triad on 240 MB) allows when every byte of the element
// tables and of the nodal arrays is moved once. One thread: processor time, which other work on the machine
// hardly disturbs; two: wall time.
#include <omp.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include "core/errors.hpp"
#include "structure/beam.hpp"
#include "structure/integrator.hpp"
#include "structure/kirchhoff_shell.hpp"
#include "structure/shell_term.hpp"
#include "structure/threads.hpp"
#include "structure_valve.hpp"

using namespace valsalva;
using namespace valsalva::bench;

namespace {

double wall() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

double processor() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return double(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-6 * double(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

void report(const std::string& name, double value, const char* unit, double reference, int threads) {
  std::printf("{\"name\": \"%s\", \"value\": %.6g, \"unit\": \"%s\", ", name.c_str(), value, unit);
  if (reference > 0)
    std::printf("\"reference\": %.6g, \"ratio\": %.4g, ", reference, value / reference);
  else
    std::printf("\"reference\": null, \"ratio\": null, ");
  std::printf("\"ranks\": %d}\n", threads);
  std::fflush(stdout);
}

// Processor time of one thread, which other work on the machine hardly disturbs; wall time of two.
double now() {
  return omp_get_max_threads() == 1 ? processor() : wall();
}

// Seconds of one call: the best of three runs of at least 0.3 s.
template <class Work>
double seconds(const Work& work) {
  work();
  double best = 1e300;
  for (int repeat = 0; repeat < 3; ++repeat) {
    const double start = now();
    int calls = 0;
    do work(), ++calls;
    while (now() - start < 0.3);
    best = std::min(best, (now() - start) / calls);
  }
  return best;
}

double bandwidth() {
  static std::vector<double> a(10'000'000, 1.0), b(a.size(), 2.0), c(a.size(), 3.0);
  const double once = seconds([] {
#pragma omp parallel for schedule(static)
    for (std::size_t i = 0; i < a.size(); ++i) a[i] = b[i] + 1.5 * c[i];
  });
  return 24.0 * double(a.size()) / once;
}

struct Kind {
  Shape shape;
  Formulation formulation;
  std::string name() const { return name_of(shape) + (formulation == Formulation::mixed ? "-mixed" : ""); }
};

std::vector<Kind> kinds() {
  std::vector<Kind> all;
  for (Shape s : {Shape::tet4, Shape::tet10, Shape::hex8, Shape::hex27})
    for (Formulation f : {Formulation::displacement, Formulation::mixed}) all.push_back({s, f});
  return all;
}

Kind kind_named(const std::string& name) {
  for (const Kind& kind : kinds())
    if (kind.name() == name) return kind;
  throw InputError("'{}' is no element; expected tet4, tet10, hex8, hex27, with -mixed or without", name);
}

double bytes_per_element(const Kind& kind) {
  const double n = nodes_of(kind.shape);
  const bool rich = kind.formulation == Formulation::mixed && kind.shape == Shape::tet10;
  const double points = double(quadrature(kind.shape, rich ? Rule::rich : Rule::stiffness).size());
  const double tables = points * (24 * n + 80) + 4 * n;
  return tables + n * 24 * 5;  // positions, the element's own forces out and in, the sum in and out
}

template <class Forces, class Tangent>
void rates(const std::string& name, double count, double bytes, double unknowns, double bytes_per_s,
           int threads, const Forces& forces, const Tangent& tangent) {
  report("forces, " + name, count / seconds(forces), "elements/s", bytes_per_s / bytes, threads);
  report("tangents with assembly, " + name, count / seconds(tangent), "elements/s",
         bytes_per_s / (bytes + 2 * 8 * unknowns * unknowns), threads);
}

void element_rates(double bytes_per_s, int threads) {
  const ClosedValve valve;
  for (const Kind& kind : kinds()) {
    const bool quadratic = kind.shape == Shape::tet10 || kind.shape == Shape::hex27;
    const int n = quadratic ? 24 : 48;
    ValveScene scene(valve, valve_mesh(valve, kind.shape, n, quadratic ? 1 : 2), kind.formulation);
    Points x = scene.system.state.x, f(x.size());
    for (Vec3& p : x) p.z() *= 0.98;
    BlockMatrix k(x.size(), 0);
    rates(
        kind.name(), scene.solid->elements(), bytes_per_element(kind), 3.0 * nodes_of(kind.shape),
        bytes_per_s, threads, [&] { scene.solid->add_forces(x, f); },
        [&] {
          k.set_zero();
          scene.solid->add_tangent(x, k);
        });
  }
}

// The same leaflet as a sheet of triangles.
structure::ShellMesh leaflet_sheet(const ClosedValve& v, int n) {
  structure::ShellMesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      mesh.reference.push_back(leaflet_point(v, double(i) / n, double(j) / n * (1 - 1e-3)));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, d, b});
      mesh.triangles.push_back({a, c, d});
    }
  mesh.thickness_mm.assign(mesh.reference.size(), v.thickness_mm);
  return mesh;
}

void sheet_and_beam_rates(double bytes_per_s, int threads) {
  const ClosedValve v;
  const structure::ShellMesh mesh = leaflet_sheet(v, 48);
  const auto law = std::make_shared<materials::NeoHookean>(v.shear_Pa);
  Points x = mesh.reference, f(x.size());
  for (Vec3& p : x) p.z() *= 0.98;
  const auto sheet = [&](const std::string& name, const auto& shell, double bytes, double unknowns) {
    BlockMatrix k(x.size(), 0);
    rates(
        name, shell.elements(), bytes, unknowns, bytes_per_s, threads, [&] { shell.add_forces(x, f); },
        [&] {
          k.set_zero();
          shell.add_tangent(x, k);
        });
  };
  sheet("triangle with hinges", Shell(mesh, law, {3 * v.shear_Pa, 0.5}), 400, 18);
  sheet("Kirchhoff triangle", KirchhoffShell(mesh, law_section(law, 3)), 900, 18);
  BeamMesh line;
  for (int a = 0; a <= 2000; ++a) line.reference.emplace_back(0.5 * a, std::sin(0.1 * a), 0);
  for (int a = 0; a < 2000; ++a) line.elements.push_back({a, a + 1});
  line.width_mm.assign(2000, 0.3);
  line.depth_mm.assign(2000, 0.4);
  line.depth_axis.assign(2000, Vec3::UnitZ());
  const BeamNetwork beams(line, {5e10, 0.33, 6.45e-3});
  const std::vector<Eigen::Quaterniond> turns(line.reference.size(), Eigen::Quaterniond::Identity());
  Points now = line.reference, force(now.size()), moment(now.size());
  for (Vec3& p : now) p.y() *= 0.9;
  BlockMatrix k(now.size(), now.size());
  rates(
      "beam", beams.elements(), 600, 12, bytes_per_s, threads,
      [&] { beams.add_forces(now, turns, force, moment); },
      [&] {
        k.set_zero();
        beams.add_tangent(now, turns, k);
      });
}

struct SheetScene {
  System system;
  std::shared_ptr<Shell> shell;
  std::vector<std::shared_ptr<ForceTerm>> terms;

  SheetScene(const ClosedValve& v, int n) {
    const structure::ShellMesh mesh = leaflet_sheet(v, n);
    shell = std::make_shared<Shell>(mesh, std::make_shared<materials::NeoHookean>(v.shear_Pa),
                                    Bending{3 * v.shear_Pa, 0.5});
    const Body body = system.add_body("leaflet", mesh.reference, shell->lumped_mass(v.density));
    terms.push_back(std::make_shared<ShellTerm>(shell, body));
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const int a = j * (n + 1) + i;
        if (j == 0 || i == n)
          system.hold(a);
        else {
          if (i == 0) system.hold_along(a, Vec3::UnitY());
          if (j == n) system.hold_along(a, Vec3(-std::sin(M_PI / 3), std::cos(M_PI / 3), 0));
        }
      }
  }
};

template <class Scene>
void explicit_rate(const char* what, Scene& scene, double bytes_per_step, double bytes_per_s, int threads) {
  IntegratorSettings settings;
  settings.step_s = 1e-10;  // below the limit of every mesh here: the speed of a step does not depend on it
  settings.mass_scaling = false;
  Integrator integrator(scene.system, scene.terms, settings);
  const double step = seconds([&] { integrator.step(); });
  report("explicit steps, closed valve, " + std::string(what) + ", " +
             std::to_string(3 * scene.system.nodes()) + " unknowns",
         1 / step, "steps/s", bytes_per_s / bytes_per_step, threads);
}

void explicit_rates(double bytes_per_s, int threads) {
  const ClosedValve valve;
  for (int n : {32, 104}) {
    ValveScene solid(valve, valve_mesh(valve, Shape::hex8, n, 2), Formulation::displacement);
    const double nodal = 24.0 * 8 * double(solid.system.nodes());  // x, v, f, mass, once or twice
    explicit_rate(
        "hex8", solid,
        bytes_per_element({Shape::hex8, Formulation::displacement}) * solid.solid->elements() + nodal,
        bytes_per_s, threads);
  }
  for (int n : {57, 182}) {
    SheetScene sheet(valve, n);
    const double nodal = 24.0 * 8 * double(sheet.system.nodes());
    explicit_rate("triangles with hinges", sheet, 400.0 * sheet.shell->elements() + nodal, bytes_per_s,
                  threads);
  }
}

struct NewtonRun {
  int unknowns = 0, iterations = 0, steps = 0, failures = 0;
  double wall_s = 0, processor_s = 0;
  Points probes;
  std::unique_ptr<ValveScene> scene;  ///< closed
};

NewtonRun newton_run(const Kind& kind, int n, int layers, solve::LinearMethod method) {
  const ClosedValve valve;
  NewtonRun run;
  const double start = wall(), used = processor();
  run.scene = std::make_unique<ValveScene>(valve, valve_mesh(valve, kind.shape, n, layers), kind.formulation);
  ValveScene& scene = *run.scene;
  solve::StaticsSettings settings;
  settings.first_step = 1;
  settings.linear.method = method;
  solve::Statics statics(scene.system, scene.terms, {}, settings);
  run.unknowns = statics.equations().free_unknowns();
  statics.advance_to(1);
  run.wall_s = wall() - start;
  run.processor_s = processor() - used;
  run.iterations = statics.iterations();
  run.steps = statics.steps();
  run.failures = statics.failures();
  run.probes = scene.displacements();
  return run;
}

// One linear system of the closed valve under a dead weight: MUMPS with a new pattern and with the former one
// again, GAMG with conjugate gradients (GMRES where the pressure makes the matrix unsymmetric).
void solver_rates(ValveScene& scene, int threads) {
  solve::Equations equations(scene.system, scene.terms, {});
  BlockMatrix k = equations.matrix();
  equations.tangent(k);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(equations.unknowns());
  for (int a = 0; a < static_cast<int>(scene.system.nodes()); ++a) weight[3 * a + 2] = scene.system.mass(a);
  const std::string of = ", " + std::to_string(equations.free_unknowns()) + " unknowns, ";
  for (const bool multigrid : {false, true}) {
    solve::LinearSettings settings;
    settings.method = multigrid ? solve::LinearMethod::multigrid : solve::LinearMethod::direct;
    solve::LinearSolver solver(settings);
    for (const char* which : {"first", "again"}) {
      Eigen::VectorXd u = Eigen::VectorXd::Zero(equations.unknowns());
      const double start = now();
      const solve::LinearReport found =
          solver.solve(k, equations.fixed(), equations.local(weight), u, scene.system.state.x);
      const bool failed = multigrid && found.direct;
      report(std::string("linear solver, ") + (multigrid ? "GAMG" : "MUMPS") + of + which +
                 (failed ? ", no convergence, then MUMPS" : ""),
             now() - start, "s", 0, threads);
      if (multigrid && !failed)
        report("linear solver, GAMG" + of + which + ", iterations", found.iterations, "iterations", 0,
               threads);
      if (failed) break;
    }
  }
}

void newton_rates(int threads) {
  for (const auto& [name, n, layers] : std::vector<std::tuple<std::string, int, int>>{
           {"hex8-mixed", 32, 2}, {"tet10-mixed", 20, 1}, {"hex27-mixed", 16, 1}, {"hex8-mixed", 104, 2}}) {
    const NewtonRun run = newton_run(kind_named(name), n, layers, solve::LinearMethod::automatic);
    const std::string what =
        "closed valve by Newton, " + name + ", " + std::to_string(run.unknowns) + " unknowns, ";
    report(what + "iterations", run.iterations, "iterations", 0, threads);
    report(what + "time of one", (threads == 1 ? run.processor_s : run.wall_s) / run.iterations, "s", 0,
           threads);
    report(what + "time of all", threads == 1 ? run.processor_s : run.wall_s, "s", 0, threads);
    if (name == "hex8-mixed" && threads == 1) solver_rates(*run.scene, threads);  // no threads in PETSc
  }
}

void print_valve(const std::string& name, int n, int layers, solve::LinearMethod method) {
  const NewtonRun run = newton_run(kind_named(name), n, layers, method);
  std::printf(
      "{\"element\": \"%s\", \"n\": %d, \"unknowns\": %d, \"threads\": %d, \"wall_s\": %.4f, "
      "\"processor_s\": %.4f, \"iterations\": %d, \"steps\": %d, \"failures\": %d, \"probes_mm\": [",
      name.c_str(), n, run.unknowns, omp_get_max_threads(), run.wall_s, run.processor_s, run.iterations,
      run.steps, run.failures);
  for (std::size_t i = 0; i < run.probes.size(); ++i)
    std::printf("%s[%.9g, %.9g, %.9g]", i ? ", " : "", run.probes[i].x(), run.probes[i].y(),
                run.probes[i].z());
  std::printf("]}\n");
}

// CalculiX: mm, N, MPa. C3D20 takes the first 20 nodes of hex27: VTK and CalculiX number them alike.
void write_calculix(const std::string& type, int n, int layers, const std::string& path) {
  const ClosedValve valve;
  const Shape shape = type.starts_with("C3D20")  ? Shape::hex27
                      : type.starts_with("C3D8") ? Shape::hex8
                      : type == "C3D10"          ? Shape::tet10
                                                 : Shape::tet4;
  const int used = type.starts_with("C3D20") ? 20 : nodes_of(shape);
  const ValveMesh m = valve_mesh(valve, shape, n, layers);
  std::vector<int> present(m.mesh.reference.size(), 0);
  for (int e = 0; e < m.mesh.elements(); ++e)
    for (int a = 0; a < used; ++a) present[m.mesh.nodes_of(e)[a]] = 1;
  std::ofstream out(path);
  out.precision(12);
  out << "*NODE, NSET=ALL\n";
  for (std::size_t a = 0; a < present.size(); ++a)
    if (present[a]) {
      const Vec3& x = m.mesh.reference[a];
      out << a + 1 << ", " << x.x() << ", " << x.y() << ", " << x.z() << "\n";
    }
  out << "*ELEMENT, TYPE=" << type << ", ELSET=LEAFLET\n";
  for (int e = 0; e < m.mesh.elements(); ++e) {
    out << e + 1;
    for (int a = 0; a < used; ++a) out << (a == 15 ? ",\n" : ", ") << m.mesh.nodes_of(e)[a] + 1;
    out << "\n";
  }
  const auto set = [&](const char* name, const std::vector<int>& nodes) {
    out << "*NSET, NSET=" << name << "\n";
    for (int a : nodes)
      if (present[a]) out << a + 1 << ",\n";
  };
  std::vector<int> plane, axis;
  for (int a : m.coaptation) (m.unit[a].x() < 1e-9 ? axis : plane).push_back(a);
  std::vector<int> middle;
  for (int a : m.middle)
    if (m.unit[a].y() < 1 - 1e-9) middle.push_back(a);
  set("CLAMPED", m.clamped);
  set("MIDDLE", middle);
  set("PLANE", plane);
  set("AXIS", axis);
  set("PROBES", m.probes);
  const Vec3 along(m.coaptation_normal.y(), -m.coaptation_normal.x(), 0);
  out << "*TRANSFORM, NSET=PLANE, TYPE=R\n"
      << along.x() << ", " << along.y() << ", 0, " << m.coaptation_normal.x() << ", "
      << m.coaptation_normal.y() << ", 0\n";
  out << "*BOUNDARY\nCLAMPED, 1, 3\nMIDDLE, 2, 2\nPLANE, 2, 2\nAXIS, 1, 2\n";
  out << "*MATERIAL, NAME=TISSUE\n*HYPERELASTIC, NEO HOOKE\n"
      << valve.shear_Pa / 2e6 << ", " << 2e6 / valve.bulk_Pa
      << "\n*SOLID SECTION, ELSET=LEAFLET, MATERIAL=TISSUE\n";
  out << "*STEP, NLGEOM, INC=200\n*STATIC\nFIRST, 1\n*DLOAD\n";
  const std::vector<std::vector<int>> local =
      shape == Shape::hex8 || shape == Shape::hex27
          ? std::vector<std::vector<int>>{{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 4, 5},
                                          {1, 2, 5, 6}, {2, 3, 6, 7}, {0, 3, 4, 7}}
          : std::vector<std::vector<int>>{{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}};
  for (const SolidFace& face : m.aortic) {
    const auto nodes = m.mesh.nodes_of(face.element);
    for (std::size_t k = 0; k < local.size(); ++k)
      if (std::all_of(local[k].begin(), local[k].end(), [&](int a) {
            return std::find(face.nodes.begin(), face.nodes.end(), nodes[a]) != face.nodes.end();
          }))
        out << face.element + 1 << ", P" << k + 1 << ", " << valve.pressure_Pa * 1e-6 << "\n";
  }
  out << "*NODE PRINT, NSET=PROBES, FREQUENCY=1000\nU\n*END STEP\n";
  if (!out.flush()) throw InputError("cannot write '{}'", path);
  std::printf("{\"probes\": [");
  for (std::size_t i = 0; i < m.probes.size(); ++i) std::printf("%s%d", i ? ", " : "", m.probes[i] + 1);
  std::printf("], \"unknowns\": %ld}\n", 3 * std::count(present.begin(), present.end(), 1));
}

}  // namespace

int main(int argc, char** argv) {
  structure::wait_passively(argv);
  try {
    const std::string mode = argc > 1 ? argv[1] : "";
    if (mode == "valve" && argc >= 5) {
      print_valve(argv[2], std::atoi(argv[3]), std::atoi(argv[4]),
                  argc > 5 ? solve::LinearMethod::multigrid : solve::LinearMethod::automatic);
    } else if (mode == "calculix" && argc == 6) {
      write_calculix(argv[2], std::atoi(argv[3]), std::atoi(argv[4]), argv[5]);
    } else {
      for (int threads : mode == "once" ? std::vector<int>{1} : std::vector<int>{1, 2}) {
        omp_set_num_threads(threads);
        const double bytes_per_s = bandwidth();
        report("memory bandwidth, triad", 1e-9 * bytes_per_s, "GB/s", 0, threads);
        element_rates(bytes_per_s, threads);
        sheet_and_beam_rates(bytes_per_s, threads);
        explicit_rates(bytes_per_s, threads);
        newton_rates(threads);
      }
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 3;
  }
  return 0;
}
