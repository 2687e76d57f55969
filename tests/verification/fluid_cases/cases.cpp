#include "cases.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <numbers>
#include <sstream>

namespace valsalva::fluid {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

Boundaries periodic_in(int d) {
  Boundaries boundaries;
  boundaries.side[d] = {Side::periodic, Side::periodic};
  return boundaries;
}

double at(const std::vector<double>& x, const std::vector<double>& y, double value) {
  const auto above = std::clamp(std::upper_bound(x.begin(), x.end(), value), x.begin() + 1, x.end() - 1);
  const std::size_t i = above - x.begin();
  const double t = (value - x[i - 1]) / (x[i] - x[i - 1]);
  return (1 - t) * y[i - 1] + t * y[i];
}

// Root mean square of the differences at the places of the reference.
double rms(const std::vector<double>& x, const std::vector<double>& y, const std::string& file) {
  const auto rows = reference(file);
  if (!rows) return -1;
  double sum = 0;
  for (const auto& row : *rows) sum += std::pow(at(x, y, row[0]) - row[1], 2);
  return std::sqrt(sum / static_cast<double>(rows->size()));
}

}  // namespace

std::optional<std::vector<std::vector<double>>> reference(const std::string& file) {
  std::ifstream in(std::string(VALSALVA_REFERENCE) + "/" + file);
  if (!in) return std::nullopt;
  std::vector<std::vector<double>> rows;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || (std::isdigit(static_cast<unsigned char>(line[0])) == 0 && line[0] != '-')) continue;
    std::vector<double> row;
    if (line.find(',') == std::string::npos) {
      std::istringstream fields(line);
      for (double value; fields >> value;) row.push_back(value);
    } else {
      std::istringstream fields(line + ',');
      for (std::string field; std::getline(fields, field, ',');)
        row.push_back(field.empty() || field == "\r" ? none : std::stod(field));
    }
    rows.push_back(row);
  }
  return rows;
}

Cavity cavity(double reynolds, int n, double end, Convection convection) {
  Grid grid;
  grid.cells = {n, n, 3};
  grid.h = 1.0 / n;
  Boundaries boundaries = periodic_in(2);
  boundaries.side[0] = boundaries.side[1] = {Side::wall, Side::wall};
  boundaries.velocity[1][1] = Vec3(1, 0, 0);
  FlowParameters parameters;
  parameters.density = 1;
  parameters.viscosity = 1 / reynolds;
  parameters.convection = convection;
  Flow flow(MPI_COMM_WORLD, grid, boundaries, parameters);
  const double dt = std::min(0.3 * grid.h, grid.h * grid.h * reynolds / 14);
  std::vector<double> y{0}, u{0}, x{0}, v{0};
  const auto lines = [&] {
    y = x = u = v = {0};
    for (int i = 0; i < n; ++i) {
      y.push_back((i + 0.5) * grid.h);
      u.push_back(flow.velocity_at({0.5, y.back(), 1.5 * grid.h})[0]);
      x.push_back(y.back());
      v.push_back(flow.velocity_at({x.back(), 0.5, 1.5 * grid.h})[1]);
    }
    for (auto* line : {&y, &x, &u}) line->push_back(1);
    v.push_back(0);
  };
  double time = 0;
  for (; time < end - 1; time += dt) flow.step(dt);
  lines();
  const auto before = u;
  for (; time < end; time += dt) flow.step(dt);
  lines();
  Cavity result{-1, -1, 0, 0, 0, 0};
  for (std::size_t i = 0; i < u.size(); ++i)
    result.change = std::max(result.change, std::abs(u[i] - before[i]));
  const std::string tail = "Re" + std::to_string(static_cast<int>(reynolds)) + ".dat";
  result.rms_u = rms(y, u, "ghia_u_y0.5_" + tail);
  result.rms_v = rms(x, v, "ghia_v_x0.5_" + tail);
  result.least_u = *std::min_element(u.begin(), u.end());
  result.least_v = *std::min_element(v.begin(), v.end());
  result.most_v = *std::max_element(v.begin(), v.end());
  return result;
}

Cylinder cylinder(int n, double end, Wall wall) {
  Grid grid;
  grid.h = 0.41 / n;
  grid.cells = {n, 3, static_cast<int>(std::lround(2.2 / grid.h))};
  Boundaries boundaries = periodic_in(1);
  boundaries.side[0] = {Side::wall, Side::wall};
  boundaries.side[2] = {Side::inflow, Side::open};
  FlowParameters parameters;
  parameters.density = 1;
  parameters.viscosity = 1e-3;
  parameters.convection = Convection::centred4;
  parameters.wall = wall;
  Flow flow(MPI_COMM_WORLD, grid, boundaries, parameters);
  flow.solids().set_lumen([](const Vec3& x) { return 0.05 - std::hypot(x[0] - 0.2, x[2] - 0.2); });
  const auto inflow = [](const Vec3& x) { return 4 * 0.3 * x[0] * (0.41 - x[0]) / (0.41 * 0.41); };
  flow.set_velocity([&](int d, const Vec3& x) { return d == 2 ? inflow(x) : 0; });
  flow.set_inflow(End::low, inflow);
  const double dt = std::min(0.3 * grid.h / 0.6, grid.h * grid.h / (14 * 1e-3));
  double time = 0;
  for (; time < end - 1; time += dt) flow.step(dt);
  const double before = flow.solids().force_on(Solids::wall)[2];
  for (; time < end; time += dt) flow.step(dt);
  const Vec3 force = flow.solids().force_on(Solids::wall);
  const double scale = 2 / (0.2 * 0.2 * 0.1 * 3 * grid.h), y = 1.5 * grid.h;
  return {scale * force[2], scale * force[0],
          flow.pressure_at({0.2, y, 0.15 - 0.5 * grid.h}) - flow.pressure_at({0.2, y, 0.25 + 0.5 * grid.h}),
          std::abs(force[2] / before - 1)};
}

Sphere sphere(double reynolds, double cells_per_diameter, double width, double end, Wall wall) {
  Grid grid;
  grid.h = 1 / cells_per_diameter;
  const int across = static_cast<int>(std::lround(width / grid.h));
  grid.cells = {across, across, 2 * across};
  grid.origin = Vec3(-0.5 * width, -0.5 * width, -0.7 * width) + grid.h * Vec3(0.23, 0.38, 0.11);
  Boundaries boundaries;
  boundaries.side[2] = {Side::inflow, Side::open};
  FlowParameters parameters;
  parameters.density = 1;
  parameters.viscosity = 1 / reynolds;
  parameters.wall = wall;
  Flow flow(MPI_COMM_WORLD, grid, boundaries, parameters);
  flow.solids().set_lumen([](const Vec3& x) { return 0.5 - x.norm(); });
  flow.set_velocity([](int d, const Vec3&) { return d == 2 ? 1.0 : 0.0; });
  flow.set_inflow(End::low, [](const Vec3&) { return 1.0; });
  const double dt = std::min(0.2 * grid.h, grid.h * grid.h * reynolds / 14);
  double time = 0;
  for (; time < end - 1; time += dt) flow.step(dt);
  const double before = flow.solids().force_on(Solids::wall)[2];
  for (; time < end; time += dt) flow.step(dt);
  const double force = flow.solids().force_on(Solids::wall)[2];
  return {force / (0.5 * pi / 4), std::abs(force / before - 1)};
}

Dissipation taylor_green(int n, double end, const FlowParameters& scheme) {
  Grid grid;
  grid.cells = {n, n, n};
  grid.h = 2 * pi / n;
  Boundaries boundaries;
  for (auto& sides : boundaries.side) sides = {Side::periodic, Side::periodic};
  FlowParameters parameters = scheme;
  parameters.density = 1;
  parameters.viscosity = 1.0 / 1600;
  Flow flow(MPI_COMM_WORLD, grid, boundaries, parameters);
  flow.set_velocity([](int d, const Vec3& x) {
    if (d == 0) return std::sin(x[0]) * std::cos(x[1]) * std::cos(x[2]);
    if (d == 1) return -std::cos(x[0]) * std::sin(x[1]) * std::cos(x[2]);
    return 0.0;
  });
  const double volume = std::pow(2 * pi, 3), interval = 0.25;
  const int steps = static_cast<int>(std::ceil(interval / (0.5 * grid.h)));
  Dissipation result;
  double before = flow.kinetic_energy() / volume;
  for (double time = 0; time < end - 1e-9; time += interval) {
    for (int step = 0; step < steps; ++step) flow.step_rk3(interval / steps);
    const double now = flow.kinetic_energy() / volume;
    result.time.push_back(time + 0.5 * interval);
    result.rate.push_back((before - now) / interval);
    result.energy.push_back(now);
    before = now;
  }
  const auto peak = std::max_element(result.rate.begin(), result.rate.end());
  result.peak = *peak;
  result.peak_time = result.time[peak - result.rate.begin()];
  result.rms = -1;
  if (const auto rows = reference("tgv_re1600_dissipation_wang2013.csv")) {
    double sum = 0, mean = 0;
    int count = 0;
    for (const auto& row : *rows) {
      if (row[0] < result.time.front() || row[0] > result.time.back()) continue;
      sum += std::pow(at(result.time, result.rate, row[0]) - row[1], 2);
      mean += row[1];
      ++count;
    }
    result.rms = std::sqrt(sum / count) / (mean / count);
  }
  return result;
}

}  // namespace valsalva::fluid
