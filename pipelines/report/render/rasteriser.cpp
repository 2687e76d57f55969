#include "render/rasteriser.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace valsalva::report {
namespace {

struct View {
  Vec3 right, up, forward;
  explicit View(const Camera& camera) {
    forward = camera.toward.normalized();
    right = forward.cross(camera.up).normalized();
    up = right.cross(forward);
  }
  /// x right, y up, z away from the viewer.
  Vec3 operator()(const Vec3& v) const { return {right.dot(v), up.dot(v), forward.dot(v)}; }
};

struct Corner {
  float x, y, z;
  Eigen::Vector3f normal, colour;
  float opacity;
};

struct Facet {
  std::array<Corner, 3> corner;
  const Surface* surface;
  float depth;
};

struct Target {
  int width, height;
  std::vector<float> depth;
  std::vector<Eigen::Vector4f> colour;  // premultiplied
  Target(int w, int h)
      : width(w),
        height(h),
        depth(static_cast<std::size_t>(w) * h, std::numeric_limits<float>::infinity()),
        colour(depth.size(), Eigen::Vector4f::Zero()) {}
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width + x; }
};

std::vector<Eigen::Vector3f> point_normals(const Surface& surface, const View& view) {
  std::vector<Eigen::Vector3f> normals(surface.points.size(), Eigen::Vector3f::Zero());
  for (const Triangle& t : surface.triangles) {
    const Vec3 n =
        (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]);
    for (int node : t) normals[node] += view(n).cast<float>();
  }
  for (auto& n : normals) n.normalize();
  return normals;
}

std::vector<Facet> facets_of(const Surface& surface, const Camera& camera, const View& view, int samples) {
  const double scale = samples / camera.mm_per_pixel;
  std::vector<Eigen::Vector3f> normals;
  if (surface.lit && surface.smooth) normals = point_normals(surface, view);
  std::vector<Facet> facets;
  facets.reserve(surface.triangles.size());
  for (const Triangle& t : surface.triangles) {
    Facet facet;
    facet.surface = &surface;
    facet.depth = 0;
    const Vec3 flat = view(
        (surface.points[t[1]] - surface.points[t[0]]).cross(surface.points[t[2]] - surface.points[t[0]]));
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = view(surface.points[t[k]] - camera.target);
      Corner& c = facet.corner[k];
      c.x = static_cast<float>(p.x() * scale + 0.5 * samples * camera.width);
      c.y = static_cast<float>(-p.y() * scale + 0.5 * samples * camera.height);
      c.z = static_cast<float>(p.z());
      c.normal = normals.empty() ? flat.normalized().cast<float>() : normals[t[k]];
      const Colour& colour = surface.point_colours.empty() ? surface.colour : surface.point_colours[t[k]];
      c.colour = {colour[0], colour[1], colour[2]};
      c.opacity = static_cast<float>(surface.opacity);
      if (!surface.point_opacity.empty()) c.opacity *= surface.point_opacity[t[k]];
      facet.depth += c.z / 3;
    }
    facets.push_back(facet);
  }
  return facets;
}

Eigen::Vector4f shade(const Facet& facet, const std::array<float, 3>& w, float edge_distance, float height,
                      int samples) {
  const auto& c = facet.corner;
  const Surface& surface = *facet.surface;
  Eigen::Vector3f colour = w[0] * c[0].colour + w[1] * c[1].colour + w[2] * c[2].colour;
  float opacity = w[0] * c[0].opacity + w[1] * c[1].opacity + w[2] * c[2].opacity;
  if (surface.lit) {
    static const Eigen::Vector3f light = Eigen::Vector3f(-0.45f, 0.6f, -0.75f).normalized();
    static const Eigen::Vector3f half = (light + Eigen::Vector3f(0, 0, -1)).normalized();
    Eigen::Vector3f n = w[0] * c[0].normal + w[1] * c[1].normal + w[2] * c[2].normal;
    const float length = n.norm();
    if (length > 0) n /= length;
    if (n.z() > 0) n = -n;
    static const Eigen::Vector3f fill = Eigen::Vector3f(0.7f, -0.35f, -0.6f).normalized();
    const float diffuse = std::max(0.0f, n.dot(light)) + 0.38f * std::max(0.0f, n.dot(fill));
    const float gloss = 0.16f * std::pow(std::max(0.0f, n.dot(half)), 24.0f);
    colour = colour * (0.40f + 0.58f * diffuse) + Eigen::Vector3f::Constant(gloss);
    if (surface.glass) {
      const float grazing = 1 - std::abs(n.z());
      opacity = std::min(1.0f, opacity * (0.35f + 4.0f * grazing * grazing));
    }
  }
  if (surface.edges) {
    const float line = std::clamp(1.2f - edge_distance / (0.75f * static_cast<float>(samples)), 0.0f, 1.0f);
    const float room =
        std::min(1.0f, height / (12.0f * static_cast<float>(samples)));  // fine meshes stay bright
    colour *= 1 - 0.55f * line * room;
    opacity = std::max(opacity, 0.8f * line * std::min(1.0f, 3 * opacity));
  }
  colour = colour.cwiseMin(1.0f).cwiseMax(0.0f);
  return {colour.x() * opacity, colour.y() * opacity, colour.z() * opacity, opacity};
}

void draw(const Facet& facet, Target& target, int samples, bool opaque) {
  const auto& [a, b, c] = facet.corner;
  const float area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
  if (area == 0) return;
  const int x0 = std::max(0, static_cast<int>(std::floor(std::min({a.x, b.x, c.x}))));
  const int x1 = std::min(target.width - 1, static_cast<int>(std::ceil(std::max({a.x, b.x, c.x}))));
  const int y0 = std::max(0, static_cast<int>(std::floor(std::min({a.y, b.y, c.y}))));
  const int y1 = std::min(target.height - 1, static_cast<int>(std::ceil(std::max({a.y, b.y, c.y}))));
  const float la = std::hypot(c.x - b.x, c.y - b.y), lb = std::hypot(a.x - c.x, a.y - c.y),
              lc = std::hypot(b.x - a.x, b.y - a.y);
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
      const float wa = ((b.x - px) * (c.y - py) - (c.x - px) * (b.y - py)) / area;
      const float wb = ((c.x - px) * (a.y - py) - (a.x - px) * (c.y - py)) / area;
      const float wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const float z = wa * a.z + wb * b.z + wc * c.z;
      const std::size_t i = target.at(x, y);
      if (z >= target.depth[i]) continue;
      const float edge = std::abs(area) * std::min({wa / la, wb / lb, wc / lc});
      const Eigen::Vector4f colour =
          shade(facet, {wa, wb, wc}, edge, std::abs(area) / std::max({la, lb, lc}), samples);
      if (opaque) {
        target.depth[i] = z;
        target.colour[i] = colour;
      } else {
        target.colour[i] = colour + (1 - colour[3]) * target.colour[i];
      }
    }
}

/// Darkens where much of the neighbourhood lies in front, up to `reach` mm.
void occlude(Target& target, const Camera& camera, int samples) {
  constexpr int directions = 12;
  constexpr float reach = 2.5f;
  const std::vector<float> depth = target.depth;
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) {
      const std::size_t i = target.at(x, y);
      if (std::isinf(depth[i])) continue;
      float hidden = 0;
      for (int d = 0; d < directions; ++d) {
        const double angle = 2.399963 * d;
        const double radius = 1.3 * std::sqrt((d + 0.5) / directions) / camera.mm_per_pixel * samples;
        const int sx = x + static_cast<int>(std::lround(radius * std::cos(angle)));
        const int sy = y + static_cast<int>(std::lround(radius * std::sin(angle)));
        if (sx < 0 || sy < 0 || sx >= target.width || sy >= target.height) continue;
        const float front = depth[i] - depth[target.at(sx, sy)];
        if (front > 0.25f)
          hidden += std::clamp(1 - front / (3 * reach), 0.25f, 1.0f) * std::min(1.0f, front / reach);
      }
      target.colour[i].head<3>() *= 1 - 0.75f * hidden / directions;
    }
}

/// To 65 levels: finer ones are not seen, and make the file twice as large.
std::uint8_t level(float value) {
  return static_cast<std::uint8_t>(std::min(255L, 4 * std::lround(std::clamp(value, 0.0f, 1.0f) * 64)));
}

Image average(const Target& target, int samples) {
  Image image;
  image.width = target.width / samples;
  image.height = target.height / samples;
  image.rgba.resize(4 * static_cast<std::size_t>(image.width) * image.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      Eigen::Vector4f sum = Eigen::Vector4f::Zero();
      for (int sy = 0; sy < samples; ++sy)
        for (int sx = 0; sx < samples; ++sx)
          sum += target.colour[target.at(x * samples + sx, y * samples + sy)];
      std::uint8_t* out = image.pixel(x, y);
      out[3] = level(sum[3] / static_cast<float>(samples * samples));
      for (int c = 0; c < 3; ++c) out[c] = out[3] > 0 ? level(sum[c] / sum[3]) : 0;
    }
  return image;
}

}  // namespace

Camera Camera::framing(const Box& box, double margin) const {
  Camera camera = *this;
  if (box.empty()) return camera;
  const View view(*this);
  Vec3 low = Vec3::Constant(1e300), high = -low;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1 ? box.high : box.low).x(), (corner & 2 ? box.high : box.low).y(),
                 (corner & 4 ? box.high : box.low).z());
    low = low.cwiseMin(view(p));
    high = high.cwiseMax(view(p));
  }
  camera.target = 0.5 * (box.low + box.high);
  const Vec3 extent = (high - low).cwiseMax(1e-6);
  camera.mm_per_pixel = std::max(extent.x() / width, extent.y() / height) / (1 - 2 * margin);
  return camera;
}

Image render(const std::vector<Surface>& surfaces, const Camera& camera, int samples) {
  const View view(camera);
  Target target(camera.width * samples, camera.height * samples);
  std::vector<Facet> transparent;
  for (const Surface& surface : surfaces) {
    const bool opaque = surface.opacity >= 1 && surface.point_opacity.empty() && !surface.glass;
    std::vector<Facet> facets = facets_of(surface, camera, view, samples);
    if (opaque)
      for (const Facet& facet : facets) draw(facet, target, samples, true);
    else
      transparent.insert(transparent.end(), facets.begin(), facets.end());
  }
  occlude(target, camera, samples);
  std::stable_sort(transparent.begin(), transparent.end(),
                   [](const Facet& a, const Facet& b) { return a.depth > b.depth; });
  for (const Facet& facet : transparent) draw(facet, target, samples, false);
  return average(target, samples);
}

}  // namespace valsalva::report
