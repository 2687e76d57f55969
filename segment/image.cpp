#include "image.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace valsalva::segment {

Vec3 Image::index(const Vec3& position) const {
  return (direction.inverse() * (position - origin)).cwiseQuotient(spacing);
}

bool Image::contains(const Vec3& position) const {
  const Vec3 at = index(position);
  for (int d = 0; d < 3; ++d)
    if (!(at[d] >= -0.5 && at[d] <= size[d] - 0.5)) return false;
  return true;
}

double Image::sample(const Vec3& position) const {
  const Vec3 where = index(position);
  std::array<int, 3> low{}, high{};
  std::array<double, 3> t{};
  for (int d = 0; d < 3; ++d) {
    const double clamped = std::clamp(where[d], 0.0, double(size[d] - 1));
    low[d] = int(clamped);
    high[d] = std::min(low[d] + 1, size[d] - 1);
    t[d] = clamped - low[d];
  }
  const auto along_x = [&](int j, int k) { return (1 - t[0]) * at(low[0], j, k) + t[0] * at(high[0], j, k); };
  const auto along_y = [&](int k) { return (1 - t[1]) * along_x(low[1], k) + t[1] * along_x(high[1], k); };
  return (1 - t[2]) * along_y(low[2]) + t[2] * along_y(high[2]);
}

Image cropped(const Image& image, const Vec3& centre, double half_width_mm) {
  const Vec3 middle = image.index(centre);
  std::array<int, 3> low{}, high{};
  Image part;
  for (int d = 0; d < 3; ++d) {
    const double reach = half_width_mm / image.spacing[d];
    low[d] = std::clamp(int(std::floor(middle[d] - reach)), 0, image.size[d] - 1);
    high[d] = std::clamp(int(std::ceil(middle[d] + reach)), 0, image.size[d] - 1);
    part.size[d] = high[d] - low[d] + 1;
  }
  part.spacing = image.spacing;
  part.direction = image.direction;
  part.origin = image.position(Vec3(low[0], low[1], low[2]));
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int i = low[0]; i <= high[0]; ++i) part.values.push_back(image.at(i, j, k));
  return part;
}

void denoise(Image& image, double contrast, int steps) {
  const auto [nx, ny, nz] = image.size;
  const float scale = float(1 / contrast);
  const auto flow = [&](float difference) {
    const float relative = difference * scale;
    return std::exp(-relative * relative) * difference;
  };
  for (int step = 0; step < steps; ++step) {
    std::vector<float> next = image.values;
    for (int k = 0; k < nz; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
          const float here = image.at(i, j, k);
          float sum = 0;
          if (i > 0) sum += flow(image.at(i - 1, j, k) - here);
          if (i + 1 < nx) sum += flow(image.at(i + 1, j, k) - here);
          if (j > 0) sum += flow(image.at(i, j - 1, k) - here);
          if (j + 1 < ny) sum += flow(image.at(i, j + 1, k) - here);
          if (k > 0) sum += flow(image.at(i, j, k - 1) - here);
          if (k + 1 < nz) sum += flow(image.at(i, j, k + 1) - here);
          next[(std::size_t(k) * ny + j) * nx + i] = here + sum / 7;
        }
    image.values = std::move(next);
  }
}

}  // namespace valsalva::segment
