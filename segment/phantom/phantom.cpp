#include "phantom.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "frame.hpp"

namespace valsalva::segment {
namespace {

using std::numbers::pi;

double blend(double a, double b, double t) {
  t = std::clamp(t, 0.0, 1.0);
  return a + (b - a) * t * t * (3 - 2 * t);
}

/// Uniform in (0, 1) from the raw bits: the library's distributions may differ between implementations.
double uniform(std::mt19937_64& engine) {
  return (double(engine() >> 11) + 0.5) / 9007199254740992.0;
}

struct Cylindrical {
  double along, radius, angle;
};

struct Nodule {
  Vec3 centre;
  double radius;
};

class Anatomy {
 public:
  Anatomy(const PhantomShape& shape, std::uint64_t seed) : shape_(shape) {
    std::mt19937_64 engine(seed);
    for (int n = 0; n < shape.nodules; ++n) {
      // On the leaflet, between attachment and opening, away from the commissures.
      const double angle = first_commissure() + 2 * pi / 3 * (n % 3 + 0.2 + 0.6 * uniform(engine));
      const Vec3 at = on_leaflet(angle, 0.15 + 0.7 * uniform(engine));
      nodules_.push_back({at, 0.5 * shape.nodule_mm * (0.7 + 0.6 * uniform(engine))});
    }
  }

  /// Along the axis of the root and then along the bent aorta.
  Cylindrical coordinates(const Vec3& x) const {
    const double h = shape_.junction_height_mm, bend = shape_.bend_radius_mm;
    double along = x.z(), side = x.x();
    if (x.z() > h) {
      const double turn = std::atan2(x.z() - h, bend - x.x());
      along = h + bend * turn;
      side = bend - std::hypot(bend - x.x(), x.z() - h);
    }
    return {along, std::hypot(side, x.y()), std::atan2(x.y(), side)};
  }

  double wall_radius(double along, double angle) const {
    const double h = shape_.junction_height_mm, annulus = shape_.annulus_mm / 2;
    const double oval = (1 - shape_.ovality) / (1 + shape_.ovality);
    const double fade = 1 - std::clamp(along / h, 0.0, 1.0);
    double base = annulus;
    if (along < 0) base = blend(annulus, shape_.lvot_mm / 2, -along / 6);
    if (along < -12)
      base = shape_.lvot_mm / 2 + 0.04 * (along + 12) * (along + 12);  // opens into the ventricle
    if (along > 0) base = blend(annulus, shape_.junction_mm / 2, along / h);
    if (along > h) base = blend(shape_.junction_mm / 2, shape_.ascending_mm / 2, (along - h) / 15);
    double bulge = 0;
    if (along > 0 && along < h) {
      const double lobe = 0.45 + 0.55 * (1 - std::cos(3 * (angle - first_commissure()))) / 2;
      const double peak = shape_.sinus_mm / 2 - (annulus + shape_.junction_mm / 2) / 2;
      bulge = peak / 0.725 * std::pow(std::sin(pi * along / h), 2) * lobe;
    }
    return base * (1 + (along < h ? fade : 0.0) * oval * std::cos(2 * angle)) + bulge;
  }

  /// About the distance to the wall of root and aorta; negative inside.
  double vessel(const Vec3& x) const {
    const Cylindrical at = coordinates(x);
    return at.radius - wall_radius(at.along, at.angle);
  }
  double ventricle(const Vec3& x) const {
    const Vec3 away = (x - Vec3(-6, 4, -38)).cwiseQuotient(Vec3(23, 21, 26));
    return 21 * (away.norm() - 1);
  }
  double atrium(const Vec3& x) const {
    const double behind = shape_.sinus_mm / 2 + 22;
    return (x - Vec3(-0.35 * behind, behind, 6)).norm() - 19;
  }
  double coronaries(const Vec3& x) const {
    double nearest = 1e9;
    for (int n = 0; n < 2; ++n) {
      const double angle = first_commissure() + pi / 3 + n * 2 * pi / 3;
      const Vec3 out(std::cos(angle), std::sin(angle), 0.25);
      const Vec3 start = 0.8 * shape_.sinus_mm / 2 * Vec3(out.x(), out.y(), 0) +
                         Vec3(0, 0, 0.72 * shape_.junction_height_mm);
      const double t = std::clamp((x - start).dot(out) / out.squaredNorm(), 0.0, 30.0);
      nearest = std::min(nearest, (x - start - t * out).norm() - 1.7);
    }
    return nearest;
  }
  double leaflets(const Vec3& x) const {
    const Cylindrical at = coordinates(x);
    if (at.along < -2 || at.along > shape_.junction_height_mm + 2) return 1e9;
    double nearest = 1e9;
    Vec3 before = on_leaflet(at.angle, 0);
    for (int n = 1; n <= 10; ++n) {
      const Vec3 after = on_leaflet(at.angle, n / 10.0);
      const double t =
          std::clamp((x - before).dot(after - before) / (after - before).squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (x - before - t * (after - before)).norm());
      before = after;
    }
    return nearest - shape_.leaflet_mm / 2;
  }
  double calcium(const Vec3& x) const {
    double nearest = 1e9;
    for (const Nodule& nodule : nodules_)
      nearest = std::min(nearest, (x - nodule.centre).norm() - nodule.radius);
    return nearest;
  }

 private:
  double first_commissure() const { return shape_.commissure_rotation_deg * pi / 180; }

  /// Point of the leaflet sheet at an angle: t = 0 at the wall, 1 at the free edge.
  Vec3 on_leaflet(double angle, double t) const {
    const double sector = 2 * pi / 3;
    double within = std::fmod(angle - first_commissure(), sector);
    if (within < 0) within += sector;
    const double off = std::abs(2 * within / sector - 1);  // 0 mid leaflet, 1 at a commissure
    const double commissure = 0.85 * shape_.junction_height_mm;
    const double z_wall = commissure * std::pow(off, 2.2) + 0.8;
    const double z_edge = 0.8 * commissure + 0.2 * commissure * off;
    const double r_wall = wall_radius(z_wall, angle);
    const double r_edge = shape_.orifice_mm / 2 + (0.8 * r_wall - shape_.orifice_mm / 2) * std::pow(off, 4);
    // Quadratic curve that leaves the wall inward and ends upward.
    const double r_mid = 0.45 * r_wall + 0.55 * r_edge, z_mid = z_wall + 0.25 * (z_edge - z_wall);
    const double a = (1 - t) * (1 - t), b = 2 * t * (1 - t), c = t * t;
    const double r = a * r_wall + b * r_mid + c * r_edge;
    return {r * std::cos(angle), r * std::sin(angle), a * z_wall + b * z_mid + c * z_edge};
  }

  PhantomShape shape_;
  std::vector<Nodule> nodules_;
};

void blur(Image& image, double sigma_voxels) {
  const int reach = int(std::ceil(3 * sigma_voxels));
  std::vector<double> weights;
  double total = 0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-0.5 * k * k / (sigma_voxels * sigma_voxels)));
    total += weights.back();
  }
  for (int d = 0; d < 3; ++d) {
    Image before = image;
    for (int k = 0; k < image.size[2]; ++k)
      for (int j = 0; j < image.size[1]; ++j)
        for (int i = 0; i < image.size[0]; ++i) {
          double sum = 0;
          for (int o = -reach; o <= reach; ++o) {
            std::array<int, 3> at{i, j, k};
            at[d] = std::clamp(at[d] + o, 0, image.size[d] - 1);
            sum += weights[o + reach] * before.at(at[0], at[1], at[2]);
          }
          image.values[(std::size_t(k) * image.size[1] + j) * image.size[0] + i] = float(sum / total);
        }
  }
}

void add_noise(Image& image, double deviation, std::uint64_t seed) {
  std::mt19937_64 engine(seed + 1);
  for (float& value : image.values) {
    const double u = uniform(engine), v = uniform(engine);
    value += float(deviation * std::sqrt(-2 * std::log(u)) * std::cos(2 * pi * v));
  }
}

}  // namespace

Phantom make_phantom(const PhantomShape& shape, const PhantomScan& scan) {
  const Anatomy anatomy(shape, scan.seed);
  const Frame frame = Frame::at(scan.annulus_centre, scan.axis);
  Phantom phantom;
  Image& image = phantom.image;
  const int size = int(2 * scan.half_width_mm / scan.spacing_mm);
  image.size = {size, size, size};
  image.spacing = Vec3::Constant(scan.spacing_mm);
  // The annulus lies below the middle: more aorta than ventricle.
  image.origin = scan.annulus_centre + 12 * scan.axis.normalized() - Vec3::Constant(scan.half_width_mm);
  image.values.reserve(std::size_t(size) * size * size);
  const double voxel_mm3 = std::pow(scan.spacing_mm, 3);
  const auto share = [&](double distance) { return std::clamp(0.5 - distance / scan.spacing_mm, 0.0, 1.0); };
  for (int k = 0; k < size; ++k)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        const Vec3 x = frame.from_scanner(image.position(Vec3(i, j, k)));
        const double vessel = anatomy.vessel(x), ventricle = anatomy.ventricle(x);
        const double atrium =
            std::max(anatomy.atrium(x), 2.0 - vessel);  // a wall of 2 mm at least between them
        const double above = x.z() + 16;                // root and aorta end in the ventricle
        const double root = std::max(vessel, -above);
        double value = scan.lung;
        const auto cover = [&](double distance, double with) { value += share(distance) * (with - value); };
        cover(std::min({root - 14, ventricle - 18, atrium - 6}), scan.fat);
        cover(std::min({root - 2, ventricle - 10, atrium - 2}), scan.tissue);
        cover(std::min({root, ventricle, anatomy.coronaries(x)}), scan.blood);
        cover(atrium, scan.blood);
        cover(std::max(anatomy.leaflets(x), vessel), scan.leaflet);
        const double calcium = anatomy.calcium(x);
        cover(calcium, scan.calcium);
        phantom.calcium_mm3 += share(calcium) * voxel_mm3;
        if (x.z() > 0 && x.z() < shape.junction_height_mm) phantom.lumen_mm3 += share(vessel) * voxel_mm3;
        image.values.push_back(float(value));
      }
  if (scan.blur_mm > 0) blur(image, scan.blur_mm / scan.spacing_mm);
  if (scan.noise > 0) add_noise(image, scan.noise, scan.seed);
  for (float& value : image.values) value = std::round(value);
  return phantom;
}

}  // namespace valsalva::segment
