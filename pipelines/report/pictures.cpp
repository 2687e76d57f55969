#include "pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/rasteriser.hpp"

namespace valsalva::report {
namespace {

const Vec3 from_front(0.0, 1.0, -0.22), from_aorta(0.0, 0.0, -1.0);

/// A view whose height follows the shape of the box.
Camera view(const Vec3& toward, const Box& box, int width) {
  Camera camera;
  camera.toward = toward;
  camera.up = std::abs(toward.normalized().z()) > 0.9 ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  camera.width = width;
  camera.height = 1000000;  // first by width alone, then as high as the box needs
  camera = camera.framing(box);
  const double wide = camera.mm_per_pixel;
  camera.width = 1000000;
  camera.height = width;
  const double high = camera.framing(box).mm_per_pixel;
  camera.width = width;
  camera.height = std::clamp(static_cast<int>(width * high / wide), width * 5 / 10, width * 15 / 10);
  return camera.framing(box);
}

Picture picture(const std::vector<Surface>& surfaces, const Camera& camera, std::string alt,
                std::string caption) {
  Picture result;
  result.png = png(render(surfaces, camera));
  result.alt = std::move(alt);
  result.caption = std::move(caption);
  result.width_mm = camera.mm_per_pixel * camera.width;
  return result;
}

Box box_of(const std::vector<Body>& bodies, const std::vector<std::string>& ids) {
  Box box;
  for (const std::string& id : ids)
    if (const Body* body = find_body(bodies, id)) box.add(body->surface.points);
  return box;
}

std::vector<Surface> surfaces_of(const std::vector<Body>& bodies,
                                 const std::vector<std::string>& without = {}) {
  std::vector<Surface> surfaces;
  for (const Body& body : bodies)
    if (std::find(without.begin(), without.end(), body.id) == without.end()) surfaces.push_back(body.surface);
  return surfaces;
}

/// The region around the valve: the box of `ids`, grown.
Box around(const std::vector<Body>& bodies, const std::vector<std::string>& ids, double margin) {
  Box box = box_of(bodies, ids);
  if (box.empty()) return box_of(bodies, {"lumen"});
  box.low.array() -= margin;
  box.high.array() += margin;
  return box;
}

}  // namespace

std::vector<Picture> anatomy_pictures(const RunData& run, int width) {
  const auto& state = run.stage("segment").state;
  if (!state) return {};
  const std::vector<Body> bodies = bodies_of(*state);
  const Body* lumen = find_body(bodies, "lumen");
  if (!lumen) return {};
  std::vector<Surface> surfaces = surfaces_of(bodies);
  if (state->has_mesh("centreline")) {
    const state::Mesh& line = state->mesh("centreline");
    const std::vector<Edge> edges = line.lines("centreline");
    Surface tube = tubes(line.points, edges, std::vector<double>(edges.size(), 0.35), 8);
    tube.colour = {0.20f, 0.38f, 0.70f};
    surfaces.push_back(tube);
  }
  const Box box = box_of(bodies, {"lumen"});
  std::vector<Picture> pictures;
  for (const Vec3& toward : {from_front, Vec3(1.0, 0.0, -0.22)})
    pictures.push_back(
        picture(surfaces, view(toward, box, width),
                "Segmented lumen of the aortic root as a translucent surface, with calcium and centreline",
                pictures.empty() ? "Lumen, calcium and centreline in the annulus frame, aorta above"
                                 : "The same from the side"));
  return pictures;
}

std::vector<Picture> mesh_pictures(const RunData& run, int width) {
  const auto& state = run.stage("mesher").state;
  if (!state) return {};
  const std::vector<Body> bodies = bodies_of(*state);
  std::vector<Picture> pictures;
  std::vector<Surface> surfaces;
  Box box;
  if (state->has_mesh("wall")) {
    const state::Mesh& wall = state->mesh("wall");
    const double middle = 0.0;
    Surface cut =
        boundary(wall.points, wall.tetrahedra("wall"), [&](const Vec3& x) { return x.y() > middle; });
    cut.colour = {0.86f, 0.66f, 0.62f};
    cut.edges = true;
    cut.smooth = false;
    box.add(cut.points);
    surfaces.push_back(cut);
  } else if (const Body* lumen = find_body(bodies, "lumen")) {
    Surface surface = lumen->surface;
    surface.edges = true;
    box.add(surface.points);
    surfaces.push_back(surface);
  }
  if (const Body* native = find_body(bodies, "native_leaflets")) {
    Surface surface = native->surface;
    surface.edges = true;
    surfaces.push_back(surface);
    box.add(surface.points);
    Box close;
    close.add(surface.points);
    pictures.push_back(picture({surface}, view(from_aorta, close, width),
                               "Mesh of the native leaflets seen from the aorta",
                               "Native leaflets seen from the aorta, with their elements"));
  }
  if (!surfaces.empty())
    pictures.insert(pictures.begin(),
                    picture(surfaces, view(from_front, box, width),
                            "Tetrahedral mesh of the wall, cut open, with the native leaflets inside",
                            "Wall mesh, cut open in the plane through the axis, with the native leaflets"));
  return pictures;
}

std::vector<Picture> device_pictures(const RunData& run, int width) {
  std::vector<Picture> pictures;
  std::optional<Camera> scale;
  for (const std::string stage : {"stent", "crimp"}) {
    const auto& state = run.stage(stage).state;
    if (!state || !state->has_mesh("frame")) continue;
    const bool crimped = stage == "crimp";
    const std::string word = state->final ? "Crimped" : "On its way to the crimped shape";
    const std::vector<Body> bodies = bodies_of(*state);
    const Box box = box_of(bodies, {"frame", "leaflets", "skirt"});
    Camera camera = view(from_front, box, width * 2 / 3);
    if (scale && scale->mm_per_pixel > camera.mm_per_pixel) {
      camera.mm_per_pixel = scale->mm_per_pixel;
      camera.width = scale->width;
      camera.height = static_cast<int>(1.08 * (box.high.z() - box.low.z()) / camera.mm_per_pixel) + 40;
    }
    scale = camera;
    pictures.push_back(
        picture(surfaces_of(bodies), camera,
                crimped ? "Crimped device from the side" : "Expanded device from the side",
                crimped ? word + ", at the same scale" : std::string("Expanded, free of loads")));
    pictures.push_back(picture(surfaces_of(bodies), view(from_aorta, box, width * 2 / 3),
                               crimped ? "Crimped device seen along its axis from the aorta"
                                       : "Expanded device seen along its axis from the aorta",
                               crimped ? word + ", seen from the aorta (its own scale)"
                                       : std::string("Expanded, seen from the aorta")));
  }
  return pictures;
}

std::vector<Picture> deployed_pictures(const RunData& run, int width) {
  const auto& state = run.stage("deploy").state;
  if (!state) return {};
  const std::vector<Body> bodies = bodies_of(*state);
  Box box = around(bodies, {"frame", "native_leaflets"}, 4);
  std::vector<Picture> pictures;
  pictures.push_back(picture(surfaces_of(bodies), view(from_front, box, width),
                             "Deployed device inside the translucent aortic root, from the side",
                             "The device where it came to rest, in the translucent root"));
  // The front half taken away: how frame, skirt and native leaflets lie on the wall.
  std::vector<Surface> half;
  for (const Body& body : bodies) {
    Surface surface = clip(body.surface, [](const Vec3& x) { return x.y() > -0.5; });
    surface.glass = false;
    surface.opacity = 1;
    half.push_back(surface);
  }
  pictures.push_back(picture(half, view(Vec3(0, 1, -0.12), box, width),
                             "Cut through the deployed device, native leaflets and root",
                             "The same, with the front half taken away"));
  const Box device = around(bodies, {"frame", "leaflets", "native_leaflets"}, 1);
  pictures.push_back(picture(surfaces_of(bodies, {"lumen"}), view(from_aorta, device, width),
                             "Deployed device seen from the aorta", "Seen from the aorta, without the wall"));
  return pictures;
}

namespace {

struct Slice {
  const Beat& beat;
  const geometry::GridSdf* lumen;
  bool inside(const Vec3& x) const { return !lumen || lumen->value(x) < 0.25 * lumen->spacing; }
};

/// Bilinear in the slice; `refine` points a sample, so that the level set can cut the picture smoothly at the
/// wall.
Surface slice_surface(const Slice& slice, const std::vector<double>& values, double low, double high,
                      bool fading) {
  constexpr std::size_t refine = 4;
  const Beat& beat = slice.beat;
  const std::size_t columns = refine * (beat.nx - 1) + 1, rows = refine * (beat.nz - 1) + 1;
  Surface surface;
  surface.lit = false;
  for (std::size_t k = 0; k < rows; ++k)
    for (std::size_t i = 0; i < columns; ++i) {
      const double gx = static_cast<double>(i) / refine, gz = static_cast<double>(k) / refine;
      const std::size_t ci = std::min(i / refine, beat.nx - 2), ck = std::min(k / refine, beat.nz - 2);
      const double wx = gx - static_cast<double>(ci), wz = gz - static_cast<double>(ck);
      const double* v = &values[ck * beat.nx + ci];
      const double value =
          (1 - wz) * ((1 - wx) * v[0] + wx * v[1]) + wz * ((1 - wx) * v[beat.nx] + wx * v[beat.nx + 1]);
      const double t = std::clamp((value - low) / (high - low), 0.0, 1.0);
      const Vec3 x = beat.origin + Vec3(gx * beat.spacing.x(), 0, gz * beat.spacing.z());
      surface.points.push_back(x);
      surface.point_colours.push_back(heat(t));
      const double opacity = fading ? 0.95 * std::min(1.0, 4.5 * t) : 0.92;
      surface.point_opacity.push_back(slice.inside(x) ? static_cast<float>(opacity) : 0.0f);
      if (i == 0 || k == 0) continue;
      const int d = static_cast<int>(k * columns + i), c = d - 1, b = d - static_cast<int>(columns),
                a = b - 1;
      surface.triangles.push_back({a, b, d});
      surface.triangles.push_back({a, d, c});
    }
  return surface;
}

/// Where the plane of the slice cuts the bodies, as dark lines just before it.
Surface cut_lines(const std::vector<Body>& bodies, double y) {
  std::vector<std::array<Vec3, 2>> segments;
  for (const Body& body : bodies) {
    auto found = cross_section(body.surface.points, body.surface.triangles, {0, y, 0}, {0, 1, 0});
    segments.insert(segments.end(), found.begin(), found.end());
  }
  for (auto& segment : segments)
    for (Vec3& x : segment) x.y() -= 0.4;
  Surface lines = strokes(segments, 0.2);
  lines.lit = false;
  lines.colour = {0.16f, 0.17f, 0.20f};
  return lines;
}

double quantile(std::vector<double> values, double q) {
  const auto nth = values.begin() + static_cast<long>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

std::vector<double> inside_values(const Slice& slice, const std::vector<double>& values) {
  std::vector<double> inside;
  const Beat& beat = slice.beat;
  for (std::size_t k = 0; k < beat.nz; ++k)
    for (std::size_t i = 0; i < beat.nx; ++i)
      if (slice.inside(beat.origin + Vec3(static_cast<double>(i) * beat.spacing.x(), 0,
                                          static_cast<double>(k) * beat.spacing.z())))
        inside.push_back(values[k * beat.nx + i]);
  return inside.empty() ? values : inside;
}

}  // namespace

std::vector<Picture> beat_pictures(const RunData& run, int width) {
  const auto& state = run.stage("cycle").state;
  if (!state) return {};
  std::vector<Body> bodies = bodies_of(*state);
  const std::optional<Beat> beat = beat_of(*state);
  const std::string valve = valve_of(*state);
  if (valve.empty()) return {};
  std::optional<geometry::GridSdf> level_set = lumen_level_set(*state);
  for (const std::string stage : {"deploy", "mesher", "segment"}) {
    const auto& parent = run.stage(stage).state;
    if (!parent) continue;
    if (!level_set) level_set = lumen_level_set(*parent);
    if (!find_body(bodies, "lumen"))
      for (Body& body : bodies_of(*parent))
        if (body.id == "lumen") bodies.push_back(std::move(body));
  }
  Body* moving = nullptr;
  for (Body& body : bodies)
    if (body.id == valve) moving = &body;

  Box device = around(bodies, {"frame", valve}, 1);
  if (beat)
    for (const Points& points : beat->valve) device.add(points);
  std::vector<Picture> pictures;
  const auto pose = [&](std::size_t frame) {
    if (beat) moving->surface.points = beat->valve[frame];
  };
  const auto when = [&](std::size_t frame) {
    return beat ? fmt::format(" at {:.3f} s", beat->time_s[frame]) : "";
  };
  const std::vector<std::string> hidden = valve == "leaflets"
                                              ? std::vector<std::string>{"lumen", "native_leaflets"}
                                              : std::vector<std::string>{"lumen"};

  struct Moment {
    std::size_t frame;
    const char* word;
  };
  std::vector<Moment> moments{{0, "Last stored shape"}};
  if (beat) moments = {{beat->open, "Open"}, {beat->closed, "Closed"}};
  for (const Moment& moment : moments) {
    pose(moment.frame);
    pictures.push_back(picture(surfaces_of(bodies, hidden), view(from_aorta, device, width),
                               fmt::format("Valve seen from the aorta, {}", moment.word),
                               fmt::format("{}{}, seen from the aorta", moment.word, when(moment.frame))));
  }
  if (!beat || beat->speed_cm_per_s.empty() || beat->nx < 2 || beat->nz < 2) return pictures;

  const Slice slice{*beat, level_set ? &*level_set : nullptr};
  Box box = device;
  box.low.z() = std::max(device.low.z() - 14, beat->origin.z());
  box.high.z() = std::min(device.high.z() + 22,
                          beat->origin.z() + static_cast<double>(beat->nz - 1) * beat->spacing.z());
  if (const Body* lumen = find_body(bodies, "lumen"))
    for (const Vec3& x : lumen->surface.points)
      if (x.z() > box.low.z() && x.z() < box.high.z()) box.add({x});
  const Camera camera = view(Vec3(0, 1, 0), box, width);
  const auto within = [&](const Vec3& x) { return x.y() > beat->origin.y(); };
  const auto cut = [&](std::size_t frame, const std::vector<double>& values, double low, double high,
                       bool fading) {
    pose(frame);
    std::vector<Surface> surfaces;
    for (const Body& body : bodies) {
      Surface half = clip(body.surface, within);
      if (body.id == "lumen") {
        half.opacity = 0.30;
        half.glass = true;
      }
      surfaces.push_back(half);
    }
    surfaces.push_back(cut_lines(bodies, beat->origin.y()));
    surfaces.push_back(slice_surface(slice, values, low, high, fading));
    return surfaces;
  };
  const double fastest =
      std::max(1.0, quantile(inside_values(slice, beat->speed_cm_per_s[beat->open]), 0.998));
  for (const Moment& moment : moments) {
    Picture p =
        picture(cut(moment.frame, beat->speed_cm_per_s[moment.frame], 0, fastest, true), camera,
                fmt::format("Speed of the blood in the plane through the axis, valve {}", moment.word),
                fmt::format("{}{}: speed in the plane through the axis", moment.word, when(moment.frame)));
    p.has_bar = true;
    p.bar = {0, fastest, "cm/s"};
    pictures.push_back(std::move(p));
  }
  if (!beat->pressure_mmHg.empty()) {
    const std::vector<double>& p = beat->pressure_mmHg[beat->closed];
    const std::vector<double> inside = inside_values(slice, p);
    const double low = quantile(inside, 0.005), high = std::max(low + 1, quantile(inside, 0.995));
    Picture q = picture(cut(beat->closed, p, low, high, false), camera,
                        "Pressure in the plane through the axis, valve closed",
                        fmt::format("Closed{}: pressure in the plane through the axis", when(beat->closed)));
    q.has_bar = true;
    q.bar = {low, high, "mmHg"};
    pictures.push_back(std::move(q));
  }
  return pictures;
}

}  // namespace valsalva::report
