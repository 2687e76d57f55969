#include "viewer_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "bodies.hpp"
#include "html.hpp"

namespace valsalva::report {
namespace {

using nlohmann::json;

constexpr std::size_t most_triangles = 40000;

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string packed(const Points& points, const Box& box) {
  const Vec3 extent = (box.high - box.low).cwiseMax(1e-9);
  std::vector<std::uint16_t> values;
  values.reserve(3 * points.size());
  for (const Vec3& x : points)
    for (int d = 0; d < 3; ++d)
      values.push_back(static_cast<std::uint16_t>(
          std::lround(std::clamp((x[d] - box.low[d]) / extent[d], 0.0, 1.0) * 65535)));
  return base64(bytes_of(values));
}

template <class T>
std::string indices_of(const Surface& surface) {
  std::vector<T> indices;
  for (const Triangle& t : surface.triangles)
    for (int node : t) indices.push_back(static_cast<T>(node));
  return bytes_of(indices);
}

json vector_of(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

json body_json(const Body& body, const Box& box) {
  const Surface& surface = body.surface;
  const bool narrow = surface.points.size() <= 65536;
  const Colour& c = surface.colour;
  return {{"id", body.id},
          {"label", body.label},
          {"colour", fmt::format("#{:02x}{:02x}{:02x}", std::lround(255 * c[0]), std::lround(255 * c[1]),
                                 std::lround(255 * c[2]))},
          {"opacity", surface.opacity},
          {"low", vector_of(box.low)},
          {"extent", vector_of(box.high - box.low)},
          {"points", packed(surface.points, box)},
          {"index_bits", narrow ? 16 : 32},
          {"triangles",
           base64(narrow ? indices_of<std::uint16_t>(surface) : indices_of<std::uint32_t>(surface))}};
}

class Collector {
 public:
  explicit Collector(const RunData& run) : run_(run) {}

  /// Adds the bodies of one stage's state; those in `left_out` are skipped, those in `hidden` start
  /// invisible.
  void scene(const std::string& name, const std::string& stage, const std::set<std::string>& hidden,
             const std::vector<std::string>& anatomy) {
    const auto& state = run_.stage(stage).state;
    if (!state) return;
    json bodies = json::array(), invisible = json::array();
    const auto add = [&](int index, const std::string& id) {
      bodies.push_back(index);
      if (hidden.count(id)) invisible.push_back(index);
    };
    for (Body& body : bodies_of(*state, 5)) {
      if (body.id == "lumen" || body.id == "calcium") continue;
      if (body.id != "frame" && body.surface.triangles.size() > most_triangles && stage != "cycle")
        body.surface = simplified(body.surface, most_triangles);
      add(store(body), body.id);
    }
    for (const std::string& id : anatomy)
      if (const int index = shared(id); index >= 0) add(index, id);
    if (!bodies.empty())
      scenes_.push_back(
          {{"name", name}, {"bodies", bodies}, {"hidden", invisible}, {"beat", stage == "cycle"}});
  }

  void beat(int frames) {
    const auto& state = run_.stage("cycle").state;
    if (!state || scenes_.empty() || !scenes_.back()["beat"].get<bool>()) return;
    const auto beat = beat_of(*state);
    if (!beat) return;
    const std::string valve = valve_of(*state);
    for (const json& index : scenes_.back()["bodies"])
      if (bodies_[index.get<std::size_t>()]["id"] == valve) beat_["valve"] = index;
    Box box;
    for (const Points& points : beat->valve) box.add(points);
    beat_["low"] = vector_of(box.low);
    beat_["extent"] = vector_of(box.high - box.low);
    const std::size_t n = beat->time_s.size(),
                      kept = std::min<std::size_t>(n, static_cast<std::size_t>(frames));
    const auto level_set = level_set_of_run();
    const bool slices = !beat->speed_cm_per_s.empty();
    double fastest = 1;
    if (slices)
      for (double v : beat->speed_cm_per_s[beat->open]) fastest = std::max(fastest, v);
    for (std::size_t k = 0; k < kept; ++k) {
      const std::size_t f = kept > 1 ? k * (n - 1) / (kept - 1) : 0;
      beat_["time_s"].push_back(beat->time_s[f]);
      beat_["points"].push_back(packed(beat->valve[f], box));
      if (slices) beat_["slices"].push_back(slice(*beat, f, fastest, level_set ? &*level_set : nullptr));
    }
    if (!slices) return;
    beat_["nx"] = beat->nx;
    beat_["nz"] = beat->nz;
    beat_["origin"] = vector_of(beat->origin);
    beat_["spacing"] = vector_of(beat->spacing);
    beat_["fastest_cm_per_s"] = fastest;
  }

  json result() const {
    if (scenes_.empty()) return json::object();
    json heat_stops = json::array();
    for (int i = 0; i < 16; ++i) heat_stops.push_back(heat(i / 15.0));
    json out{{"scenes", scenes_}, {"bodies", bodies_}, {"heat", heat_stops}};
    if (beat_.contains("valve")) out["beat"] = beat_;
    return out;
  }

 private:
  int store(const Body& body) {
    Box box;
    box.add(body.surface.points);
    bodies_.push_back(body_json(body, box));
    return static_cast<int>(bodies_.size()) - 1;
  }

  /// Lumen or calcium, stored once for all scenes, from the latest stage before deployment that has it.
  int shared(const std::string& id) {
    if (const auto found = shared_.find(id); found != shared_.end()) return found->second;
    int index = -1;
    for (const std::string stage : {"mesher", "segment", "deploy", "cycle"}) {
      const auto& state = run_.stage(stage).state;
      if (index >= 0 || !state || !state->has_mesh(id)) continue;
      for (Body& body : bodies_of(*state))
        if (body.id == id) {
          body.surface = simplified(body.surface, most_triangles);
          index = store(body);
        }
    }
    return shared_[id] = index;
  }

  std::optional<geometry::GridSdf> level_set_of_run() const {
    for (const std::string stage : {"cycle", "deploy", "mesher", "segment"})
      if (const auto& state = run_.stage(stage).state)
        if (auto grid = lumen_level_set(*state)) return grid;
    return std::nullopt;
  }

  static std::string slice(const Beat& beat, std::size_t frame, double fastest,
                           const geometry::GridSdf* lumen) {
    std::vector<std::uint8_t> values;
    for (std::size_t k = 0; k < beat.nz; ++k)
      for (std::size_t i = 0; i < beat.nx; ++i) {
        const Vec3 x = beat.origin + Vec3(static_cast<double>(i) * beat.spacing.x(), 0,
                                          static_cast<double>(k) * beat.spacing.z());
        const double t = std::min(1.0, beat.speed_cm_per_s[frame][k * beat.nx + i] / fastest);
        const bool inside = !lumen || lumen->value(x) < 0.25 * lumen->spacing;
        values.push_back(inside ? static_cast<std::uint8_t>(1 + std::lround(254 * t)) : 0);
      }
    return base64(bytes_of(values));
  }

  const RunData& run_;
  json scenes_ = json::array(), bodies_ = json::array(), beat_ = json::object();
  std::map<std::string, int> shared_;
};

}  // namespace

std::string viewer_json(const RunData& run, int frames) {
  Collector collector(run);
  const std::vector<std::string> image{"calcium", "lumen"}, wall{"lumen"};
  collector.scene("Anatomy and mesh", "mesher", {}, image);
  if (!run.stage("mesher").state) collector.scene("Anatomy", "segment", {}, image);
  collector.scene("Device, expanded", "stent", {}, {});
  collector.scene("Device, crimped", "crimp", {}, {});
  collector.scene("Deployed", "deploy", {}, wall);
  collector.scene("Beat", "cycle", {"skirt"}, wall);  // calcium is known only where the image showed it
  collector.beat(frames);
  return collector.result().dump();
}

}  // namespace valsalva::report
