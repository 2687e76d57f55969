#include "annulus_plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "core/errors.hpp"
#include "geometry/centreline.hpp"
#include "geometry/level_set.hpp"
#include "lumen_field.hpp"
#include "vessel.hpp"

namespace valsalva::segment {

using geometry::GridSdf;

Frame interface_of(const Image& labels, double upstream, double downstream) {
  std::vector<Vec3> touching;
  const auto [nx, ny, nz] = labels.size;
  for (int k = 1; k + 1 < nz; ++k)
    for (int j = 1; j + 1 < ny; ++j)
      for (int i = 1; i + 1 < nx; ++i) {
        if (labels.at(i, j, k) != float(downstream)) continue;
        for (const auto& step :
             {std::array{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})
          if (labels.at(i + step[0], j + step[1], k + step[2]) == float(upstream))
            touching.push_back(labels.position(Vec3(i, j, k) + 0.5 * Vec3(step[0], step[1], step[2])));
      }
  if (touching.size() < 50)
    throw InputError(
        "anatomy.annulus_labels: labels {} and {} touch in {} voxel faces, expected 50 at least; correct "
        "the labels or give anatomy.annulus_centre_mm and anatomy.annulus_normal",
        upstream, downstream, touching.size());
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : touching) centre += p / double(touching.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : touching) spread += (p - centre) * (p - centre).transpose();
  Vec3 normal = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(0);
  // Downstream is where the downstream label lies near the plane.
  double side = 0;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (labels.at(i, j, k) != float(downstream)) continue;
        const Vec3 away = labels.position(Vec3(i, j, k)) - centre;
        if (away.norm() < 15) side += away.dot(normal);
      }
  return Frame::at(centre, side < 0 ? Vec3(-normal) : normal);
}

Frame annulus_from_seeds(const Image& image, const std::vector<Vec3>& seeds, const LumenOptions& options) {
  if (seeds.size() < 2)
    throw InputError(
        "anatomy.seeds_mm: found {} seed, expected two at least (first upstream, last downstream of the "
        "valve), or anatomy.annulus_centre_mm and anatomy.annulus_normal",
        seeds.size());
  const Vec3 along = seeds.back() - seeds.front();
  const Frame rough = Frame::at(seeds.front(), along);
  const Image part = cropped(image, seeds.front() + along / 2, along.norm() + 40);
  const Statistics found = statistics_of(part, seeds, options);
  LumenOptions coarse = options;
  coarse.spacing_mm = 0.8;
  coarse.lower_cut_mm = 5;
  coarse.upper_cut_mm = along.norm();
  GridSdf field = working_grid(coarse, [&](const Vec3& x) {
    return (found.lumen_threshold - part.sample(rough.to_scanner(x))) / found.lumen_threshold;
  });
  const GridSdf lumen = parted(geometry::redistanced(field, vessel_reach_mm), options.opening_mm,
                               {Vec3::Zero(), rough.from_scanner(seeds.back())});
  const auto line = geometry::follow(lumen, Vec3::Zero(), Vec3::UnitZ(), {});
  if (line.size() < 15)
    throw InputError(
        "segmentation is empty: from the upstream seed the lumen can be followed for {} mm only; move "
        "anatomy.seeds_mm or lower anatomy.lumen_threshold_HU (now {:.0f})",
        line.size(), found.lumen_threshold);
  const auto smaller = [](const auto& a, const auto& b) { return a.section.area_mm2 < b.section.area_mm2; };
  const auto widest = std::max_element(line.begin() + 10, line.end(), smaller);
  const auto narrowest = std::min_element(line.begin(), widest, smaller);
  return Frame::at(rough.to_scanner(narrowest->position), rough.axes * narrowest->tangent);
}

}  // namespace valsalva::segment
