#include "root.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/errors.hpp"

namespace valsalva::segment {
namespace {

using geometry::CentrelinePoint;
using geometry::GridSdf;
using geometry::Plane;
using std::numbers::pi;

constexpr double lattice_mm = 0.25;

/// Radius over the angle around the sinuses: mean over a few levels, each about its own centroid.
std::vector<double> sinus_radii(const GridSdf& lumen, const std::vector<CentrelinePoint>& line,
                                double z_sinus, int count) {
  std::vector<double> mean(count, 0.0);
  int levels = 0;
  for (const CentrelinePoint& p : line) {
    if (std::abs(p.position.z() - z_sinus) > 3) continue;
    const Plane plane = Plane::at(p.position, Vec3::UnitZ());
    const geometry::Loop loop = geometry::loop_at_origin(geometry::section(lumen, plane, 40, lattice_mm));
    if (loop.empty()) continue;
    const std::vector<double> here = geometry::radii(loop, geometry::centroid(loop), count);
    for (int n = 0; n < count; ++n) mean[n] += here[n];
    ++levels;
  }
  for (double& r : mean) r /= std::max(levels, 1);
  return mean;
}

/// The part of r(angle) up to the sixth harmonic, at any angle.
struct Harmonics {
  std::array<double, 7> cosine{}, sine{};
  explicit Harmonics(const std::vector<double>& radii) {
    const double n = double(radii.size());
    for (int m = 0; m <= 6; ++m)
      for (std::size_t k = 0; k < radii.size(); ++k) {
        cosine[m] += (m ? 2 : 1) / n * radii[k] * std::cos(2 * pi * m * double(k) / n);
        sine[m] += (m ? 2 : 1) / n * radii[k] * std::sin(2 * pi * m * double(k) / n);
      }
  }
  double at(double angle, int first = 0) const {
    double sum = 0;
    for (int m = first; m <= 6; ++m) sum += cosine[m] * std::cos(m * angle) + sine[m] * std::sin(m * angle);
    return sum;
  }
};

std::array<double, 3> commissures(const Harmonics& shape) {
  // cos(3 a - phase) is least at a = (phase + pi) / 3.
  const double phase = std::atan2(shape.sine[3], shape.cosine[3]);
  std::array<double, 3> angles{};
  for (int c = 0; c < 3; ++c) {
    const double expected = (phase + pi) / 3 + 2 * pi * c / 3;
    double best = expected;
    // Harmonics 1 and 2 are offset and ovality of the root; the grooves are in the higher ones.
    for (double a = expected - pi / 6; a <= expected + pi / 6; a += pi / 720)
      if (shape.at(a, 3) < shape.at(best, 3)) best = a;
    angles[c] = std::fmod(best + 4 * pi, 2 * pi);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

}  // namespace

Root measure_root(const GridSdf& lumen, double z_lower_mm, double z_upper_mm, double lvot_below_mm) {
  Root root;
  const auto figures_at = [&](const Vec3& at, const Vec3& normal, const char* name) {
    const Plane plane = Plane::at(at, normal);
    const geometry::Loop loop = geometry::loop_at_origin(geometry::section(lumen, plane, 40, lattice_mm));
    if (loop.empty())
      throw InputError(
          "the lumen has no section at the {} (z = {:.1f} mm above the annulus); move "
          "anatomy.annulus_centre_mm or the cuts",
          name, at.z());
    return geometry::figures(loop, plane);
  };
  root.annulus = figures_at(Vec3::Zero(), Vec3::UnitZ(), "annulus");
  root.z_lvot_mm = std::max(-lvot_below_mm, z_lower_mm);
  root.lvot = figures_at(Vec3(0, 0, root.z_lvot_mm), Vec3::UnitZ(), "outflow tract");

  geometry::CentrelineOptions options;
  options.lattice_mm = lattice_mm;
  const auto up = geometry::follow(lumen, root.annulus.centre, Vec3::UnitZ(), options);
  auto down = geometry::follow(lumen, root.annulus.centre, -Vec3::UnitZ(), options);
  for (auto p = down.rbegin(); p != down.rend() && std::next(p) != down.rend(); ++p)
    root.centreline.push_back(*p);
  for (CentrelinePoint& p : root.centreline) p.tangent = -p.tangent;
  root.centreline.insert(root.centreline.end(), up.begin(), up.end());
  std::erase_if(root.centreline, [&](const CentrelinePoint& p) {
    return p.position.z() < z_lower_mm || p.position.z() > z_upper_mm;
  });
  for (std::size_t n = 0; n < root.centreline.size(); ++n)
    root.centreline[n].arc_mm = n ? root.centreline[n - 1].arc_mm +
                                        (root.centreline[n].position - root.centreline[n - 1].position).norm()
                                  : 0;

  const double diameter = root.annulus.area_diameter_mm();
  const CentrelinePoint *sinus = nullptr, *junction = nullptr;
  for (const CentrelinePoint& p : root.centreline) {
    const double z = p.position.z();
    if (z > 0.25 * diameter && z < 1.2 * diameter && (!sinus || p.section.area_mm2 > sinus->section.area_mm2))
      sinus = &p;
  }
  if (sinus)
    for (const CentrelinePoint& p : root.centreline) {
      const double beyond = p.arc_mm - sinus->arc_mm;
      if (beyond > 2 && beyond < diameter && (!junction || p.section.area_mm2 < junction->section.area_mm2))
        junction = &p;
    }
  if (!sinus || !junction)
    throw InputError(
        "the root above the annulus is too short to hold sinuses and junction (upper cut at {:.0f} mm); "
        "raise anatomy.upper_cut_mm or lower the lumen threshold",
        z_upper_mm);
  root.sinus = sinus->section;
  root.z_sinus_mm = sinus->position.z();
  root.junction = junction->section;
  root.z_junction_mm = junction->position.z();

  const Harmonics shape(sinus_radii(lumen, root.centreline, root.z_sinus_mm, 360));
  root.lobe_mm = std::hypot(shape.cosine[3], shape.sine[3]);
  root.commissure_angles = commissures(shape);
  return root;
}

DeviceSize recommended_device(double annulus_perimeter_mm) {
  struct Range {
    double nominal, low, high;
  };
  constexpr std::array<Range, 4> sizes{
      {{23, 56.5, 62.8}, {26, 62.8, 72.3}, {29, 72.3, 81.7}, {34, 81.7, 94.2}}};
  for (const Range& size : sizes)
    if (annulus_perimeter_mm >= size.low && annulus_perimeter_mm < size.high) return {size.nominal, true};
  return {annulus_perimeter_mm < sizes.front().low ? sizes.front().nominal : sizes.back().nominal, false};
}

}  // namespace valsalva::segment
