#include "bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/errors.hpp"

namespace valsalva::report {
namespace {

struct Style {
  const char* id;
  const char* label;
  Colour colour;
  double opacity;
  bool glass;
};

constexpr std::array<Style, 6> styles{
    {{"frame", "Frame", {0.58f, 0.63f, 0.70f}, 1, false},
     {"leaflets", "Device leaflets", {0.95f, 0.87f, 0.76f}, 1, false},
     {"skirt", "Skirt", {0.55f, 0.72f, 0.76f}, 1, false},
     {"native_leaflets", "Native leaflets", {0.80f, 0.56f, 0.42f}, 1, false},
     {"calcium", "Calcium", {0.93f, 0.90f, 0.80f}, 1, false},
     {"lumen", "Lumen", {0.78f, 0.42f, 0.42f}, 0.22, true}}};

Surface frame_tubes(const state::Mesh& mesh, int sides) {
  const std::vector<Edge> edges = mesh.lines("frame");
  std::vector<double> radius(edges.size(), 0.18);
  const auto width = mesh.cell_data.find("width_mm"), depth = mesh.cell_data.find("depth_mm");
  if (width != mesh.cell_data.end() && depth != mesh.cell_data.end()) {
    const std::vector<double> w = values_of(width->second), d = values_of(depth->second);
    for (std::size_t e = 0; e < edges.size() && e < w.size() && e < d.size(); ++e)
      radius[e] = 0.5 * std::sqrt(w[e] * d[e]);
  }
  return tubes(mesh.points, edges, radius, sides);
}

}  // namespace

std::vector<Body> bodies_of(const state::State& state, int tube_sides) {
  std::vector<Body> bodies;
  for (const Style& style : styles) {
    if (!state.has_mesh(style.id)) continue;
    const state::Mesh& mesh = state.mesh(style.id);
    Body body{style.id, style.label, {}};
    if (body.id == "frame") {
      body.surface = frame_tubes(mesh, tube_sides);
    } else {
      body.surface.points = mesh.points;
      body.surface.triangles = mesh.triangles(style.id);
    }
    body.surface.colour = style.colour;
    body.surface.opacity = style.opacity;
    body.surface.glass = style.glass;
    bodies.push_back(std::move(body));
  }
  return bodies;
}

const Body* find_body(const std::vector<Body>& bodies, const std::string& id) {
  const auto found = std::find_if(bodies.begin(), bodies.end(), [&](const Body& b) { return b.id == id; });
  return found == bodies.end() ? nullptr : &*found;
}

std::string valve_of(const state::State& state) {
  if (state.has_mesh("leaflets")) return "leaflets";
  return state.has_mesh("native_leaflets") ? "native_leaflets" : "";
}

std::vector<double> values_of(const state::Array& array) {
  return std::visit([](const auto& data) { return std::vector<double>(data.begin(), data.end()); },
                    array.data);
}

std::optional<geometry::GridSdf> lumen_level_set(const state::State& state) {
  for (const char* name : {"levelset/lumen", "levelset/origin_mm", "levelset/spacing_mm"})
    if (!state.has_array(name)) return std::nullopt;
  const state::Array& lumen = state.array("levelset/lumen");
  const std::vector<double> origin = values_of(state.array("levelset/origin_mm"));
  const std::vector<double> spacing = values_of(state.array("levelset/spacing_mm"));
  if (lumen.shape.size() != 3 || origin.size() != 3 || spacing.empty()) return std::nullopt;
  geometry::GridSdf grid;
  for (int d = 0; d < 3; ++d) grid.dimensions[d] = static_cast<int>(lumen.shape[2 - d]);
  grid.origin = {origin[0], origin[1], origin[2]};
  grid.spacing = spacing[0];
  const std::vector<double> values = values_of(lumen);
  grid.values.assign(values.begin(), values.end());
  return grid;
}

namespace {

/// Mean distance of the nodes from the axis of the valve: large when the leaflets lie against the wall.
double spread(const Points& points) {
  Vec3 centre = Vec3::Zero();
  for (const Vec3& x : points) centre += x / static_cast<double>(points.size());
  double sum = 0;
  for (const Vec3& x : points) sum += std::hypot(x.x() - centre.x(), x.y() - centre.y());
  return sum / static_cast<double>(points.size());
}

void read_slices(const state::State& state, Beat& beat, std::size_t frames) {
  if (!state.has_array("frames/slice_velocity_mm_per_s")) return;
  const state::Array& velocity = state.array("frames/slice_velocity_mm_per_s");
  if (velocity.shape.size() != 4 || velocity.shape[0] != frames || velocity.shape[3] != 3)
    throw InputError(
        "frames/slice_velocity_mm_per_s: expected the shape (frames, nz, nx, 3) with {} frames; run "
        "cycle again",
        frames);
  beat.nz = velocity.shape[1];
  beat.nx = velocity.shape[2];
  const std::vector<double> v = values_of(velocity);
  const std::size_t samples = beat.nx * beat.nz;
  for (std::size_t f = 0; f < frames; ++f) {
    std::vector<double> speed(samples);
    for (std::size_t i = 0; i < samples; ++i) {
      const double* u = &v[3 * (f * samples + i)];
      speed[i] = 0.1 * std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    }
    beat.speed_cm_per_s.push_back(std::move(speed));
  }
  const std::vector<double> origin = values_of(state.array("frames/slice_origin_mm"));
  const std::vector<double> spacing = values_of(state.array("frames/slice_spacing_mm"));
  if (origin.size() != 3 || spacing.empty())
    throw InputError("frames/slice_origin_mm: expected three numbers, found {}; run cycle again",
                     origin.size());
  beat.origin = {origin[0], origin[1], origin[2]};
  beat.spacing = spacing.size() == 3 ? Vec3(spacing[0], spacing[1], spacing[2])
                                     : Vec3(spacing.front(), spacing.front(), spacing.back());
  if (!state.has_array("frames/slice_pressure_mmHg")) return;
  const std::vector<double> p = values_of(state.array("frames/slice_pressure_mmHg"));
  if (p.size() != frames * samples) return;
  for (std::size_t f = 0; f < frames; ++f)
    beat.pressure_mmHg.emplace_back(p.begin() + static_cast<long>(f * samples),
                                    p.begin() + static_cast<long>((f + 1) * samples));
}

double mean(const std::vector<double>& values, std::size_t begin, std::size_t end) {
  double sum = 0;
  for (std::size_t i = begin; i < end; ++i) sum += values[i];
  return sum / static_cast<double>(end - begin);
}

void choose_frames(Beat& beat) {
  const auto highest = [](const std::vector<double>& values) {
    return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
  };
  std::vector<double> width, narrowness, speed, drop;
  for (const Points& points : beat.valve) {
    width.push_back(spread(points));
    narrowness.push_back(-width.back());
  }
  beat.open = highest(width);
  beat.closed = highest(narrowness);
  const double wide = 0.3 * width[beat.closed] + 0.7 * width[beat.open];
  const std::size_t samples = beat.nx * beat.nz;
  for (std::size_t f = 0; f < beat.speed_cm_per_s.size(); ++f)
    speed.push_back(width[f] < wide ? 0 : mean(beat.speed_cm_per_s[f], 0, samples));
  for (const std::vector<double>& p : beat.pressure_mmHg)
    drop.push_back(mean(p, samples - beat.nx, samples) - mean(p, 0, beat.nx));
  if (!speed.empty()) beat.open = highest(speed);
  if (!drop.empty()) beat.closed = highest(drop);
}

}  // namespace

std::optional<Beat> beat_of(const state::State& state) {
  const std::string valve = valve_of(state);
  if (valve.empty() || !state.has_array("frames/time_s") || !state.has_array("frames/leaflet_points"))
    return std::nullopt;
  Beat beat;
  beat.time_s = values_of(state.array("frames/time_s"));
  const std::size_t frames = beat.time_s.size(), nodes = state.mesh(valve).points.size();
  if (frames == 0) return std::nullopt;
  const std::vector<double> x = values_of(state.array("frames/leaflet_points"));
  if (x.size() != 3 * frames * nodes)
    throw InputError(
        "frames/leaflet_points: expected {} frames of {} nodes, found {} numbers; run cycle again", frames,
        nodes, x.size());
  for (std::size_t f = 0; f < frames; ++f) {
    Points points(nodes);
    for (std::size_t i = 0; i < nodes; ++i) points[i] = Vec3(&x[3 * (f * nodes + i)]);
    beat.valve.push_back(std::move(points));
  }
  read_slices(state, beat, frames);
  choose_frames(beat);
  return beat;
}

}  // namespace valsalva::report
