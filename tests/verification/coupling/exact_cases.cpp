#include "exact_cases.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>

#include "coupling/immersed_flow.hpp"
#include "coupling/immersed_structure.hpp"
#include "materials/neo_hookean.hpp"
#include "materials/st_venant_kirchhoff.hpp"
#include "solid_meshes.hpp"
#include "structure/kirchhoff_shell.hpp"
#include "structure/shell_term.hpp"

namespace valsalva::exact {

namespace {

constexpr int slab_cells = 4;

// --- wave ---

constexpr double wave_length = 16, amplitude = 0.02, stretch = 2, thickness = 0.1, shear = 3400;
constexpr double wave_density = 1e-3, wave_viscosity = 0.05;

double tension() {
  return thickness * shear * (1 - std::pow(stretch, -6));
}

// Amplitude over the initial one at the times given.
std::vector<double> exact_wave(const std::vector<double>& times) {
  constexpr int modes = 150;
  const double k = 2 * M_PI / wave_length, nu = wave_viscosity / wave_density;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(modes + 1, modes + 1);
  for (int j = 0; j < modes; ++j) {
    const double m = 2 * M_PI * j / wave_length, square = k * k + m * m;
    a(0, j + 1) = j == 0 ? 1 : 2;
    a(j + 1, 0) = -tension() * std::pow(k, 4) / (wave_density * wave_length * square);
    a(j + 1, j + 1) = -nu * square;
  }
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(a);
  const Eigen::VectorXcd start = solver.eigenvectors().colPivHouseholderQr().solve(
      Eigen::VectorXcd(Eigen::VectorXd::Unit(modes + 1, 0)));
  std::vector<double> out;
  for (double t : times) {
    std::complex<double> sum = 0;
    for (int j = 0; j <= modes; ++j)
      sum += solver.eigenvectors()(0, j) * start[j] * std::exp(solver.eigenvalues()[j] * t);
    out.push_back(sum.real());
  }
  return out;
}

struct Swing {
  double period = 0, maximum = 0;
};

Swing swing_of(const std::vector<double>& time, const std::vector<double>& value) {
  Swing out;
  std::vector<double> falls;
  for (std::size_t i = 1; i < time.size(); ++i)
    if (value[i - 1] > 0 && value[i] <= 0)
      falls.push_back(time[i - 1] + (time[i] - time[i - 1]) * value[i - 1] / (value[i - 1] - value[i]));
  if (falls.size() < 2) return out;
  out.period = falls[1] - falls[0];
  for (std::size_t i = 0; i < time.size(); ++i)
    if (time[i] > falls[0] && time[i] < falls[1]) out.maximum = std::max(out.maximum, value[i]);
  return out;
}

fluid::Boundaries periodic() {
  fluid::Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {fluid::Side::periodic, fluid::Side::periodic};
  return boundaries;
}

}  // namespace

WaveResult wave(const Wave& wave) {
  const int n = wave.cells;
  const double h = wave_length / n, k = 2 * M_PI / wave_length, plane = 0.5 * wave_length + 0.3 * h;
  fluid::FlowParameters parameters;
  parameters.density = wave_density;
  parameters.viscosity = wave_viscosity;
  fluid::Flow flow(MPI_COMM_SELF, {{n, slab_cells, n}, Vec3::Zero(), h}, periodic(), parameters);

  // Both edges of the sheet are at the same place of the periodic box: their pulls cancel.
  structure::ShellMesh mesh;
  Points start;
  const int per_cell = wave.sampled ? 1 : 2, along = per_cell * n, across = per_cell * slab_cells;
  for (int j = 0; j <= across; ++j)
    for (int i = 0; i <= along; ++i) {
      const Vec3 flat(i * h / per_cell, j * h / per_cell, 0);
      mesh.reference.push_back(flat / stretch);
      start.push_back(flat + Vec3(0, 0, plane + amplitude * std::cos(k * flat.x())));
    }
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < along; ++i) {
      const int a = j * (along + 1) + i, b = a + along + 1;
      if ((i + j) % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b + 1}, {a, b + 1, b}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b}, {a + 1, b + 1, b}});
      }
    }
  mesh.thickness_mm.assign(start.size(), thickness);
  const auto law = std::make_shared<materials::NeoHookean>(shear);
  auto system = std::make_unique<structure::System>();
  const structure::Body body = system->add_body("sheet", start, std::vector<double>(start.size(), 1e-6));
  std::shared_ptr<structure::ForceTerm> term;
  if (wave.kirchhoff) {
    term = std::make_shared<structure::KirchhoffTerm>(
        std::make_shared<structure::KirchhoffShell>(mesh, structure::law_section(law, 1)), body);
  } else {
    term = std::make_shared<structure::ShellTerm>(
        std::make_shared<structure::Shell>(mesh, law, structure::Bending{}), body);
  }
  coupling::ImmersedStructureSettings settings;
  settings.cells = coupling::cells_of(mesh.triangles);
  if (wave.sampled) settings.sampling_mm = 0.5 * h;
  coupling::ImmersedFlowSettings coupled;
  coupled.kernel = coupling::kernel_from(wave.kernel);
  coupled.limits.largest_s = 8e-3 / n;  // for an order in space and time together
  coupled.largest_stretch = 2 * stretch;
  coupling::ImmersedFlow run(flow,
                             std::make_unique<coupling::ImmersedStructure>(
                                 std::move(system), std::vector<std::shared_ptr<structure::ForceTerm>>{term},
                                 mesh.reference, settings),
                             coupled);

  std::vector<double> times, values;
  const auto begin = std::chrono::steady_clock::now();
  for (double t = 0; t < 0.1;) {
    t += run.step(1e-3).dt_s;
    double sum = 0;  // the mean over the trapezoidal rule in x, all rows alike
    const Points& x = run.body()->x();
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < along; ++i)
        sum += (x[j * (along + 1) + i].z() - plane) * std::cos(k * start[j * (along + 1) + i].x());
    times.push_back(t);
    values.push_back(2 * sum / (along * across) / amplitude);
  }
  WaveResult out;
  out.steps = run.steps();
  out.seconds_a_step =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / out.steps;
  const std::vector<double> exact = exact_wave(times);
  for (std::size_t i = 0; i < times.size(); ++i)
    out.error = std::max(out.error, std::abs(values[i] - exact[i]));
  const Swing found = swing_of(times, values), right = swing_of(times, exact);
  out.period = found.period;
  out.exact_period = right.period;
  out.damping = found.maximum;
  out.exact_damping = right.maximum;
  return out;
}

namespace {

// --- spin ---

constexpr double disc = 4, container = 8, start_rate = 20, spin_density = 1e-3, spin_viscosity = 0.02;
constexpr double spin_end = 0.15;

// The disc's rate at the times given (ascending): finite volumes in r, Crank-Nicolson.
std::vector<double> exact_spin(double density_ratio, const std::vector<double>& times) {
  constexpr int cells = 800;
  constexpr double dt = 2e-5;
  const double dr = (container - disc) / cells, nu = spin_viscosity / spin_density;
  // Rate w = u/r: d(r^3 w)/dt = nu d/dr (r^3 dw/dr); the disc is the first unknown, r^3 dr -> inertia.
  std::vector<double> inertia(cells + 1), between(cells + 1), w(cells + 1, start_rate);
  inertia[0] = density_ratio * std::pow(disc, 4) / 4;
  for (int i = 0; i < cells; ++i) {
    const double r = disc + (i + 0.5) * dr, low = disc + i * dr, high = low + dr;
    inertia[i + 1] = r * r * r * dr;
    between[i] = nu * std::pow(low, 3) / (i == 0 ? 0.5 * dr : dr);
    if (i == cells - 1) between[cells] = nu * std::pow(high, 3) / (0.5 * dr);
  }
  std::vector<double> out;
  double t = 0, before = start_rate;
  std::vector<double> upper(cells + 1), right(cells + 1);
  for (double wanted : times) {
    while (t < wanted) {
      before = w[0];
      for (int i = 0; i <= cells; ++i) {  // Thomas
        const double down = i > 0 ? between[i - 1] : 0, up = between[i];
        double flux = -up * w[i] + (i < cells ? up * w[i + 1] : 0);
        if (i > 0) flux += down * (w[i - 1] - w[i]);
        const double diagonal = inertia[i] / dt + 0.5 * (down + up);
        const double lower = -0.5 * down;
        const double pivot = diagonal - (i > 0 ? lower * upper[i - 1] : 0);
        upper[i] = i < cells ? -0.5 * up / pivot : 0;
        right[i] = (inertia[i] / dt * w[i] + 0.5 * flux - (i > 0 ? lower * right[i - 1] : 0)) / pivot;
      }
      for (int i = cells; i >= 0; --i) w[i] = right[i] - (i < cells ? upper[i] * w[i + 1] : 0);
      t += dt;
    }
    out.push_back(w[0] + (before - w[0]) * (t - wanted) / dt);
  }
  return out;
}

}  // namespace

SpinResult spin(const Spin& spin) {
  const double h = disc / spin.cells_a_radius;
  const int n = 2 * static_cast<int>(std::ceil((container + 1.5) / h));
  const Vec3 middle(0.11 * h, 0, -0.07 * h);
  const double half = 0.5 * n * h;
  fluid::Boundaries boundaries;
  boundaries.side = {{{fluid::Side::slip, fluid::Side::slip},
                      {fluid::Side::periodic, fluid::Side::periodic},
                      {fluid::Side::slip, fluid::Side::slip}}};
  fluid::FlowParameters parameters;
  parameters.density = spin_density;
  parameters.viscosity = spin_viscosity;
  parameters.wall = fluid::Wall::interpolated;
  fluid::Flow flow(MPI_COMM_SELF, {{n, slab_cells, n}, Vec3(-half, 0, -half), h}, boundaries, parameters);
  const auto radius_of = [&](const Vec3& x) { return std::hypot(x.x() - middle.x(), x.z() - middle.z()); };
  flow.solids().set_lumen([&](const Vec3& x) { return radius_of(x) - container; });
  const Vec3 rate(0, start_rate, 0);
  flow.set_velocity(
      [&](int d, const Vec3& x) { return radius_of(x) < container ? rate.cross(Vec3(x - middle))[d] : 0.0; });

  const int per_side = spin.sampled ? 2 * spin.cells_a_radius : 4 * spin.cells_a_radius;
  const structure::SolidMesh mesh = structure::solid_box(
      structure::Shape::hex8, {per_side, spin.sampled ? 1 : 2 * slab_cells, per_side}, [&](const Vec3& u) {
        const double a = 2 * u.x() - 1, b = 2 * u.z() - 1;
        return Vec3(middle.x() + disc * a * std::sqrt(1 - 0.5 * b * b), slab_cells * h * u.y(),
                    middle.z() + disc * b * std::sqrt(1 - 0.5 * a * a));
      });
  const auto solid = std::make_shared<structure::Solid>(
      mesh,
      std::make_shared<materials::SolidLaw>(std::make_shared<materials::StVenantKirchhoff>(2e3, 1e3),
                                            materials::Volumetric{}, materials::Split::full),
      structure::Formulation::displacement);
  auto system = std::make_unique<structure::System>();
  const double density = spin.density_ratio * spin_density;
  const structure::Body body = system->add_body("disc", mesh.reference, solid->lumped_mass(density));
  for (int a = 0; a < body.count; ++a) {
    system->hold_along(a, Vec3::UnitY());
    system->state.v[a] = rate.cross(Vec3(mesh.reference[a] - middle));
    system->state.v[a].y() = 0;
  }
  coupling::ImmersedStructureSettings settings;
  settings.cells = coupling::cells_of(mesh);
  if (spin.sampled) settings.sampling_mm = 0.5 * h;
  if (spin.density_ratio > 1) {
    coupling::add_excess_mass(*system, body, density, spin_density, settings.excess_mass_g);
    settings.tie_rate_per_s = 2e3;
  }
  coupling::ImmersedFlowSettings coupled;
  coupled.kernel = coupling::kernel_from(spin.kernel);
  coupled.limits.largest_s = 1e-3;
  coupling::ImmersedFlow run(
      flow,
      std::make_unique<coupling::ImmersedStructure>(std::move(system),
                                                    std::vector<std::shared_ptr<structure::ForceTerm>>{
                                                        std::make_shared<structure::SolidTerm>(solid, body)},
                                                    mesh.reference, settings),
      coupled);

  SpinResult out;
  std::vector<double> times, rates;
  for (double t = 0; t < spin_end;) {
    const Points before = run.body()->x();
    const double dt = run.step(1e-3).dt_s;
    const Points& x = run.body()->x();
    double moment = 0, square = 0;
    for (std::size_t a = 0; a < x.size(); ++a) {
      const Vec3 arm = 0.5 * (x[a] + before[a]) - middle, v = (x[a] - before[a]) / dt;
      moment += arm.z() * v.x() - arm.x() * v.z();
      square += arm.x() * arm.x() + arm.z() * arm.z();
    }
    out.turned_rad += dt * moment / square;
    times.push_back(t + dt);  // symplectic Euler: the velocity of the end carries the step
    rates.push_back(moment / square);
    t += dt;
  }
  const std::vector<double> exact = exact_spin(spin.density_ratio, times);
  for (std::size_t i = 0; i < times.size(); ++i)
    out.error = std::max(out.error, std::abs(rates[i] - exact[i]) / start_rate);
  out.rate_at_end = rates.back();
  out.exact_at_end = exact.back();
  for (const Edge& e : coupling::edges_of(settings.cells)) {
    const double now = (run.body()->x()[e[0]] - run.body()->x()[e[1]]).norm();
    const double then = (mesh.reference[e[0]] - mesh.reference[e[1]]).norm();
    out.largest_strain = std::max(out.largest_strain, std::abs(now / then - 1));
  }
  out.steps = run.steps();
  return out;
}

MembraneResult membrane(const Membrane& membrane) {
  constexpr double radius = 6, stretched = 1.1, wall = 0.3, modulus = 50e3;
  const double h = membrane.h;
  const int n = static_cast<int>(std::ceil(20 / h));
  const double half = 0.5 * n * h;
  fluid::Boundaries boundaries;
  boundaries.side = {{{fluid::Side::slip, fluid::Side::slip},
                      {fluid::Side::periodic, fluid::Side::periodic},
                      {fluid::Side::slip, fluid::Side::slip}}};
  fluid::Flow flow(MPI_COMM_SELF, {{n, slab_cells, n}, Vec3(-half, 0, -half), h}, boundaries, {});
  const int around = static_cast<int>(std::ceil(2 * M_PI * radius / (membrane.node_spacing * h)));
  const int across = static_cast<int>(std::ceil(slab_cells / membrane.node_spacing));
  structure::ShellMesh mesh;
  Points start;
  for (int j = 0; j <= across; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * M_PI * i / around;
      const Vec3 unit(std::sin(angle), 0, std::cos(angle)), along(0, j * slab_cells * h / across, 0);
      mesh.reference.push_back(radius / stretched * unit + along);
      start.push_back(radius * unit + along + Vec3(0.13, 0, -0.21));
    }
  for (int j = 0; j < across; ++j)
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around;
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, b + around}, {a, b + around, a + around}});
    }
  mesh.thickness_mm.assign(start.size(), wall);
  const auto shell = std::make_shared<structure::Shell>(
      mesh, std::make_shared<materials::NeoHookean>(modulus), structure::Bending{});
  auto system = std::make_unique<structure::System>();
  const structure::Body body = system->add_body("membrane", start, shell->lumped_mass(1e-3));
  coupling::ImmersedStructureSettings settings;
  settings.cells = coupling::cells_of(mesh.triangles);
  if (membrane.sampling > 0) settings.sampling_mm = membrane.sampling * h;
  coupling::ImmersedFlowSettings coupled;
  coupled.kernel = coupling::kernel_from(membrane.kernel);
  coupling::ImmersedFlow run(
      flow,
      std::make_unique<coupling::ImmersedStructure>(std::move(system),
                                                    std::vector<std::shared_ptr<structure::ForceTerm>>{
                                                        std::make_shared<structure::ShellTerm>(shell, body)},
                                                    mesh.reference, settings),
      coupled);
  const auto area = [&] {  // of the mean outline of the rows
    const Points& x = run.body()->x();
    double sum = 0;
    for (int j = 0; j <= across; ++j)
      for (int i = 0; i < around; ++i) {
        const Vec3 &a = x[j * around + i], &b = x[j * around + (i + 1) % around];
        sum += 0.5 * (a.z() * b.x() - a.x() * b.z()) / (across + 1);
      }
    return sum;
  };
  MembraneResult out;
  const double before = area();
  const auto begin = std::chrono::steady_clock::now();
  Points last;
  for (long step = 0; step < membrane.steps; ++step) {
    last = run.body()->x();
    out.dt_s = run.step(1e-4).dt_s;
    out.time_s += out.dt_s;
  }
  out.seconds_a_step =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() / membrane.steps;
  out.leak = area() / before - 1;
  for (std::size_t a = 0; a < last.size(); ++a)
    out.largest_speed = std::max(out.largest_speed, (run.body()->x()[a] - last[a]).norm() / out.dt_s);
  const double thin = 1 / stretched;  // of the thickness; the length along y stays
  const double laplace = wall * thin * modulus * (stretched * stretched - thin * thin) / radius;
  out.pressure_ratio = (flow.pressure_at(Vec3(0, h, 0)) - flow.pressure_at(Vec3(8.5, h, 8.5))) / laplace;
  out.points = run.body()->coupling_points().size();
  return out;
}

}  // namespace valsalva::exact
