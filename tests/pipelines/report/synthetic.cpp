#include "synthetic.hpp"

#include <cmath>
#include <functional>
#include <numbers>

#include "bodies/level_set.hpp"
#include "core/run_folder.hpp"
#include "geometry/grid_sdf.hpp"
#include "render/image.hpp"
#include "state/state.hpp"

namespace valsalva::report::synthetic {
namespace {

namespace fs = std::filesystem;
using state::Array;
using state::Mesh;
using state::State;
constexpr double pi = std::numbers::pi;

/// A surface over a grid of `around` x `along` points; `closed` joins the last column to the first.
struct Sheet {
  Points points;
  std::vector<Triangle> triangles;
};
Sheet sheet(int around, int along, bool closed, const std::function<Vec3(double u, double v)>& place) {
  Sheet s;
  for (int j = 0; j <= along; ++j)
    for (int i = 0; i <= around - closed; ++i)
      s.points.push_back(place(static_cast<double>(i) / around, static_cast<double>(j) / along));
  const int row = around + 1 - closed;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const int a = j * row + i, b = j * row + (i + 1) % row, c = a + row, d = b + row;
      s.triangles.push_back({a, b, d});
      s.triangles.push_back({a, d, c});
    }
  return s;
}

double lumen_radius(double z, double angle) {
  const double sinus = std::exp(-std::pow((z - 9) / 6, 2));
  return 12.3 + 0.03 * std::max(0.0, z) + sinus * (3.0 + 1.6 * std::cos(3 * angle));
}

Vec3 cylinder(double radius, double angle, double z) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

Sheet lumen_sheet() {
  return sheet(90, 80, true, [](double u, double v) {
    const double z = -18 + 70 * v, angle = 2 * pi * u;
    return cylinder(lumen_radius(z, angle), angle, z);
  });
}

Mesh wall_mesh() {
  constexpr int around = 60, along = 40;
  Points points;
  for (int layer = 0; layer < 2; ++layer)
    for (int j = 0; j <= along; ++j)
      for (int i = 0; i < around; ++i) {
        const double z = -18 + 70.0 * j / along, angle = 2 * pi * i / around;
        points.push_back(cylinder(lumen_radius(z, angle) + 1.8 * layer, angle, z));
      }
  const int shell = around * (along + 1);
  std::vector<Tetrahedron> tets;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around, c = a + around, d = b + around;
      const int A = a + shell, B = b + shell, C = c + shell, D = d + shell;
      for (const Tetrahedron& t :
           {Tetrahedron{a, b, d, D}, {a, b, D, B}, {a, B, D, A}, {a, D, d, c}, {a, D, c, C}, {a, A, D, C}})
        tets.push_back(t);
    }
  return Mesh::of_tetrahedra(points, tets);
}

/// Three leaflets; opening 0 (closed) .. 1 (open).
Sheet leaflets(double radius, double z0, double height, double opening) {
  Sheet all;
  for (int leaflet = 0; leaflet < 3; ++leaflet) {
    const double start = 2 * pi * leaflet / 3;
    const Sheet one = sheet(18, 12, false, [&](double u, double v) {
      const double angle = start + 2 * pi / 3 * u, belly = std::sin(pi * u);
      const double open_radius = radius * (1 - 0.10 * v * belly);
      const double closed_radius = radius * (1 - 0.97 * std::pow(v, 0.8) * std::pow(belly, 0.7));
      const double r = opening * open_radius + (1 - opening) * closed_radius;
      const double foot = height * (1 - belly) * 0.75;
      return cylinder(r, angle, z0 + foot + v * (height - foot) * (1 - 0.2 * belly * (1 - opening)));
    });
    const int offset = static_cast<int>(all.points.size());
    all.points.insert(all.points.end(), one.points.begin(), one.points.end());
    for (const Triangle& t : one.triangles)
      all.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return all;
}

double frame_radius(double v) {
  return 12.6 - 2.0 * std::sin(pi * std::min(1.0, v / 0.8)) + 3.5 * std::pow(v, 3);
}

Mesh frame_mesh(double radial, double axial, double z0) {
  constexpr int cells = 15, rows = 10, pieces = 4;
  Points points;
  std::vector<Edge> edges;
  const auto place = [&](double u, double v) {
    return cylinder(radial * frame_radius(v), 2 * pi * u / cells, z0 + 42 * axial * v);
  };
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i < cells; ++i)
      for (double side : {-0.5, 0.5}) {
        const double u0 = i + 0.5 * (row % 2);
        for (int k = 0; k < pieces; ++k) {
          for (int end = 0; end < 2; ++end) {
            const double s = static_cast<double>(k + end) / pieces;
            points.push_back(place(u0 + side * s, (row + s) / rows));
          }
          edges.push_back({static_cast<int>(points.size()) - 2, static_cast<int>(points.size()) - 1});
        }
      }
  Mesh mesh = Mesh::of_lines(points, edges);
  mesh.cell_data["width_mm"] = Array::of(std::vector<double>(edges.size(), 0.28));
  mesh.cell_data["depth_mm"] = Array::of(std::vector<double>(edges.size(), 0.45));
  return mesh;
}

Mesh skirt_mesh(double radial, double axial, double z0) {
  const Sheet s = sheet(90, 16, true, [&](double u, double v) {
    return cylinder(radial * (frame_radius(0.3 * v) - 0.3), 2 * pi * u, z0 + 12.6 * axial * v);
  });
  return Mesh::of_triangles(s.points, s.triangles);
}

Mesh mesh_of(const Sheet& s) {
  return Mesh::of_triangles(s.points, s.triangles);
}

void add_level_set(State& state) {
  const auto grid = geometry::sample({-19, -19, -18}, {19, 19, 52}, 1.0, [](const Vec3& x) {
    return std::hypot(x.x(), x.y()) - lumen_radius(x.z(), std::atan2(x.y(), x.x()));
  });
  bodies::put_level_set(state, "lumen", grid);
}

double opening_at(double t) {
  const auto smooth = [](double x) { return x < 0 ? 0.0 : x > 1 ? 1.0 : x * x * (3 - 2 * x); };
  return smooth((t - 0.05) / 0.05) * (1 - smooth((t - 0.32) / 0.05));
}
double flow_at(double t) {
  return t > 0.05 && t < 0.36 ? 420 * std::sin(pi * (t - 0.05) / 0.31) : 0;
}

void add_frames(State& state) {
  constexpr std::size_t n = 24, nx = 39, nz = 71;
  std::vector<double> time, pressure, velocity;
  std::vector<float> points;
  for (std::size_t f = 0; f < n; ++f) {
    const double t = 0.8 * static_cast<double>(f) / (n - 1);
    time.push_back(t);
    for (const Vec3& x : leaflets(11, 4, 13, opening_at(t)).points)
      for (int d = 0; d < 3; ++d) points.push_back(static_cast<float>(x[d]));
    for (std::size_t k = 0; k < nz; ++k)
      for (std::size_t i = 0; i < nx; ++i) {
        const double x = -19.0 + static_cast<double>(i), z = -18.0 + static_cast<double>(k);
        const double jet = z < 17 ? 11 : 9.5;
        const double speed = 10 * flow_at(t) / (pi * jet * jet / 100) / 1.0;
        const double inside = std::abs(x) < lumen_radius(z, x > 0 ? 0 : pi) ? 1 : 0;
        velocity.insert(velocity.end(),
                        {0.0, 0.0, inside * speed * std::max(0.0, 1 - std::pow(x / (jet + 1), 4))});
        pressure.push_back(opening_at(t) > 0.5 ? 118 - 0.2 * z : (z < 12 ? 8.0 : 82.0));
      }
  }
  const std::size_t nodes = leaflets(11, 4, 13, 0).points.size();
  state.restart["frames/time_s"] = Array::of(time);
  state.restart["frames/leaflet_points"] = Array::of(points, {n, nodes, 3});
  state.restart["frames/slice_velocity_mm_per_s"] = Array::of(velocity, {n, nz, nx, 3});
  state.restart["frames/slice_pressure_mmHg"] = Array::of(pressure, {n, nz, nx});
  state.restart["frames/slice_origin_mm"] = Array::of(std::vector<double>{-19, 0, -18});
  state.restart["frames/slice_spacing_mm"] = Array::of(std::vector<double>{1, 1, 1});
}

void add_meshes(State& state, const std::string& stage) {
  if (stage == "segment" || stage == "mesher" || stage == "deploy" || stage == "cycle") {
    state.meshes["lumen"] = mesh_of(lumen_sheet());
    add_level_set(state);
  }
  if (stage == "segment") {
    state.meshes["centreline"] = Mesh::of_lines({{0, 0, -18}, {0.3, 0, 10}, {0, 0.2, 52}}, {{0, 1}, {1, 2}});
    state.meshes["calcium"] = mesh_of(sheet(24, 12, true, [](double u, double v) {
      return Vec3(Vec3(10.5, 3, 7) + 1.8 * cylinder(std::sin(pi * v), 2 * pi * u, std::cos(pi * v)));
    }));
  }
  if (stage == "mesher") state.meshes["wall"] = wall_mesh();
  if (stage == "mesher" || stage == "deploy")
    state.meshes["native_leaflets"] = mesh_of(leaflets(12.2, 0, 11, stage == "mesher" ? 0.1 : 1.0));
  if (stage == "stent" || stage == "crimp" || stage == "deploy" || stage == "cycle") {
    const double radial = stage == "crimp" ? 0.2 : stage == "stent" ? 1.0 : 0.93;
    const double axial = stage == "crimp" ? 1.15 : 1.0, z0 = stage == "deploy" || stage == "cycle" ? -5 : 0;
    state.meshes["frame"] = frame_mesh(radial, axial, z0);
    state.meshes["skirt"] = skirt_mesh(radial, axial, z0);
    state.meshes["leaflets"] = mesh_of(leaflets(stage == "crimp" ? 2.2 : 11, z0 + 9, 13, 0.5));
  }
  if (stage == "cycle") add_frames(state);
}

const std::map<std::string, std::map<std::string, double>> metrics{
    {"segment", {{"annulus_diameter_mm", 24.6}, {"annulus_area_mm2", 475}, {"calcium_volume_mm3", 310}}},
    {"mesher", {{"nodes", 5040}, {"elements", 14400}, {"min_dihedral_deg", 14.2}}},
    {"stent", {{"nodes", 1200}, {"beams", 1200}, {"height_mm", 42}}},
    {"crimp", {{"crimped_diameter_mm", 5.61}, {"crimped_diameter_Fr", 16.83}, {"radial_force_N", 61}}},
    {"deploy", {{"implant_depth_mm", 5.1}, {"eccentricity", 0.04}, {"chronic_outward_force_N", 12.4}}},
    {"cycle",
     {{"mean_gradient_mmHg", 8.9},
      {"peak_gradient_mmHg", 17.2},
      {"eoa_cm2", 1.12},
      {"stroke_volume_mL", 78.3},
      {"regurgitant_volume_mL", 2.1},
      {"max_cfl", 0.33}}}};

void write_histories(const std::string& stage, const RunFolder& run) {
  if (stage == "crimp") {
    History history({"time_s", "crimper_diameter_mm", "radial_force_N", "kinetic_to_internal_energy"});
    for (int i = 0; i <= 200; ++i) {
      const double d = 29 - 23.4 * i / 200.0;
      history.add({i * 2e-4, d, 0.4 * std::pow(29 - d, 1.6), 0.03 * std::exp(-i / 20.0)});
    }
    history.write(run.file("history.csv"));
  }
  if (stage == "cycle") {
    History history({"step", "time_s", "lv_pressure_mmHg", "aortic_pressure_mmHg", "la_pressure_mmHg",
                     "aortic_flow_mL_per_s", "mitral_flow_mL_per_s", "goa_cm2", "gradient_mmHg", "dt_s"});
    for (int i = 0; i <= 8000; ++i) {
      const double t = 1e-4 * i, open = opening_at(t);
      const double aortic =
          80 + (t < 0.36 ? 40 * std::sin(pi * t / 0.72) : 40 * std::exp(-(t - 0.36) / 0.25));
      const double lv = open > 0.02 ? aortic + 0.04 * flow_at(t)
                        : t < 0.06  ? 8 + 72 * t / 0.06
                                    : 8 + 90 * std::exp(-(t - 0.36) / 0.02);
      const double ringing = t > 0.37 ? -90 * std::exp(-(t - 0.37) / 0.01) * std::cos(900 * (t - 0.37)) : 0;
      history.add({static_cast<double>(i), t, lv, aortic, 9 + std::sin(8 * t), flow_at(t) + ringing,
                   t > 0.45 ? 200 * std::sin(pi * (t - 0.45) / 0.35) : 0, 2.6 * open, lv - aortic,
                   1e-5 * (2 + 6 * open)});
    }
    history.write(run.file("history.csv"));
  }
}

void write_stage(const fs::path& folder, const std::string& stage) {
  const RunFolder run(folder / stage);
  State state;
  state.stage = stage;
  state.case_name = "synthetic";
  state.version = "test";
  state.parameters = "case.name = synthetic\nreport.viewer_frames = 40\n";
  state.parameters_sha256 = std::string(64, 'a');
  state.parents = {"runs/synthetic/parent/state_000001.h5 " + std::string(64, 'b')};
  state.final = true;
  add_meshes(state, stage);
  state::write(run.state_path(1), state);

  Summary summary;
  summary.stage = stage;
  summary.case_name = "synthetic";
  summary.fidelity = "draft";
  summary.steps = stage == "cycle" ? 32000 : 400;
  summary.simulated_s = stage == "cycle" ? 0.8 : 0;
  summary.wall_s = stage == "cycle" ? 512 : 21.5;
  summary.metrics = metrics.at(stage);
  summary.inputs["case.toml"] = std::string(64, 'c');
  summary.parameters_sha256 = std::string(64, 'd');
  summary.notes["assumption"] = "made-up numbers & shapes for a test of the <report>";
  summary.checks["volume_balance_error_pct"] = {0.12, 0.5, true};
  if (stage == "deploy") summary.checks["max_penetration_mm"] = {0.31, 0.2, false};
  if (stage == "cycle")
    summary.extra["accuracy"] = {{"mean_gradient_band_pct", 12}, {"basis", "made up for a test"}};
  run.write_summary(summary);
  write_histories(stage, run);
  if (stage == "segment") {
    Image picture{320, 120, {}};
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x) {
        const auto grey = static_cast<std::uint8_t>((x * 7 + y * 3) % 200);
        picture.rgba.insert(picture.rgba.end(), {grey, grey, grey, 255});
      }
    write_atomically(run.file("contours.png"), png(picture));
  }
}

}  // namespace

void write_run(const fs::path& folder, const std::set<std::string>& stages) {
  for (const std::string& stage : stages) write_stage(folder, stage);
}

}  // namespace valsalva::report::synthetic
