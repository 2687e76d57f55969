#include <algorithm>
#include <cmath>

#include "core/errors.hpp"
#include "lumen.hpp"
#include "vessel.hpp"

namespace valsalva::segment {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Statistics statistics_of(const Image& image, const std::vector<Vec3>& seeds, const LumenOptions& options) {
  constexpr double radius_mm = 4, step_mm = 0.8;
  std::vector<double> values;
  for (const Vec3& seed : seeds) {
    if (!image.contains(seed))
      throw InputError(
          "anatomy.seeds_mm: the seed {} lies outside the image; give a point inside the contrast-filled "
          "lumen (check anatomy.coordinates)",
          text_of(seed));
    std::vector<double> around;
    for (double z = -radius_mm; z <= radius_mm; z += step_mm)
      for (double y = -radius_mm; y <= radius_mm; y += step_mm)
        for (double x = -radius_mm; x <= radius_mm; x += step_mm)
          if (x * x + y * y + z * z <= radius_mm * radius_mm)
            around.push_back(image.sample(seed + Vec3(x, y, z)));
    const double here = median(around);
    const double least = options.lumen_threshold.value_or(150);
    if (here < least)
      throw InputError(
          "segmentation is empty: around the seed {} the image has {:.0f} HU, expected more than {:.0f} "
          "(contrast-filled blood); move anatomy.seeds_mm or anatomy.annulus_centre_mm, or lower "
          "anatomy.lumen_threshold_HU",
          text_of(seed), here, least);
    values.insert(values.end(), around.begin(), around.end());
  }
  Statistics found;
  found.blood = median(values);
  for (double& value : values) value = std::abs(value - found.blood);
  found.noise = 1.4826 * median(values);
  std::vector<double> tissue;
  for (float value : image.values)
    if (value > 0 && value < found.blood / 2) tissue.push_back(value);
  found.tissue = tissue.empty() ? 0 : median(tissue);
  found.lumen_threshold = options.lumen_threshold.value_or((found.blood + found.tissue) / 2);
  found.calcium_threshold =
      options.calcium_threshold.value_or(found.blood + std::max(6 * found.noise, 200.0));
  return found;
}

}  // namespace valsalva::segment
